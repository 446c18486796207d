// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/report.hpp>

#include <filesystem>
#include <string>

#include "check.hpp"
#include "support/published_figures.hpp"
#include "well_formed.hpp"

using namespace surfleet;

namespace {
std::string base64_of(std::string_view text) {
  return base64(std::as_bytes(std::span<const char>(text.data(), text.size())));
}
}  // namespace

TEST(base64_test_vectors_of_rfc_4648) {
  CHECK(base64_of("") == "" && base64_of("f") == "Zg==" && base64_of("fo") == "Zm8=");
  CHECK(base64_of("foo") == "Zm9v" && base64_of("foob") == "Zm9vYg==");
  CHECK(base64_of("fooba") == "Zm9vYmE=" && base64_of("foobar") == "Zm9vYmFy");
  CHECK(base64_of(std::string("\xff\x00\xfe", 3)) == "/wD+");
}

TEST(reports_are_self_contained_and_well_formed) {
  Report report("A <b>title</b> & more", "sub \"title\"");
  Table table;
  table.caption = "caption & <x>";
  table.columns = {"planner", "path [m]", "time"};
  table.add_row({"tsga", "790.0", "10:20"}).add_row({"nnb", "–", "11:09"}).add_row({"short"});
  Plot plot;
  plot.add("curve", {0, 1}, {0, 1});
  const std::vector<std::byte> png(100, std::byte{7});
  const std::vector<KeyFigure> figures{{"coverage", "98.1 %", "of what can be seen"}};
  report.add_heading("<script>alert(1)</script>")
      .add_paragraph("text")
      .add_preformatted("a\n  b")
      .add_key_figures(figures)
      .add_picture(png, "a \"picture\"", true)
      .add_plot(plot, true)
      .add_svg(color_bar_svg(SequentialMap{}, 0, 1, "range"), "caption")
      .add_table(table)
      .add_table({});
  const std::string html = report.html();
  CHECK(test_markup::well_formed(html) == "");
  CHECK(html.find("<script") == std::string::npos);
  for (const char* outside : {"src=\"http", "href=", "@import", "url("})
    CHECK(html.find(outside) == std::string::npos);
  CHECK(html.find("<td class=\"n\">790.0</td>") != std::string::npos);
  CHECK(html.find("<td>tsga</td>") != std::string::npos);
}

TEST(reports_are_written_whole_or_refused) {
  const auto path = std::filesystem::temp_directory_path() / "surfleet_report_test.html";
  Report("x").write(path);
  CHECK(std::filesystem::file_size(path) > 500);
  std::filesystem::remove(path);
  CHECK_THROWS(Error, Report("x").write("/nonexistent-folder/report.html"));
}

TEST(published_figures_stand_beside_ours) {
  using namespace surfleet::examples;
  const OwnRun own{.label = "this <run>", .robots = 3, .planner = "tsga", .total_path_m = 700.0};
  const Table table = comparison_table("powerplant", std::span(&own, 1));
  CHECK(table.rows.size() == 10 && table.rows[0][0] == "this <run>");
  for (const auto& row : table.rows) CHECK(row.size() == table.columns.size());
  CHECK(comparison_table("elsewhere", {}).rows.empty());
  for (const PublishedRun& run : published_runs()) {
    CHECK(run.total_path_m > 0.0 && run.completion_time_s > 0.0);
    if (std::isfinite(run.rmse_m))
      CHECK_NEAR(run.rmse_m, std::hypot(run.m3c2_mean_m, run.m3c2_std_m), 0.0006);
  }
  CHECK(published_values().size() == 17);
}
