// SPDX-License-Identifier: MIT
/// @file
/// @brief Pictures from PNG files of any kind, by libpng.
#pragma once

#include <png.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/evaluation/image.hpp>
#include <surfleet/geometry/grey_image.hpp>

namespace surfleet {
namespace detail {
/// Pixels in one of libpng's 8-bit formats; `start(width, height)` makes room and says where.
template <typename Start>
void decode_png_pixels(std::span<const std::byte> bytes, png_uint_32 format,
                       const std::string& name, const Start& start) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto refuse = [&](const std::string& why) {
    png_image_free(&header);
    return Error(name + ": " + why + "; expected a PNG image of at most " +
                 std::to_string(kMostGreyPixels) + " pixels a side");
  };
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0)
    throw refuse(header.message);
  const std::size_t pixels =
      static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  if (header.width > kMostGreyPixels || header.height > kMostGreyPixels) throw refuse("too large");
  // A pixel takes at least a bit before compression, which shrinks 1040 times at most.
  if (pixels / 8 > 1040 * bytes.size()) throw refuse("the file ends early");
  header.format = format;
  const png_color black{0, 0, 0};  // behind what is transparent
  if (png_image_finish_read(&header, &black,
                            start(static_cast<int>(header.width), static_cast<int>(header.height)),
                            0, nullptr) == 0)
    throw refuse(header.message);
}
}  // namespace detail

/// Any PNG as a colour picture; `name` stands for the file in errors. Throws `Error` on a damaged
/// or oversized file. O(pixels).
inline Image decode_png(std::span<const std::byte> bytes, const std::string& name = "PNG") {
  Image image;
  detail::decode_png_pixels(bytes, PNG_FORMAT_RGB, name, [&](int width, int height) {
    image = Image(width, height);
    return image.rgb.data();
  });
  return image;
}
/// Any PNG as grey levels.
inline GreyImage decode_png_grey(std::span<const std::byte> bytes,
                                 const std::string& name = "PNG") {
  GreyImage image;
  detail::decode_png_pixels(bytes, PNG_FORMAT_GRAY, name, [&](int width, int height) {
    image = GreyImage(width, height);
    return image.pixels.data();
  });
  return image;
}
}  // namespace surfleet
