// SPDX-License-Identifier: MIT
/// @file
/// @brief Pictures as PNG, by libpng.
#pragma once

#include <png.h>

#include <filesystem>
#include <string>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/evaluation/image.hpp>

namespace surfleet {
namespace detail {
/// The bytes of a PNG file of pixels in one of libpng's formats, row by row without gaps.
inline Bytes encode_png_pixels(int width, int height, png_uint_32 format, png_uint_32 flags,
                               const void* pixels) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width);
  header.height = static_cast<png_uint_32>(height);
  header.format = format;
  header.flags = flags;
  // Written to a buffer of the largest possible size, so that the picture is compressed once.
  Bytes bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels, 0, nullptr) == 0) {
    const std::string why = header.message;
    png_image_free(&header);
    throw Error("PNG: " + why);
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}
}  // namespace detail

/// `image` as the bytes of a PNG file. Throws `Error` on an empty image.
inline Bytes encode_png(const Image& image) {
  require(image.width > 0 && image.height > 0 &&
              image.rgb.size() == image.offset(image.width - 1, image.height - 1) + 3,
          "PNG: expected an image with at least one pixel and three bytes for each");
  return detail::encode_png_pixels(image.width, image.height, PNG_FORMAT_RGB, 0, image.rgb.data());
}

inline void write_png(const std::filesystem::path& path, const Image& image) {
  write_file(path, encode_png(image));
}
}  // namespace surfleet
