// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/image.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(pixels_are_where_they_were_put) {
  Image image(3, 2, {9, 8, 7});
  image.set(2, 1, {1, 2, 3});
  CHECK(image.rgb.size() == 18 && image(0, 0) == (Rgb{9, 8, 7}) && image(2, 1) == (Rgb{1, 2, 3}));
  CHECK(image.rgb[17] == 3);
  CHECK_THROWS(Error, Image(0, 5));
  CHECK_THROWS(Error, Image(5, 1 << 20));
}
