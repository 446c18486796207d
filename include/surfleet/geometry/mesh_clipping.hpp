// SPDX-License-Identifier: MIT
/// @file
/// @brief The part of a mesh where a function of its vertices is positive.
///
///     const TriangleMesh above = clipped(mesh, heights_of(mesh.vertices));
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Cuts triangles along the zero of a function that is linear on each of them and `values` at the
/// vertices, finite; what is positive remains, facing as before, without attributes. Triangles
/// that share an edge share the vertex on it, so that no cracks open. O(vertices + triangles).
/// Throws `Error` unless there is one value a vertex.
inline TriangleMesh clipped(const TriangleMesh& mesh, std::span<const double> values) {
  require(values.size() == mesh.vertices.size(), "clipped mesh: expected one value a vertex");
  TriangleMesh part;
  std::vector<std::int32_t> renamed(mesh.vertices.size(), -1);
  std::unordered_map<std::uint64_t, std::int32_t> cuts;  // by the edge's ends
  const auto add = [&](const Point3& p) {
    part.vertices.push_back(p);
    return static_cast<std::int32_t>(part.vertices.size() - 1);
  };
  const auto kept = [&](std::size_t v) {
    if (renamed[v] < 0) renamed[v] = add(mesh.vertices[v]);
    return renamed[v];
  };
  const auto cut = [&](std::size_t a, std::size_t b) {
    if (a > b) std::swap(a, b);
    const auto [it, is_new] = cuts.try_emplace(std::uint64_t{a} << 32 | b, 0);
    if (is_new) {
      const double t = values[a] / (values[a] - values[b]);
      it->second = add(mesh.vertices[a] + t * (mesh.vertices[b] - mesh.vertices[a]));
    }
    return it->second;
  };
  for (const Triangle& triangle : mesh.triangles) {
    std::array<std::int32_t, 4> polygon;
    std::size_t corners = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(triangle[k]);
      const auto b = static_cast<std::size_t>(triangle[(k + 1) % 3]);
      if (values[a] > 0.0) polygon[corners++] = kept(a);
      if ((values[a] > 0.0) != (values[b] > 0.0)) polygon[corners++] = cut(a, b);
    }
    part.add_fan({polygon.data(), corners});
  }
  return part;
}
}  // namespace surfleet
