// SPDX-License-Identifier: MIT
/// @file
/// @brief A picture of grey levels in memory, and PGM files of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/geometry/text_scanner.hpp>

namespace surfleet {
/// The longest side of a grey image [px].
inline constexpr int kMostGreyPixels = 16384;

/// Rows from the top, pixels from the left, a byte each.
struct GreyImage {
  int width = 0, height = 0;  ///< [px]
  std::vector<std::uint8_t> pixels;

  GreyImage() = default;
  /// Throws `Error` unless both sides are in [1, 16384].
  GreyImage(int w, int h, std::uint8_t fill = 0) : width(w), height(h) {
    require(w > 0 && h > 0 && w <= kMostGreyPixels && h <= kMostGreyPixels,
            "grey image: expected 1 to 16384 pixels a side");
    pixels.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill);
  }

  const std::uint8_t* row(int v) const {
    return pixels.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
  }
  std::uint8_t* row(int v) {
    return pixels.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
  }
  std::uint8_t operator()(int u, int v) const { return row(v)[u]; }
  std::uint8_t& operator()(int u, int v) { return row(v)[u]; }
};

/// An image from the bytes of a PGM file, binary (P5) or text (P2), whose greatest value is 1 to
/// 255 and becomes 255. Throws `Error` on anything else, before there is memory for it.
inline GreyImage parse_pgm(std::span<const std::byte> bytes, const std::string& name = "PGM") {
  const std::string_view text = text_of(bytes);
  std::size_t at = 0;
  const auto refuse = [&](const char* why) {
    return Error(name + ": " + why + "; expected a PGM image (P5 or P2) of 8 bits");
  };
  const auto word = [&]() -> std::string_view {
    for (;;) {
      while (at < text.size() && TextScanner::is_space(text[at])) ++at;
      if (at >= text.size() || text[at] != '#') break;
      while (at < text.size() && text[at] != '\n') ++at;
    }
    const std::size_t start = at;
    while (at < text.size() && !TextScanner::is_space(text[at])) ++at;
    return text.substr(start, at - start);
  };
  const auto number = [&](int most) {
    const auto value = parse_number<int>(word());
    if (!value || *value < 0 || *value > most) throw refuse("a number is missing or out of range");
    return *value;
  };
  const std::string_view magic = word();
  if (magic != "P5" && magic != "P2") throw refuse("no such file");
  const int width = number(kMostGreyPixels), height = number(kMostGreyPixels), most = number(255);
  if (width == 0 || height == 0 || most == 0) throw refuse("an empty image");
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (at < text.size()) ++at;  // one blank ends the header
  if (text.size() - at < count) throw refuse("the file ends early");
  GreyImage image(width, height);
  for (std::size_t i = 0; i < count; ++i) {
    const int value = magic == "P2" ? number(most) : static_cast<unsigned char>(text[at + i]);
    image.pixels[i] = static_cast<std::uint8_t>(value >= most ? 255 : value * 255 / most);
  }
  return image;
}
inline GreyImage read_pgm(const std::filesystem::path& path) {
  return parse_pgm(read_file(path), path.string());
}
/// The bytes of such a file, binary.
inline Bytes format_pgm(const GreyImage& image) {
  ByteWriter out;
  out.put_text("P5\n" + std::to_string(image.width) + " " + std::to_string(image.height) +
               "\n255\n");
  out.put_array(std::span<const std::uint8_t>(image.pixels));
  return out.take();
}
}  // namespace surfleet
