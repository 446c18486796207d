// SPDX-License-Identifier: MIT
#include <surfleet/mapping/marching_cubes.hpp>

#include <map>
#include <set>
#include <utility>

#include "check.hpp"

using namespace surfleet;

namespace {
bool crossed(unsigned solid, int edge) {
  const CubeEdge e = cube_edge(edge);
  return ((solid >> e.lower ^ solid >> e.upper) & 1U) != 0U;
}
}  // namespace

TEST(cube_edges_are_the_twelve_edges) {
  std::set<std::pair<int, int>> seen;
  for (int e = 0; e < 12; ++e) {
    const CubeEdge edge = cube_edge(e);
    CHECK(edge.upper == (edge.lower | (1 << edge.axis)) && edge.upper != edge.lower);
    CHECK(edge.upper < 8);
    seen.insert({edge.lower, edge.upper});
  }
  CHECK(seen.size() == 12);
}

TEST(every_pattern_uses_exactly_its_crossings) {
  for (unsigned solid = 0; solid < 256; ++solid) {
    const CubeTriangles& c = cube_triangles()[solid];
    std::set<int> used;
    for (std::size_t t = 0; t < c.count; ++t)
      for (const int e : c.triangles[t]) used.insert(e);
    for (int e = 0; e < 12; ++e) CHECK(crossed(solid, e) == used.contains(e));
  }
  CHECK(cube_triangles()[0].count == 0 && cube_triangles()[255].count == 0);
}

TEST(no_line_is_drawn_twice_and_inner_lines_stay_inside) {
  for (unsigned solid = 0; solid < 256; ++solid) {
    const CubeTriangles& c = cube_triangles()[solid];
    std::map<std::pair<int, int>, int> directed;
    for (std::size_t t = 0; t < c.count; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        ++directed[{c.triangles[t][k], c.triangles[t][(k + 1) % 3]}];
    for (const auto& [line, count] : directed) {
      CHECK(count == 1);
      const bool inner = directed.contains({line.second, line.first});
      // Outline segments run within a face; what is inside must not, or a neighbour could draw it.
      CHECK(inner != detail::CubeTracer::on_one_face(line.first, line.second));
    }
  }
}

TEST(a_single_solid_corner_faces_the_empty_side) {
  const CubeTriangles& c = cube_triangles()[1];
  CHECK(c.count == 1);
  // Crossings on the three axes through the origin, anticlockwise seen from (1, 1, 1).
  int first = 0;
  while (cube_edge(c.triangles[0][static_cast<std::size_t>(first)]).axis != 0) ++first;
  for (int k = 0; k < 3; ++k)
    CHECK(cube_edge(c.triangles[0][static_cast<std::size_t>((first + k) % 3)]).axis == k);
}
