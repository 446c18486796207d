// SPDX-License-Identifier: MIT
#include <surfleet/coverage/covering_strip.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

void check_strip(const Graph& links, const CoveringStrip& strip) {
  for (std::size_t k = 1; k < strip.triangles.size(); ++k) {
    bool adjacent = false;
    for (const Arc& arc : links.arcs(strip.triangles[k - 1]))
      adjacent |= arc.to == strip.triangles[k];
    CHECK(adjacent);
  }
  double length = 0.0;
  for (std::size_t k = 1; k < strip.path.size(); ++k)
    length += (strip.path[k] - strip.path[k - 1]).norm();
  CHECK_NEAR(length, strip.length(), 1e-9);
  CHECK(strip.travelled.size() == strip.triangles.size());
}

TEST(a_strip_visits_every_triangle) {
  for (const TriangleMesh& mesh :
       {bumpy_slope({.edge = 0.05}), bumpy_slope({.edge = 0.1, .hole = true}),
        make_sphere(Point3::Zero(), 1.0, 3), make_torus(Point3::Zero(), 1.0, 0.4, 32, 16)}) {
    const SurfaceGraph dual = DualMeshGraph{}(mesh, EdgeGeodesic{});
    std::vector<std::int32_t> all(mesh.triangles.size());
    for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
    const CoveringStrip strip = covering_strip(mesh, dual.links, all, 17);
    check_strip(dual.links, strip);
    CHECK(strip.triangles.front() == 17);
    CHECK_NEAR(swept_fraction(mesh, std::span(&strip, 1)), 1.0, 0.0);
    CHECK(strip.length() < 1.2 * mesh.area() / strip_footprint(mesh));
  }
}

TEST(strips_of_small_regions) {
  const TriangleMesh mesh = bumpy_slope({.edge = 0.4});
  const SurfaceGraph dual = DualMeshGraph{}(mesh, EdgeGeodesic{});
  const std::vector<std::int32_t> one{5};
  CHECK(covering_strip(mesh, dual.links, one, 5).triangles == one);
  CHECK(covering_strip(mesh, dual.links, one, 5).length() == 0.0);
  CHECK_THROWS(Error, covering_strip(mesh, dual.links, one, 4));
  const std::vector<std::int32_t> apart{0, static_cast<std::int32_t>(mesh.triangles.size()) - 1};
  CHECK_THROWS(Error, covering_strip(mesh, dual.links, apart, 0));
  CHECK(covering_strip(mesh, dual.links, {}, 0).triangles.empty());
}
}  // namespace
