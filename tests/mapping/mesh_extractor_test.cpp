// SPDX-License-Identifier: MIT
#include <surfleet/mapping/mesh_extractor.hpp>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
template <typename Field>
void fill(TsdfMap& map, const VoxelIndex& low, const VoxelIndex& high, Field&& field) {
  for (int z = low.z(); z < high.z(); ++z)
    for (int y = low.y(); y < high.y(); ++y)
      for (int x = low.x(); x < high.x(); ++x) {
        const VoxelIndex v(x, y, z);
        map.ensure(v) = {static_cast<float>(field(v)), 1.0F};
      }
  for (std::uint32_t s = 0; s < map.block_count(); ++s) map.mark_changed(s);
}

/// Every edge is used once in either direction.
bool closed_and_oriented(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> directed;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
  return std::all_of(directed.begin(), directed.end(), [&](const auto& e) {
    const auto back = directed.find({e.first.second, e.first.first});
    return e.first.first != e.first.second && e.second == 1 && back != directed.end() &&
           back->second == 1;
  });
}

/// The triangles around every vertex form one ring.
bool vertices_are_manifold(const TriangleMesh& mesh) {
  std::vector<std::map<int, int>> next(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      next[static_cast<std::size_t>(t[k])][t[(k + 1) % 3]] = t[(k + 2) % 3];
  for (const auto& ring : next) {
    if (ring.empty()) return false;
    std::size_t n = 0;
    int at = ring.begin()->first;
    do {
      const auto it = ring.find(at);
      if (it == ring.end()) return false;
      at = it->second;
    } while (++n <= ring.size() && at != ring.begin()->first);
    if (n != ring.size()) return false;
  }
  return true;
}

double volume(const TriangleMesh& mesh) {
  double v = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    v += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2))) / 6.0;
  return v;
}

using SortedTriangle = std::array<std::array<double, 3>, 3>;
std::vector<SortedTriangle> sorted_triangles(const TriangleMesh& mesh) {
  std::vector<SortedTriangle> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    SortedTriangle s;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3& p = mesh.corner(t, k);
      s[k] = {p.x(), p.y(), p.z()};
    }
    std::rotate(s.begin(), std::min_element(s.begin(), s.end()), s.end());
    all.push_back(s);
  }
  std::sort(all.begin(), all.end());
  return all;
}
}  // namespace

TEST(random_fields_give_closed_oriented_manifolds) {
  Random random(7);
  for (int round = 0; round < 20; ++round) {
    TsdfMap map({.voxel_size = 0.25});
    const VoxelIndex low(-9, -3, 5), high(11, 14, 22);
    const double solid = round % 4 == 0 ? 0.5 : random.uniform(0.1, 0.9);
    fill(map, low, high, [&](const VoxelIndex& v) {
      const bool border = (v - low).minCoeff() == 0 || (high - v).minCoeff() == 1;
      // Some values are exactly zero: they count as solid.
      const double size = random.below(20) == 0 ? 0.0 : random.uniform(0.0, 1.0);
      return border || random.uniform() > solid ? size + 1e-3 : -size;
    });
    const TriangleMesh mesh = extract_mesh(map);
    CHECK(mesh.triangles.size() > 1000);
    CHECK(closed_and_oriented(mesh));
    CHECK(vertices_are_manifold(mesh));
    CHECK(volume(mesh) > 0.0);
    CHECK(mesh.normals.size() == mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) CHECK(mesh.area(t) > 0.0);
  }
}

TEST(sphere_has_its_radius_volume_and_outward_normals) {
  for (const Point3& center : {Point3(0.3, -0.2, 0.1), Point3(-5000.05, 3000.0, 800.0)}) {
    TsdfMap map({.voxel_size = 0.1});
    const VoxelIndex c = map.index_of(center);
    const double radius = 1.3;
    fill(map, c - VoxelIndex::Constant(16), c + VoxelIndex::Constant(17),
         [&](const VoxelIndex& v) { return (map.center(v) - center).norm() - radius; });
    TriangleMesh mesh = extract_mesh(map);
    CHECK(closed_and_oriented(mesh) && vertices_are_manifold(mesh));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Point3 d = mesh.vertices[i] - center;
      CHECK_NEAR(d.norm(), radius, 1.5e-3);
      CHECK(d.normalized().dot(mesh.normals[i].cast<double>()) > 0.97);
    }
    for (Point3& v : mesh.vertices) v -= center;
    CHECK_NEAR(volume(mesh), 4.0 / 3.0 * kPi * radius * radius * radius, 0.05);
    const auto chi = static_cast<long>(mesh.vertices.size()) -
                     static_cast<long>(mesh.triangles.size() * 3 / 2) +
                     static_cast<long>(mesh.triangles.size());
    CHECK(chi == 2);
  }
}

TEST(incremental_equals_from_scratch) {
  Random random(3);
  TsdfMap map({.voxel_size = 0.5});
  MeshExtractor incremental({.min_weight = 0.5});
  for (int round = 0; round < 30; ++round) {
    // Change some voxels of a few random blocks, among them unknown ones.
    for (int b = 0; b < 3; ++b) {
      const BlockIndex index(static_cast<int>(random.below(4)) - 2,
                             static_cast<int>(random.below(4)) - 2,
                             static_cast<int>(random.below(4)) - 2);
      const std::uint32_t slot = map.ensure_slot(index);
      for (TsdfVoxel& v : map.block(slot).voxels)
        if (random.below(3) != 0)
          v = {static_cast<float>(random.uniform(-1, 1)),
               static_cast<float>(random.below(8) == 0 ? 0.0 : 1.0)};
      map.mark_changed(slot);
    }
    CHECK(incremental.update(map) > 0);
    const auto ours = sorted_triangles(incremental.mesh());
    const auto fresh = sorted_triangles(extract_mesh(map, {.min_weight = 0.5}));
    CHECK(!fresh.empty() && ours == fresh);
    CHECK(incremental.update(map) == 0);
  }
}

TEST(threads_give_the_same_mesh) {
  Random random(11);
  TsdfMap map;
  fill(map, VoxelIndex(-20, -20, -20), VoxelIndex(20, 20, 20),
       [&](const VoxelIndex&) { return random.uniform(-1, 1); });
  const TriangleMesh one = extract_mesh(map), two = extract_mesh(map, {.threads = 2});
  CHECK(one.vertices == two.vertices && one.triangles == two.triangles);
}

TEST(no_surface_beside_the_unknown) {
  TsdfMap map({.voxel_size = 1.0});
  fill(map, VoxelIndex(0, 0, 0), VoxelIndex(2, 2, 2),
       [](const VoxelIndex& v) { return v.z() - 0.5; });
  TriangleMesh mesh = extract_mesh(map);
  CHECK(mesh.triangles.size() == 2 && mesh.vertices.size() == 4);
  CHECK(mesh.normals.front().isApprox(Eigen::Vector3f::UnitZ()));
  for (const Point3& v : mesh.vertices) CHECK_NEAR(v.z(), 1.0, 1e-6);
  map.ensure(VoxelIndex(1, 1, 1)).weight = 1e-5F;
  CHECK(extract_mesh(map).empty());
  CHECK(extract_mesh(map, {.min_weight = 0.0}).triangles.size() == 2);
  CHECK(extract_mesh(TsdfMap{}).empty());
}

TEST(what_is_unknown_a_voxel_behind_a_surface_leaves_no_gaps) {
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 1, 1), Eigen::Vector3d(1, 1, 1),
        Eigen::Vector3d(-1, 2, 3), Eigen::Vector3d(0.1, -1, 0.9)}) {
    const Eigen::Vector3d n = direction.normalized();
    TsdfMap map({.voxel_size = 1.0});
    fill(map, VoxelIndex(-9, -9, -9), VoxelIndex(9, 9, 9),
         [&](const VoxelIndex& v) { return n.dot(map.center(v)) - 0.37; });
    const auto whole = sorted_triangles(extract_mesh(map));
    for (std::uint32_t s = 0; s < map.block_count(); ++s)
      for (TsdfVoxel& v : map.block(s).voxels)
        if (v.distance < -1.0F) v.weight = 0.0F;
    CHECK(whole.size() > 200 && sorted_triangles(extract_mesh(map)) == whole);
    // Without the other end of an edge that it crosses there is none.
    for (std::uint32_t s = 0; s < map.block_count(); ++s)
      for (TsdfVoxel& v : map.block(s).voxels)
        if (v.distance < 0.0F) v.weight = 0.0F;
    CHECK(extract_mesh(map).empty());
  }
}

TEST(steep_cubes_are_left_out) {
  TsdfMap map({.voxel_size = 1.0});
  fill(map, VoxelIndex(0, 0, 0), VoxelIndex(6, 4, 4),
       [](const VoxelIndex& v) { return v.x() < 3 ? v.z() - 1.5 : (v.z() < 2 ? -3.0 : 3.0); });
  const auto all = extract_mesh(map).triangles.size();
  const auto gentle = extract_mesh(map, {.max_step = 2.0}).triangles.size();
  CHECK(gentle > 0 && gentle < all);
}
