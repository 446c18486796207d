// SPDX-License-Identifier: MIT
#include <surfleet/coverage/mesh_graph.hpp>

#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(dirty_meshes_are_cleaned_or_refused) {
  TriangleMesh soup;
  const TriangleMesh slope = bumpy_slope({.edge = 0.2});
  for (std::size_t t = 0; t < slope.triangles.size(); ++t) {
    const auto base = static_cast<std::int32_t>(soup.vertices.size());
    for (std::size_t k = 0; k < 3; ++k) soup.vertices.push_back(slope.corner(t, k));
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  soup.triangles.push_back({0, 1, 1});
  soup.triangles.push_back({2, 1, 0});
  soup.vertices.push_back({7, 7, 7});
  SurfaceDefects defects;
  const TriangleMesh clean = clean_surface(soup, &defects);
  CHECK(clean.vertices.size() == slope.vertices.size());
  CHECK(clean.triangles.size() == slope.triangles.size());
  CHECK(defects.components == 1 && defects.removed_triangles == 2);
  CHECK(defects.nonmanifold_edges == 0);
  soup.vertices[0].x() = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS(Error, clean_surface(soup));
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  CHECK_THROWS(Error, clean_surface(flat));
}
}  // namespace
