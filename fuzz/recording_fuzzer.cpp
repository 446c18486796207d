// SPDX-License-Identifier: MIT
/// @file
/// @brief Fuzzes the readers of recordings: the first byte chooses the format, the rest is the
/// file.
#include <surfleet/adapters/png_depth.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/geometry/pose_io.hpp>
#include <surfleet/geometry/stamped_files.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    switch (data[0] % 5) {
      case 0: {
        const Pose pose = parse_pose(text);
        if (!pose.matrix().allFinite() || !(pose.linear().determinant() > 0.9)) std::abort();
        if (parse_pose(format_pose(pose)).matrix() != pose.matrix()) std::abort();
        break;
      }
      case 1: {
        const Intrinsics k = parse_intrinsics(text);
        if (parse_intrinsics(format_intrinsics(k)).cx != k.cx) std::abort();
        break;
      }
      case 2:
        for (const StampedFile& f : parse_stamped_files(text))
          if (f.file.empty()) std::abort();
        break;
      case 3:
        parse_tum(text);
        break;
      default: {
        const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
        const DepthImage image = decode_png_depth(bytes, 1000.0);
        const DepthImage back = decode_png_depth(encode_png_depth(image, 1000.0), 1000.0);
        if (back.depth != image.depth) std::abort();
      }
    }
  } catch (const Error&) {
  }
  return 0;
}
