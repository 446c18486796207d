// SPDX-License-Identifier: MIT
/// @file
/// @brief Depth images as PNG of 16-bit grey, by libpng.
#pragma once

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// The longest side of a depth image that is read [px].
inline constexpr int kMostDepthPixels = 16384;
/// The greatest value of a pixel that is a depth; beyond it and at 0 there is no measurement.
inline constexpr int kMostDepthValue = 65534;

/// Width and height as the first bytes of a PNG file say [px]; nothing if they are not those of a
/// 16-bit grey image of at most `kMostDepthPixels` a side.
inline std::optional<std::pair<int, int>> png_depth_size(std::span<const std::byte> bytes) {
  constexpr std::array<unsigned char, 16> kStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                                 0,    0,   0,   13,  'I',  'H',  'D',  'R'};
  if (bytes.size() < 29 || std::memcmp(bytes.data(), kStart.data(), kStart.size()) != 0)
    return std::nullopt;
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<std::uint32_t>(bytes[at + i]);
    return v;
  };
  const std::uint32_t width = number(16), height = number(20);
  const bool grey16 = bytes[24] == std::byte{16} && bytes[25] == std::byte{0};
  constexpr std::uint32_t kMost = kMostDepthPixels;
  if (!grey16 || width == 0 || height == 0 || width > kMost || height > kMost) return std::nullopt;
  return std::pair(static_cast<int>(width), static_cast<int>(height));
}

namespace detail {
/// libpng's reader over bytes in memory. Its errors jump; no object with a destructor is made
/// between a jump's start and its end.
class PngSource {
 public:
  explicit PngSource(std::span<const std::byte> bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &on_error, &on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw Error("PNG: libpng cannot be started");
    }
  }
  ~PngSource() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngSource(const PngSource&) = delete;
  PngSource& operator=(const PngSource&) = delete;

  /// All rows, two bytes a pixel, the high one first; false, with `why`, if they are not to be had.
  bool read(unsigned char* rows, std::size_t row_bytes, std::size_t height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, &on_read);
    png_set_user_limits(png_, kMostDepthPixels, kMostDepthPixels);
    png_set_chunk_malloc_max(png_, 1U << 20);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png_, info_);
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != row_bytes || png_get_image_height(png_, info_) != height)
      png_error(png_, "header and image differ");
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t v = 0; v < height; ++v) png_read_row(png_, rows + v * row_bytes, nullptr);
    png_read_end(png_, nullptr);
    return true;
  }
  std::string why() const { return why_.data(); }

 private:
  static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<PngSource*>(png_get_error_ptr(png));
    std::snprintf(self->why_.data(), self->why_.size(), "%s", text);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp /*png*/, png_const_charp /*text*/) {}
  static void on_read(png_structp png, png_bytep out, png_size_t n) {
    auto* self = static_cast<PngSource*>(png_get_io_ptr(png));
    if (n > self->bytes_.size() - self->at_) png_error(png, "the file ends early");
    std::memcpy(out, self->bytes_.data() + self->at_, n);
    self->at_ += n;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::array<char, 128> why_{};
};
}  // namespace detail

/// A depth image from the bytes of a PNG file of 16-bit grey, `scale` units a metre. A pixel of 0
/// or 65535 is no measurement and becomes 0; `name` stands for the file in errors.
///
/// Throws `Error` on a damaged or truncated file, on one of other depth or colour, and on sizes
/// that are too large or that so few bytes cannot hold, before there is memory for them. O(pixels).
inline DepthImage decode_png_depth(std::span<const std::byte> bytes, double scale,
                                   const std::string& name = "PNG") {
  require(scale > 0.0 && std::isfinite(scale), "depth scale: expected positive units a metre");
  const auto size = png_depth_size(bytes);
  require(size.has_value(), name + ": expected a PNG image of 16-bit grey, at most " +
                                std::to_string(kMostDepthPixels) + " pixels a side");
  const auto width = static_cast<std::size_t>(size->first);
  const auto height = static_cast<std::size_t>(size->second);
  constexpr std::size_t kMostRatio = 1040;  // of deflate, a little more than it can reach
  require(2 * width * height <= kMostRatio * bytes.size(),
          name + ": ends early; expected a complete image");
  Bytes raw(2 * width * height);
  detail::PngSource source(bytes);
  if (!source.read(reinterpret_cast<unsigned char*>(raw.data()), 2 * width, height))
    throw Error(name + ": " + source.why() + "; expected a complete PNG image");
  DepthImage image(size->first, size->second);
  const auto metres = static_cast<float>(1.0 / scale);
  const auto* in = reinterpret_cast<const unsigned char*>(raw.data());
  float* out = image.depth.data();
  for (std::size_t i = 0; i < width * height; ++i) {
    const int value = in[2 * i] << 8 | in[2 * i + 1];
    out[i] = static_cast<float>(value <= kMostDepthValue ? value : 0) * metres;
  }
  return image;
}

/// The bytes of such a file, depths rounded to whole units; what is no measurement becomes 0, and
/// what is beyond the greatest value that value. Throws `Error` on an empty image.
inline Bytes encode_png_depth(const DepthImage& image, double scale) {
  require(scale > 0.0 && std::isfinite(scale), "depth scale: expected positive units a metre");
  require(
      image.width > 0 && image.height > 0 && image.width <= kMostDepthPixels &&
          image.height <= kMostDepthPixels &&
          image.depth.size() ==
              static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
      "PNG: expected a depth image of 1 to " + std::to_string(kMostDepthPixels) + " pixels a side");
  std::vector<png_uint_16> values(image.depth.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float d = image.depth[i];
    if (!DepthImage::is_measurement(d)) continue;
    // At least 1: a depth that rounds to nothing is still one.
    const double units = std::clamp(std::round(static_cast<double>(d) * scale), 1.0,
                                    static_cast<double>(kMostDepthValue));
    values[i] = static_cast<png_uint_16>(units);
  }
  // "Linear" is what libpng calls 16 bits that it is to write as they are.
  return detail::encode_png_pixels(image.width, image.height, PNG_FORMAT_LINEAR_Y,
                                   PNG_IMAGE_FLAG_FAST, values.data());
}
}  // namespace surfleet
