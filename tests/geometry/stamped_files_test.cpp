// SPDX-License-Identifier: MIT
#include <surfleet/geometry/stamped_files.hpp>

#include <cmath>
#include <string>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(stamped_files_are_read_line_by_line) {
  const auto files = parse_stamped_files(
      "# depth maps\r\n# timestamp filename\r\n1305031102.160407 depth/a.png\r\n\r\n"
      "\t1305031102.194330\tdepth/b.png  \n  # end");
  CHECK(files.size() == 2);
  CHECK(files[0].time == 1305031102.160407 && files[0].file == "depth/a.png");
  CHECK(files[1].time == 1305031102.194330 && files[1].file == "depth/b.png");
  CHECK(parse_stamped_files("").empty());
  for (const char* text : {"1.0\n", "a.png 1.0\n", "nan a.png", "1.0 a.png b.png", "inf a.png"})
    CHECK_THROWS(Error, parse_stamped_files(text));
  try {
    static_cast<void>(parse_stamped_files("# x\n1 a\n2\n", "depth.txt"));
    CHECK(false);
  } catch (const Error& e) {
    CHECK(std::string(e.what()).starts_with("depth.txt: line 3: "));
  }
}

TEST(bad_lines_are_passed_over_where_that_is_asked_for) {
  std::vector<std::string> told;
  const auto files = parse_stamped_files("1 a\n2\nx b\n3 c", "depth.txt",
                                         [&](const std::string& why) { told.push_back(why); });
  CHECK(files.size() == 2 && files[1].file == "c");
  CHECK(told.size() == 2 && told[1].starts_with("depth.txt: line 3: "));
}

TEST(nearest_in_time_is_that_of_a_full_search) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> times;
    for (std::size_t i = random.below(8); i > 0; --i)
      times.push_back(0.25 * static_cast<double>(random.below(20)));
    std::sort(times.begin(), times.end());
    const double at = 0.125 * static_cast<double>(random.below(50)) - 0.5, tolerance = 0.5;
    double least = 1e9;
    for (const double t : times) least = std::min(least, std::abs(t - at));
    const auto found = nearest_in_time(times, at, tolerance);
    CHECK(found.has_value() == (least <= tolerance));
    if (found) CHECK(std::abs(times[*found] - at) == least);
  }
  CHECK(*nearest_in_time(std::vector{1.0, 2.0}, 1.5, 1.0) == 0);
}
