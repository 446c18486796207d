// SPDX-License-Identifier: MIT
#include <surfleet/adapters/png_writer.hpp>

#include <array>
#include <filesystem>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(png_pictures_round_trip) {
  Random random(1);
  for (const auto& [w, h] : {std::pair{1, 1}, {37, 5}, {200, 150}}) {
    Image image(w, h);
    for (auto& byte : image.rgb) byte = static_cast<std::uint8_t>(random.below(256));
    const Bytes bytes = encode_png(image);
    const std::array<unsigned char, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    CHECK(std::memcmp(bytes.data(), signature.data(), signature.size()) == 0);
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    CHECK(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) != 0);
    header.format = PNG_FORMAT_RGB;
    CHECK(header.width == static_cast<unsigned>(w) && header.height == static_cast<unsigned>(h));
    std::vector<std::uint8_t> back(PNG_IMAGE_SIZE(header));
    CHECK(png_image_finish_read(&header, nullptr, back.data(), 0, nullptr) != 0);
    CHECK(back == image.rgb);
  }
}

TEST(png_files_are_written_or_refused) {
  const auto path = std::filesystem::temp_directory_path() / "surfleet_png_test.png";
  write_png(path, Image(4, 4));
  CHECK(read_file(path) == encode_png(Image(4, 4)));
  std::filesystem::remove(path);
  CHECK_THROWS(Error, encode_png(Image()));
  CHECK_THROWS(Error, write_png("/nonexistent-folder/x.png", Image(4, 4)));
}
