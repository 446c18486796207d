// SPDX-License-Identifier: MIT
#include <surfleet/simulation/scene.hpp>

#include <cmath>
#include <limits>
#include <string>

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

TEST(robots_stay_above_the_foot_of_a_structure_outdoors_unless_told_otherwise) {
  const double inf = std::numeric_limits<double>::infinity();
  const TriangleMesh box = make_box({0, 0, 0}, {4, 4, 4});
  const Scene usual = scene_from_mesh(box);
  CHECK(usual.bounds.min().z() == 1.0 && usual.bounds.max().z() == 12.0);
  const Scene free = scene_from_mesh(box, {.floor = -inf});
  CHECK(free.bounds.min().z() == -8.0);
  // It limits flight and nothing else.
  CHECK(usual.region.min() == free.region.min() && usual.region.max() == free.region.max());
  CHECK(usual.station.position == free.station.position);
  CHECK(usual.mesh.triangles == free.mesh.triangles);
  CHECK(scene_from_mesh(box, {.floor = 1.5}).bounds.min().z() == 2.5);
  CHECK(scene_from_mesh(box, {.floor = -50.0}).bounds.min().z() == -8.0);
  // Told otherwise: by bounds, by a ground, by a start below the base or just above it.
  const Box3 bounds(Point3(-9, -9, -5), Point3(9, 9, 9));
  CHECK(scene_from_mesh(box, {.bounds = bounds}).bounds.min().z() == -5.0);
  CHECK(scene_from_mesh(box, {.bounds = bounds, .floor = 0.0}).bounds.min().z() == 1.0);
  CHECK(scene_from_mesh(box, {.ground = -2.0}).bounds.min().z() == -2.0);
  CHECK(scene_from_mesh(box, {.start = Point3(2, -4, -3)}).bounds.min().z() == -8.0);
  CHECK(scene_from_mesh(box, {.start = Point3(2, -4, 0.5)}).bounds.min().z() == 0.5);
  // A room keeps its robots in by itself.
  TriangleMesh room = make_box({0, 0, 0}, {9, 7, 4});
  for (Triangle& t : room.triangles) std::swap(t[0], t[1]);
  CHECK(scene_from_mesh(room).bounds.min().z() == -8.0);
  CHECK_THROWS(Error, scene_from_mesh(box, {.floor = 11.5}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.start = Point3(2, -4, 2), .floor = 1.5}));
  CHECK_THROWS(Error, scene_from_mesh(box, {.floor = std::nan("")}));
}

TEST(starts_have_the_clearance_that_is_asked_for_or_are_refused_with_what_would_do) {
  // A corridor between two blocks, and a yard before it.
  TriangleMesh mesh = make_box({-9, 0, 0}, {-2, 20, 8});
  append(mesh, make_box({2, 0, 0}, {9, 20, 8}));
  SceneOptions o{.start = Point3(0, 10, 4)};
  const Scene corridor = scene_from_mesh(mesh, o);
  const SceneSpace space(corridor.mesh);
  const auto why = [](const Scene& scene, int robots, double clearance) -> std::string {
    try {
      for (const Configuration& q : starting_places(scene, robots, {.clearance = clearance}))
        CHECK(Bvh(scene.structure()).distance(q.position) >= clearance);
    } catch (const Error& e) {
      return e.what();
    }
    return {};
  };
  CHECK(why(corridor, 3, 2.0).empty());
  CHECK(why(corridor, 1, 2.75).find("has 2.00 m around it; expected at most 2.00 ") !=
        std::string::npos);
  // Some have it and some have not: what is said to do does, and a little more does not.
  o.start = Point3(0, -3.4, 4);
  o.bounds = Box3(Point3(-4, -4, 1), Point3(4, 20, 8));
  const Scene yard = scene_from_mesh(mesh, o);
  const std::string said = why(yard, 5, 3.3);
  const std::size_t at = said.find("expected at most ");
  CHECK(at != std::string::npos);
  if (at != std::string::npos) {
    const double most = std::stod(said.substr(at + 17));
    CHECK(most > 1.3 && most < 3.3);
    CHECK(why(yard, 3, 3.3).empty() && why(yard, 5, most).empty() &&
          !why(yard, 5, most + 0.02).empty());
  }
  // Without a start, a place that has it is sought; where there is none, the best is taken.
  for (const double wanted : {0.0, 3.0, 4.5, 6.0}) {
    const Scene found = scene_from_mesh(mesh, {.start_clearance = wanted});
    CHECK(Bvh(mesh).distance(found.station.position) >= wanted);
    CHECK(wanted > 3.0 || found.station.position == scene_from_mesh(mesh).station.position);
  }
  const Scene none = scene_from_mesh(mesh, {.start_clearance = 50.0});
  CHECK(Bvh(mesh).distance(none.station.position) > 6.0 && !why(none, 1, 50.0).empty());
  // The ground is no structure, be it as near as it will.
  const Scene grounded = scene_from_mesh(mesh, {.ground = 0.0, .start_clearance = 4.5});
  CHECK(why(grounded, 1, 4.5).empty() && grounded.station.position.z() < 4.5);
  // Of a mesh that has a ground of its own, it is.
  TriangleMesh whole = mesh;
  append(whole, make_box({-30, -30, -1}, {30, 40, 0}));
  const Scene own = scene_from_mesh(whole, {.start_clearance = 3.75});
  CHECK(why(own, 3, 3.75).empty());
}

TEST(nobody_starts_in_a_closed_box) {
  const TriangleMesh box = make_box({0, 0, 0}, {4, 4, 4});
  const Scene open = scene_from_mesh(box);
  const Point3 s = open.station.position;
  SceneOptions o;
  o.keep_out = {{Box3(s - Point3::Constant(0.5), s + Point3::Constant(0.5))}};
  const Scene closed = scene_from_mesh(box, o);
  CHECK(o.keep_out.distance(closed.station.position) >= 1.0);
  o.start = s;
  CHECK_THROWS(Error, scene_from_mesh(box, o));
  o.start.reset();
  o.keep_out = {{Box3(s + Point3(1.5, -9, -9), s + Point3(40, 9, 9))}};
  for (const Configuration& q : starting_places(scene_from_mesh(box, o), 5))
    CHECK(o.keep_out.distance(q.position) >= 1.0);
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
