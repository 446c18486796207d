// SPDX-License-Identifier: MIT
#include <surfleet/adapters/png_reader.hpp>

#include <surfleet/adapters/png_writer.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(png_pictures_read_back_as_they_were) {
  Image image(7, 5);
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = static_cast<std::uint8_t>(37 * i % 256);
  const Bytes bytes = encode_png(image);
  const Image back = decode_png(bytes);
  CHECK(back.width == 7 && back.height == 5 && back.rgb == image.rgb);
  const GreyImage grey = decode_png_grey(encode_png(Image(4, 3, {90, 90, 90})));
  CHECK(grey.width == 4 && grey.height == 3 && grey(1, 1) == 90);
}
TEST(damaged_png_pictures_are_refused) {
  Bytes bytes = encode_png(Image(64, 64, {1, 2, 3}));
  CHECK_THROWS(Error, decode_png({}));
  CHECK_THROWS(Error, decode_png(std::span(bytes).first(20)));
  CHECK_THROWS(Error, decode_png_grey(std::span(bytes).first(bytes.size() / 2)));
  bytes[18] = std::byte{0x7f};  // a width of millions
  CHECK_THROWS(Error, decode_png(bytes));
}
}  // namespace
