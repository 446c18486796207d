// SPDX-License-Identifier: MIT
#include <surfleet/adapters/png_depth.hpp>

#include <cstddef>
#include <limits>
#include <vector>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// The file with other bytes in its header, whose checksum is set right.
Bytes with_header(Bytes png, std::size_t at, std::vector<unsigned char> values) {
  for (std::size_t i = 0; i < values.size(); ++i) png[at + i] = std::byte{values[i]};
  const std::uint32_t crc = crc32(std::span(png).subspan(12, 17));
  for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<std::byte>(crc >> (24 - 8 * i));
  return png;
}
DepthImage slope() {
  DepthImage image(64, 48);
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) image(u, v) = 1.0F + 0.01F * static_cast<float>(u + v);
  return image;
}
}  // namespace

TEST(png_depths_round_trip_in_whole_units) {
  Random random(1);
  for (const auto& [w, h] : {std::pair{1, 1}, {37, 5}, {160, 92}}) {
    DepthImage image(w, h);
    for (float& d : image.depth) d = static_cast<float>(random.below(65535)) / 1000.0F;
    const Bytes bytes = encode_png_depth(image, 1000.0);
    CHECK(png_depth_size(bytes) == std::pair(w, h));
    const DepthImage back = decode_png_depth(bytes, 1000.0);
    CHECK(back.width == w && back.height == h);
    float worst = 0.0F;
    for (std::size_t i = 0; i < image.depth.size(); ++i)
      worst = std::max(worst, std::abs(back.depth[i] - image.depth[i]));
    CHECK(worst < 1e-5F);
    const DepthImage other = decode_png_depth(bytes, 5000.0);
    CHECK_NEAR(other.depth.back(), back.depth.back() / 5.0F, 1e-5);
  }
}

TEST(png_depths_without_measurement_are_nought) {
  DepthImage image(6, 1);
  image.depth = {
      0.0F,  -1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
      1e-6F, 1e6F};
  const DepthImage back = decode_png_depth(encode_png_depth(image, 1000.0), 1000.0);
  for (std::size_t i = 0; i < 4; ++i) CHECK(back.depth[i] == 0.0F);
  CHECK_NEAR(back.depth[4], 0.001, 1e-9);
  CHECK_NEAR(back.depth[5], 65.534, 1e-5);
  // The sensor's own "nothing", as some write it.
  std::vector<png_uint_16> values{65535, 65534, 0, 1};
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = 4;
  header.height = 1;
  header.format = PNG_FORMAT_LINEAR_Y;
  Bytes bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  CHECK(png_image_write_to_memory(&header, bytes.data(), &size, 0, values.data(), 0, nullptr) != 0);
  bytes.resize(size);
  const DepthImage raw = decode_png_depth(bytes, 1.0);
  CHECK(raw.depth == std::vector<float>({0.0F, 65534.0F, 0.0F, 1.0F}));
}

TEST(png_depths_cut_short_or_damaged_are_refused) {
  const Bytes whole = encode_png_depth(slope(), 1000.0);
  for (std::size_t n = 0; n < whole.size(); n += n < 64 ? 1 : 37)
    CHECK_THROWS(Error, decode_png_depth(std::span(whole).first(n), 1000.0));
  CHECK_THROWS(Error, decode_png_depth(std::span(whole).first(whole.size() - 1), 1000.0));
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    Bytes bad = whole;
    bad[random.below(bad.size())] ^= static_cast<std::byte>(1U << random.below(8));
    try {
      CHECK(decode_png_depth(bad, 1000.0).depth.size() == slope().depth.size());
    } catch (const Error&) {
    }
  }
}

TEST(png_depths_of_hostile_or_wrong_headers_are_refused) {
  const Bytes whole = encode_png_depth(slope(), 1000.0);
  // Sizes that would be half a gigabyte, too large a side, nought; none is believed.
  for (const auto& side :
       std::vector<std::vector<unsigned char>>{{0, 0, 0x40, 0, 0, 0, 0x40, 0},
                                               {0, 1, 0, 0, 0, 0, 0, 1},
                                               {0x7f, 0xff, 0xff, 0xff, 0, 0, 0, 1},
                                               {0, 0, 0, 0, 0, 0, 0, 48},
                                               {0, 0, 0, 64, 0, 0, 0, 0},
                                               {0, 0, 0, 64, 0, 0, 0, 49}})
    CHECK_THROWS(Error, decode_png_depth(with_header(whole, 16, side), 1000.0));
  // Eight bits, colour, a palette.
  for (const auto& kind : std::vector<std::vector<unsigned char>>{{8, 0}, {16, 2}, {8, 3}})
    CHECK_THROWS(Error, decode_png_depth(with_header(whole, 24, kind), 1000.0));
  CHECK_THROWS(Error, decode_png_depth(encode_png(Image(64, 48)), 1000.0));
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS(Error, decode_png_depth(whole, scale));
  CHECK_THROWS(Error, encode_png_depth(DepthImage(), 1000.0));
}
