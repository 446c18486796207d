// SPDX-License-Identifier: MIT
#include <surfleet/geometry/grey_image.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

GreyImage parse(std::string_view text) { return parse_pgm(std::as_bytes(std::span(text)), "t"); }
TEST(pgm_files_are_read_and_refused) {
  GreyImage image(3, 2);
  for (std::size_t i = 0; i < 6; ++i) image.pixels[i] = static_cast<std::uint8_t>(40 * i);
  const GreyImage back = parse_pgm(format_pgm(image));
  CHECK(back.width == 3 && back.height == 2 && back.pixels == image.pixels);
  CHECK(parse("P2 # text\n2 1\n# more\n10\n0 10\n").pixels == std::vector<std::uint8_t>({0, 255}));
  for (const char* bad : {"", "P6\n1 1\n255\nabc", "P5\n1 1\n65535\nab", "P5\n9 9\n255\nabc",
                          "P5\n0 1\n255\n", "P5\n-1 1\n255\n", "P2\n2 1\n10\n0",
                          "P2\n2 1\n10\n0 11", "P5\n99999 1\n255\n", "P5\n16384 16384\n255\n"})
    CHECK_THROWS(Error, parse(bad));
  CHECK_THROWS(Error, GreyImage(0, 3));
  CHECK_THROWS(Error, read_pgm("no_such.pgm"));
}
}  // namespace
