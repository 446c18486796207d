// SPDX-License-Identifier: MIT
/// @file
/// @brief A report as one self-contained HTML file: pictures, plots and tables inlined.
///
/// @code
/// Report report{"Inspection of the power plant", "3 drones, seed 1"};
/// report.add_heading("Result").add_picture(encode_png(image), "The reconstructed surface");
/// report.add_plot(coverage_over_time).add_table(table).write(folder / "report.html");
/// @endcode
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/evaluation/plot.hpp>

namespace surfleet {
/// Cells as they are to be read. A row may be shorter than the header.
struct Table {
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows{};

  Table& add_row(std::vector<std::string> row) {
    rows.push_back(std::move(row));
    return *this;
  }
};

/// One number that a reader should see first.
struct KeyFigure {
  std::string label, value, note;
};

/// Standard base 64 with padding (RFC 4648).
inline std::string base64(std::span<const std::byte> bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      group = (group << 8) | (k < n ? static_cast<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= n ? kDigits[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return out;
}

/// Builds the page in the order of the calls. All text is escaped; nothing is loaded from outside;
/// the page is well-formed XML too. Follows the reader's light or dark setting and prints.
class Report {
 public:
  explicit Report(std::string title, std::string subtitle = {})
      : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

  Report& add_heading(std::string_view text) { return add("<h2>" + escape_markup(text) + "</h2>"); }
  Report& add_paragraph(std::string_view text) { return add("<p>" + escape_markup(text) + "</p>"); }
  /// `text` with its line breaks and spaces kept, such as the command that made the report.
  Report& add_preformatted(std::string_view text) {
    return add("<pre>" + escape_markup(text) + "</pre>");
  }
  Report& add_key_figures(std::span<const KeyFigure> figures) {
    std::string html = "<dl class=\"key\">\n";
    for (const KeyFigure& f : figures)
      html += "<div><dt>" + escape_markup(f.label) + "</dt><dd><b>" + escape_markup(f.value) +
              "</b><small>" + escape_markup(f.note) + "</small></dd></div>\n";
    return add(html + "</dl>");
  }
  /// The bytes of a PNG file with the words under it. Consecutive pictures and plots that were
  /// added as `half` stand side by side where the page is wide enough.
  Report& add_picture(std::span<const std::byte> png, std::string_view caption, bool half = false) {
    return add("<figure" + half_class(half) + "><img alt=\"" + escape_markup(caption) +
               "\" src=\"data:image/png;base64," + base64(png) + "\"/><figcaption>" +
               escape_markup(caption) + "</figcaption></figure>");
  }
  Report& add_plot(const Plot& plot, bool half = false) { return add_svg(to_svg(plot), {}, half); }
  /// An `<svg>` element as `to_svg` and `color_bar_svg` make it; it is not checked.
  Report& add_svg(std::string_view svg, std::string_view caption = {}, bool half = false) {
    std::string html = "<figure" + half_class(half) + ">" + std::string(svg);
    if (!caption.empty()) html += "<figcaption>" + escape_markup(caption) + "</figcaption>";
    return add(html + "</figure>");
  }
  /// Columns in which every filled cell reads as a number are aligned at the right.
  Report& add_table(const Table& table) {
    std::size_t n = table.columns.size();
    for (const auto& row : table.rows) n = std::max(n, row.size());
    std::vector<bool> numeric(n, !table.rows.empty());
    for (const auto& row : table.rows)
      for (std::size_t k = 0; k < row.size(); ++k)
        if (!looks_numeric(row[k])) numeric[k] = false;
    const auto cells = [&](const std::vector<std::string>& row, const std::string& tag) {
      std::string html = "<tr>";
      for (std::size_t k = 0; k < n; ++k)
        html += "<" + tag + (numeric[k] ? " class=\"n\">" : ">") +
                (k < row.size() ? escape_markup(row[k]) : "") + "</" + tag + ">";
      return html + "</tr>\n";
    };
    std::string html = "<div class=\"scroll\"><table>\n";
    if (!table.caption.empty()) html += "<caption>" + escape_markup(table.caption) + "</caption>\n";
    if (!table.columns.empty()) html += "<thead>" + cells(table.columns, "th") + "</thead>\n";
    html += "<tbody>\n";
    for (const auto& row : table.rows) html += cells(row, "td");
    return add(html + "</tbody></table></div>");
  }

  std::string html() const {
    std::string page =
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n"
        "<meta charset=\"utf-8\"/>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
        escape_markup(title_) + "</title>\n<style>\n" + std::string(kStyle) +
        "</style>\n</head>\n<body>\n<main>\n<h1>" + escape_markup(title_) + "</h1>\n";
    if (!subtitle_.empty()) page += "<p class=\"sub\">" + escape_markup(subtitle_) + "</p>\n";
    return page + body_ + "</main>\n</body>\n</html>\n";
  }
  /// Throws `Error` if the file cannot be written.
  void write(const std::filesystem::path& path) const {
    write_file(path, std::string_view(html()));
  }

 private:
  static constexpr std::string_view kStyle = R"(:root { color-scheme: light dark;
  --ink: #1c2430; --soft: #5b6675; --page: #ffffff; --card: #f4f6f8; --line: #d5dbe2; }
@media (prefers-color-scheme: dark) { :root {
  --ink: #e3e8ee; --soft: #9aa6b4; --page: #14181d; --card: #1e242b; --line: #343d48; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, "Segoe UI", Roboto, sans-serif; }
main { max-width: 72rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .25rem; }
h2 { font-size: 1.25rem; margin: 2.25rem 0 .75rem; padding-top: .75rem;
  border-top: 1px solid var(--line); clear: both; }
p { max-width: 46rem; }
.sub { color: var(--soft); margin: 0 0 1.5rem; }
pre { background: var(--card); padding: .75rem 1rem; border-radius: 6px; overflow-x: auto;
  font-size: .85rem; white-space: pre-wrap; }
figure { margin: 1rem 0; width: 100%; display: inline-block; vertical-align: top; }
figure img, figure svg { display: block; width: 100%; height: auto; border-radius: 6px; }
figure > svg { max-width: 46rem; }
figcaption { color: var(--soft); font-size: .9rem; margin-top: .35rem; }
@media (min-width: 48rem) { figure.half { width: 48.5%; margin-right: 1%; } }
.key { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .75rem;
  margin: 1.25rem 0; }
.key div { background: var(--card); border-radius: 8px; padding: .7rem .9rem; }
.key dt { color: var(--soft); font-size: .85rem; }
.key dd { margin: 0; }
.key b { display: block; font-size: 1.5rem; font-variant-numeric: tabular-nums; }
.key small { color: var(--soft); }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: .92rem; }
caption { text-align: left; color: var(--soft); padding-bottom: .4rem; }
th, td { text-align: left; padding: .3rem .55rem; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th { font-weight: 600; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
@media print { :root { --ink: #000; --soft: #444; --page: #fff; --card: #f2f2f2; --line: #bbb; }
  main { max-width: none; padding: 0; } figure, table, .key { break-inside: avoid; }
  figure.half { width: 48.5%; } h2 { break-after: avoid; } }
)";

  static std::string half_class(bool half) { return half ? " class=\"half\"" : ""; }
  /// Digits with signs, points, colons and the like; a lone dash or nothing counts as well.
  static bool looks_numeric(std::string_view cell) {
    for (std::string_view sign : {"–", "−", "±"})
      for (;;) {
        if (!cell.starts_with(sign)) break;
        cell.remove_prefix(sign.size());
      }
    if (cell.empty()) return true;
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    if (digit(cell[0])) return true;
    return cell.size() > 1 && (cell[0] == '-' || cell[0] == '+' || cell[0] == '.') &&
           digit(cell[1]);
  }
  Report& add(const std::string& html) {
    body_ += html;
    body_ += '\n';
    return *this;
  }

  std::string title_, subtitle_, body_;
};
}  // namespace surfleet
