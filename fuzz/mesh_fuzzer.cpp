// SPDX-License-Identifier: MIT
/// @file
/// @brief Fuzzes the mesh and cloud readers: the first byte chooses the format, the rest is the
/// file.
#include <surfleet/geometry/mesh_io.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  if (size == 0) return 0;
  constexpr std::array<std::string_view, 5> kFormats{".ply", ".obj", ".stl", ".off", ".xyz"};
  const std::string_view format = kFormats[data[0] % kFormats.size()];
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  try {
    if (format == ".xyz") {
      parse_point_cloud(bytes, format, "fuzz");
      return 0;
    }
    const TriangleMesh mesh = parse_mesh(bytes, format, "fuzz");
    for (const Triangle& t : mesh.triangles)
      for (const std::int32_t v : t)
        if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size()) std::abort();
    const TriangleMesh back = parse_mesh(ply_bytes(mesh), ".ply", "fuzz");
    if (back.vertices != mesh.vertices || back.triangles != mesh.triangles) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
