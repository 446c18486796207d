// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/plot.hpp>

#include <cmath>
#include <limits>

#include "check.hpp"
#include "well_formed.hpp"

using namespace surfleet;

TEST(markup_is_escaped) {
  CHECK(escape_markup("a<b> & \"c\" 'd'\x01") == "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(plots_are_well_formed_xml) {
  Plot plot;
  plot.title = "Coverage <of> \"A & B\"";
  plot.x_label = "time [s]";
  plot.y_label = "coverage [%]";
  plot.add("TSGA & co", {0, 1, 2, 3}, {0, 50, std::nan(""), 98});
  plot.add({.label = "band",
            .x = {0, 3},
            .y = {1, 2},
            .low = {0, 1},
            .high = {2, 3},
            .dashed = true,
            .stepped = true,
            .filled = true});
  const std::string svg = to_svg(plot);
  CHECK(test_markup::well_formed(svg) == "");
  CHECK(svg.find("TSGA &amp; co") != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos && svg.find("inf") == std::string::npos);
  CHECK(test_markup::well_formed(color_bar_svg(DivergingMap{}, -0.1, 0.1, "error [m] <&>")) == "");
}

TEST(plots_survive_odd_data) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> shelf{
      {}, {1}, {5, 5, 5}, {0, 0}, {-1e300, 1e300}, {1e-300, 2e-300}, {inf, -inf}, {1e9, 1e9 + 1}};
  for (const auto& v : shelf)
    for (const auto& w : shelf) {
      Plot plot;
      plot.add("x", v, w);
      const std::string svg = to_svg(plot);
      CHECK(test_markup::well_formed(svg) == "");
      CHECK(svg.find("nan") == std::string::npos && svg.find("inf") == std::string::npos);
      CHECK(svg.size() < 40000);
    }
  Plot narrow;
  narrow.width = narrow.height = 1;
  narrow.y_min = 3;
  narrow.y_max = 2;
  narrow.add("x", {0, 1}, {0, 1});
  CHECK(test_markup::well_formed(to_svg(narrow)) == "");
}

TEST(long_curves_are_thinned_but_keep_their_peaks) {
  std::vector<double> x, y;
  for (int i = 0; i < 200000; ++i) {
    x.push_back(i);
    y.push_back(i == 123456 ? 10.0 : std::sin(0.01 * i));
  }
  Plot plot;
  plot.y_min = 0.0;
  plot.y_max = 10.0;
  plot.add("", x, y);
  const std::string svg = to_svg(plot);
  CHECK(svg.size() < 400000);
  // The peak touches the top of the frame, which lies 14 px down when there is no title.
  CHECK(svg.find(",14.00") != std::string::npos);
}

TEST(ticks_are_round) {
  const auto t = detail::plot_ticks(0.0, 100.0, 5);
  CHECK(t.size() == 6 && t[1] == 20.0);
  const auto u = detail::plot_ticks(-0.013, 0.021, 4);
  CHECK(!u.empty() && u.size() <= 6);
  CHECK_NEAR(u[1] - u[0], 0.01, 1e-12);
}
