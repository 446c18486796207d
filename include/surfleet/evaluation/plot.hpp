// SPDX-License-Identifier: MIT
/// @file
/// @brief Line plots and colour bars as SVG (strict XML, no scripts, no outside resources).
///
/// Axes and letters take the colour of the text around them (`currentColor`), so that an inlined
/// plot reads on light and on dark pages.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/evaluation/color_map.hpp>

namespace surfleet {
/// `text` as it may stand in the content or an attribute of XML or HTML; control characters that
/// XML forbids are dropped.
inline std::string escape_markup(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') out += c;
    }
  }
  return out;
}

/// One curve. Points with a value that is not finite interrupt it.
struct PlotSeries {
  std::string label = {};                   ///< Empty: not in the legend.
  std::vector<double> x = {}, y = {};       ///< Of equal length.
  std::vector<double> low = {};             ///< A band drawn around it, from `low` …
  std::vector<double> high = {};            ///< … to `high`; empty or of the same length.
  std::optional<Rgb> color = std::nullopt;  ///< By default the next of `categorical_color`.
  bool dashed = false;
  bool stepped = false;  ///< Each value holds until the next x.
  bool filled = false;   ///< Area down to zero.
};

/// A chart of curves over a common x axis.
struct Plot {
  std::string title;
  std::string x_label, y_label;
  std::vector<PlotSeries> series{};
  std::optional<double> y_min{}, y_max{};  ///< By default from the data, zero included when near.
  int width = 640, height = 340;  ///< [px] of the view box; the picture scales with the page.

  Plot& add(PlotSeries s) {
    series.push_back(std::move(s));
    return *this;
  }
  Plot& add(std::string label, std::vector<double> x, std::vector<double> y) {
    PlotSeries s;
    s.label = std::move(label);
    s.x = std::move(x);
    s.y = std::move(y);
    return add(std::move(s));
  }
};

namespace detail {
inline std::string plot_number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", std::abs(v) < 1e-12 ? 0.0 : v);
  return text;
}
inline std::string plot_coordinate(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", std::clamp(v, -1e6, 1e6));
  return text;
}
/// Round numbers, 1, 2 or 5 times a power of ten apart, that lie in [low, high].
inline std::vector<double> plot_ticks(double low, double high, int wanted) {
  const double raw = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double m : {5.0, 2.0, 1.0})
    if (m * power >= raw * 0.999) step = m * power;
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-9);
  for (int i = 0; i < 100; ++i) {
    const double tick = (first + i) * step;
    if (!(tick <= high + 1e-9 * step)) break;
    ticks.push_back(tick);
  }
  return ticks;
}
struct PlotRange {
  double low = 0.0, high = 1.0;
  bool set = false;
  void extend(double v) {
    if (!std::isfinite(v)) return;
    low = set ? std::min(low, v) : v;
    high = set ? std::max(high, v) : v;
    set = true;
  }
  void widen() {
    if (high - low < 1e-12 * std::max({1.0, std::abs(low), std::abs(high)})) {
      const double pad = std::max(0.5, 0.05 * std::abs(low));
      low -= pad;
      high += pad;
    }
  }
};
}  // namespace detail

/// The plot as one `<svg>` element, which is also a valid file of its own.
///
/// Curves of very many points are thinned to the extremes of each quarter pixel column, which
/// looks the same. O(points).
inline std::string to_svg(const Plot& plot) {
  using detail::plot_coordinate, detail::plot_number;
  detail::PlotRange xr, yr;
  for (const PlotSeries& s : plot.series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
      xr.extend(s.x[i]);
      yr.extend(s.y[i]);
      if (i < s.low.size() && i < s.high.size()) {
        yr.extend(s.low[i]);
        yr.extend(s.high[i]);
      }
    }
    if (s.filled) yr.extend(0.0);
  }
  if (yr.set && yr.low > 0.0 && yr.low < 0.4 * yr.high) yr.low = 0.0;
  xr.widen();
  yr.widen();
  if (yr.set && yr.low != 0.0) yr.low -= 0.04 * (yr.high - yr.low);
  if (yr.set && yr.high != 0.0) yr.high += 0.04 * (yr.high - yr.low);
  if (plot.y_min && std::isfinite(*plot.y_min)) yr.low = *plot.y_min;
  if (plot.y_max && std::isfinite(*plot.y_max)) yr.high = *plot.y_max;
  if (!(yr.high > yr.low)) yr.high = yr.low + 1.0;

  const auto color_of = [&](std::size_t i) {
    return css_color(plot.series[i].color.value_or(categorical_color(i)));
  };
  // The legend stands in rows under the title.
  const double left = 64, right = 16, bottom = 48;
  double top = plot.title.empty() ? 14 : 34;
  struct LegendEntry {
    std::size_t series;
    double x, y;
  };
  std::vector<LegendEntry> legend;
  double legend_x = left, legend_y = top + 4;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    if (plot.series[i].label.empty()) continue;
    const double wide = 34 + 6.6 * static_cast<double>(plot.series[i].label.size());
    if (legend_x > left && legend_x + wide > plot.width - right) {
      legend_x = left;
      legend_y += 18;
    }
    legend.push_back({i, legend_x, legend_y});
    legend_x += wide;
  }
  if (!legend.empty()) top = legend_y + 16;
  const double w = std::max(plot.width - left - right, 10.0);
  const double h = std::max(plot.height - top - bottom, 10.0);
  const auto px = [&](double x) { return left + (x - xr.low) / (xr.high - xr.low) * w; };
  const auto py = [&](double y) {
    return std::clamp(top + (yr.high - y) / (yr.high - yr.low) * h, top - 1e4, top + h + 1e4);
  };

  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
                    std::to_string(plot.width) + " " + std::to_string(plot.height) +
                    "\" role=\"img\" font-family=\"system-ui, sans-serif\" font-size=\"12\" "
                    "fill=\"currentColor\" stroke=\"none\">\n";
  svg += "<title>" + escape_markup(plot.title.empty() ? plot.y_label : plot.title) + "</title>\n";
  const auto text = [&](double x, double y, const char* anchor, const std::string& what,
                        const char* more = "") {
    svg += "<text x=\"" + plot_coordinate(x) + "\" y=\"" + plot_coordinate(y) +
           "\" text-anchor=\"" + anchor + "\"" + more + ">" + escape_markup(what) + "</text>\n";
  };
  const auto line = [&](double x0, double y0, double x1, double y1, const std::string& style) {
    svg += "<line x1=\"" + plot_coordinate(x0) + "\" y1=\"" + plot_coordinate(y0) + "\" x2=\"" +
           plot_coordinate(x1) + "\" y2=\"" + plot_coordinate(y1) + "\" " + style + "/>\n";
  };
  if (!plot.title.empty())
    text(left, 20, "start", plot.title, " font-size=\"14\" font-weight=\"600\"");
  const std::string grid = "stroke=\"currentColor\" stroke-opacity=\"0.15\"";
  for (const double tick : detail::plot_ticks(yr.low, yr.high, static_cast<int>(h / 45.0))) {
    line(left, py(tick), left + w, py(tick), grid);
    text(left - 8, py(tick) + 4, "end", plot_number(tick));
  }
  for (const double tick : detail::plot_ticks(xr.low, xr.high, static_cast<int>(w / 75.0))) {
    line(px(tick), top + h, px(tick), top + h + 5, "stroke=\"currentColor\"");
    text(px(tick), top + h + 19, "middle", plot_number(tick));
  }
  line(left, top + h, left + w, top + h, "stroke=\"currentColor\"");
  text(left + w / 2, top + h + 39, "middle", plot.x_label);
  if (!plot.y_label.empty()) {
    const std::string turn = " transform=\"rotate(-90 14 " + plot_coordinate(top + h / 2) + ")\"";
    text(14, top + h / 2, "middle", plot.y_label, turn.c_str());
  }

  // Everything of the data is cut at the frame by a nested viewport.
  svg += "<svg x=\"" + plot_coordinate(left) + "\" y=\"" + plot_coordinate(top - 2) +
         "\" width=\"" + plot_coordinate(w) + "\" height=\"" + plot_coordinate(h + 4) +
         "\" viewBox=\"" + plot_coordinate(left) + " " + plot_coordinate(top - 2) + " " +
         plot_coordinate(w) + " " + plot_coordinate(h + 4) + "\">\n";
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const PlotSeries& s = plot.series[i];
    const std::size_t n = std::min(s.x.size(), s.y.size());
    const std::string color = color_of(i);
    if (!s.low.empty() && s.low.size() >= n && s.high.size() >= n) {
      std::string points, back;
      for (std::size_t k = 0; k < n; ++k) {
        if (!std::isfinite(s.x[k]) || !std::isfinite(s.low[k]) || !std::isfinite(s.high[k]))
          continue;
        points += plot_coordinate(px(s.x[k])) + "," + plot_coordinate(py(s.high[k])) + " ";
        back = plot_coordinate(px(s.x[k])) + "," + plot_coordinate(py(s.low[k])) + " " + back;
      }
      svg += "<polygon points=\"" + points + back + "\" fill=\"" + color +
             "\" fill-opacity=\"0.18\"/>\n";
    }
    std::vector<std::pair<double, double>> run;  // pixel coordinates of one unbroken stretch
    const auto flush = [&] {
      if (run.size() == 1)
        svg += "<circle cx=\"" + plot_coordinate(run[0].first) + "\" cy=\"" +
               plot_coordinate(run[0].second) + "\" r=\"2.5\" fill=\"" + color + "\"/>\n";
      if (run.size() > 1) {
        std::string points;
        for (const auto& [x, y] : run)
          points += plot_coordinate(x) + "," + plot_coordinate(y) + " ";
        points.pop_back();
        if (s.filled) {
          const std::string zero = plot_coordinate(py(std::clamp(0.0, yr.low, yr.high)));
          svg += "<polygon points=\"" + plot_coordinate(run.front().first) + "," + zero + " " +
                 points + " " + plot_coordinate(run.back().first) + "," + zero + "\" fill=\"" +
                 color + "\" fill-opacity=\"0.3\"/>\n";
        }
        svg += "<polyline points=\"" + points + "\" fill=\"none\" stroke=\"" + color +
               "\" stroke-width=\"2\" stroke-linejoin=\"round\"" +
               (s.dashed ? " stroke-dasharray=\"6 4\"" : "") + "/>\n";
      }
      run.clear();
    };
    for (std::size_t k = 0; k < n; ++k) {
      if (!std::isfinite(s.x[k]) || !std::isfinite(s.y[k])) {
        flush();
        continue;
      }
      const std::pair<double, double> p(px(s.x[k]), py(s.y[k]));
      if (s.stepped && !run.empty()) run.emplace_back(p.first, run.back().second);
      // Within a quarter of a pixel column only the first, lowest, highest and last are kept.
      const std::size_t m = run.size();
      if (m >= 4 && std::abs(run[m - 4].first - p.first) < 0.25) {
        auto low = std::min(run[m - 2].second, run[m - 3].second);
        auto high = std::max(run[m - 2].second, run[m - 3].second);
        low = std::min(low, run[m - 1].second);
        high = std::max(high, run[m - 1].second);
        run[m - 3] = {run[m - 3].first, low};
        run[m - 2] = {run[m - 2].first, high};
        run[m - 1] = p;
      } else {
        run.push_back(p);
      }
    }
    flush();
  }
  svg += "</svg>\n";
  for (const LegendEntry& entry : legend) {
    const PlotSeries& s = plot.series[entry.series];
    line(entry.x, entry.y, entry.x + 20, entry.y,
         "stroke=\"" + color_of(entry.series) + "\" stroke-width=\"3\"" +
             (s.dashed ? " stroke-dasharray=\"6 4\"" : ""));
    text(entry.x + 25, entry.y + 4, "start", s.label);
  }
  if (!xr.set) text(left + w / 2, top + h / 2, "middle", "no data");
  return svg + "</svg>\n";
}

/// The legend of a colour map as an `<svg>` element: `low` at the left, `high` at the right.
template <ColorMap Map>
std::string color_bar_svg(const Map& map, double low, double high, const std::string& label) {
  using detail::plot_coordinate;
  constexpr int kWidth = 420, kCells = 84;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
                    std::to_string(kWidth) +
                    " 52\" role=\"img\" font-family=\"system-ui, sans-serif\" font-size=\"12\" "
                    "fill=\"currentColor\">\n<title>" +
                    escape_markup(label) + "</title>\n";
  const double cell = (kWidth - 40.0) / kCells;
  for (int i = 0; i < kCells; ++i)
    svg += "<rect x=\"" + plot_coordinate(20 + i * cell) + "\" y=\"2\" width=\"" +
           plot_coordinate(cell + 0.5) + "\" height=\"14\" fill=\"" +
           css_color(map((i + 0.5) / kCells)) + "\"/>\n";
  for (int i = 0; i <= 4; ++i)
    svg += "<text x=\"" + plot_coordinate(20 + i * (kWidth - 40.0) / 4) +
           "\" y=\"30\" text-anchor=\"middle\">" +
           escape_markup(detail::plot_number(low + (high - low) * i / 4)) + "</text>\n";
  return svg + "<text x=\"" + std::to_string(kWidth / 2) + "\" y=\"47\" text-anchor=\"middle\">" +
         escape_markup(label) + "</text>\n</svg>\n";
}
}  // namespace surfleet
