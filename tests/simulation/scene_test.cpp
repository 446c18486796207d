// SPDX-License-Identifier: MIT
#include <surfleet/simulation/scene.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/simulation/scenes.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
void check_scene(const Scene& scene, const Eigen::Vector3d& size) {
  const TriangleMesh structure = scene.structure();
  Box3 box;
  for (const Triangle& t : structure.triangles)
    for (const std::int32_t v : t) box.extend(structure.vertices[static_cast<std::size_t>(v)]);
  CHECK((box.sizes() - size).norm() < 0.02);
  CHECK_NEAR(box.min().z(), 0.0, 1e-9);
  for (const Point3& v : scene.mesh.vertices) CHECK(v.allFinite());
  // Every part is a closed shell that faces outward.
  CHECK(closed_parts(structure).triangles.size() == structure.triangles.size());
  const MeshComponents parts = connected_components(structure);
  std::vector<double> volume(parts.count, 0.0);
  for (std::size_t t = 0; t < structure.triangles.size(); ++t)
    volume[static_cast<std::size_t>(parts.of_triangle[t])] +=
        structure.corner(t, 0).dot(structure.corner(t, 1).cross(structure.corner(t, 2)));
  for (const double v : volume) CHECK(v > 0.0);
  CHECK(scene.region.min().z() > 0.0 && scene.bounds.contains(scene.region));
  const SceneSpace space(scene.mesh);
  for (const int robots : {1, 5, 10}) {
    const auto starts = starting_places(scene, space, robots);
    CHECK(static_cast<int>(starts.size()) == robots);
    CHECK(starts[0].position == scene.station.position);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      CHECK(space.clearance(starts[i].position) >= 1.3);
      for (std::size_t j = 0; j < i; ++j)
        CHECK((starts[i].position - starts[j].position).norm() > 2.5);
    }
  }
}
}  // namespace

TEST(bundled_scenes_are_sound) {
  check_scene(powerplant_scene(), {65, 42, 15});
  check_scene(statue_scene(), {20, 20, 60});
  check_scene(house_scene(), {8, 6, 5});
}

TEST(bundled_scenes_by_name) {
  for (const std::string_view name : {"house", "powerplant"}) {
    const Scene a = scene_by_name(name), b = scene_by_name(name);
    CHECK(a.name == name && a.mesh.vertices == b.mesh.vertices);
    CHECK(a.mesh.triangles == b.mesh.triangles);
  }
  CHECK_THROWS(Error, scene_by_name("castle"));
}

TEST(any_mesh_becomes_a_scene) {
  const Scene box = scene_from_mesh(make_box({100, 200, 5}, {104, 206, 9}), {.ground = 5.0});
  CHECK(box.has_ground && box.mesh.triangles.size() == 14 && box.structure_triangles == 12);
  CHECK(box.bounds.min().z() == 5.0 && box.region.min().z() > 5.0);
  const SceneSpace space(box.mesh);
  CHECK(space.is_free(box.station.position, 1.3));
  CHECK(space.is_solid({102, 203, 7}) && !space.is_solid({98, 203, 7}));
  // A soup without any order.
  Random random(3);
  TriangleMesh soup;
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k)
      soup.vertices.emplace_back(random.uniform(-3, 3), random.uniform(-3, 3),
                                 random.uniform(0, 4));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Scene messy = scene_from_mesh(soup);
  CHECK(!messy.has_ground && SceneSpace(messy.mesh).is_free(messy.station.position, 1.3));
  CHECK(starting_places(messy, 4).size() == 4);
}

TEST(a_shell_facing_inward_is_a_room) {
  TriangleMesh room = make_box({0, 0, 0}, {9, 7, 4});
  for (Triangle& t : room.triangles) std::swap(t[0], t[1]);
  const Scene scene = scene_from_mesh(room);
  CHECK(Box3(Point3(0, 0, 0), Point3(9, 7, 4)).contains(scene.station.position));
  CHECK(SceneSpace(scene.mesh).clearance(scene.station.position) >= 1.3);
}

TEST(bad_scenes_are_refused) {
  const TriangleMesh box = make_box({0, 0, 0}, {4, 4, 4});
  CHECK_THROWS(Error, scene_from_mesh(TriangleMesh{}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.start = Point3(2, 2, 2)}));     // inside
  CHECK_THROWS(Error, scene_from_mesh(box, {.start = Point3(-0.5, 2, 2)}));  // too near
  CHECK_THROWS(Error, scene_from_mesh(box, {.start = Point3(-99, 2, 2)}));   // out of bounds
  CHECK_THROWS(Error, scene_from_mesh(box, {.start = Point3(2, -3, 0.5), .ground = 0.0}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.ground = 5.0}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.standoff = -1.0}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.bounds = Box3(Point3(9, 9, 9), Point3(10, 10, 10))}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.bounds = Box3(Point3(1, 1, 1), Point3(2, 2, 2))}));
  TriangleMesh dot = box;
  for (Point3& v : dot.vertices) v.setZero();
  CHECK_THROWS(Error, scene_from_mesh(dot));
  const Scene scene = scene_from_mesh(box);
  CHECK_THROWS(Error, starting_places(scene, 0));
  CHECK_THROWS(Error, starting_places(scene, 900));
}
