// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/observable_surface.hpp>

#include <surfleet/evaluation/surface_sampling.hpp>

#include "check.hpp"
#include "test_shapes.hpp"

using namespace surfleet;

namespace {
ObservabilityOptions wide_camera(double near = 0.2, double far = 30.0) {
  ObservabilityOptions o;
  o.camera = PinholeCamera::from_fov(radians(90), radians(120), 100, 100, near, far);
  o.max_incidence = radians(85);
  return o;
}
/// Share of the visible among the samples that `which` accepts.
template <typename Which>
double share(const PointCloud& samples, const ObservableSurface& seen, Which&& which) {
  double n = 0, v = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (which(samples.points[i])) {
      n += 1;
      v += seen.seen_from[i] != 0 ? 1 : 0;
    }
  return n > 0 ? v / n : -1.0;
}
}  // namespace

TEST(a_box_in_a_closed_room) {
  // A room of 10 x 10 x 6 m with a block on its floor; the block's underside is never seen, and
  // nothing of the outside of the room is, though it is the same triangles.
  TriangleMesh scene = test_shapes::box({-5, -5, 0}, {5, 5, 6}, true);
  append(scene, test_shapes::box({-1, -1, 0}, {1, 1, 2}));
  const Bvh bvh(scene);
  const ReachableLattice lattice(
      bvh,
      {.bounds = Box3(Point3(-9, -9, -3), Point3(9, 9, 9)), .start = {3, 3, 3}, .radius = 0.5});
  for (const Point3& p : lattice.positions()) {
    CHECK(p.cwiseAbs().head<2>().maxCoeff() <= 4.5 + 1e-9 && p.z() >= 0.5 - 1e-9 &&
          p.z() <= 5.5 + 1e-9);
    CHECK(bvh.distance(p) >= 0.5 - 1e-6);
  }
  const auto samples = sample_surface(scene, {.density = 10}).cloud;
  const auto seen = observable_surface(samples, bvh, lattice, wide_camera());
  const auto under = [](const Point3& p) {
    return p.z() < 1e-9 && p.head<2>().cwiseAbs().maxCoeff() < 0.98;
  };
  CHECK(share(samples, seen, under) == 0.0);
  CHECK_NEAR(share(samples, seen, [&](const Point3& p) { return !under(p); }), 1.0, 0.01);
  // Every witness really sees its point.
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if ((seen.seen_from[i] & ObservableSurface::kFront) == 0) continue;
    const Point3& viewer = seen.viewers[i][0];
    const Eigen::Vector3d ray = samples.points[i] - viewer;
    CHECK(!bvh.cast(viewer, ray.normalized(), ray.norm() - 0.01).has_value());
  }
}

TEST(the_inside_of_a_solid_is_no_side_to_be_seen_from) {
  TriangleMesh scene = test_shapes::box({-5, -5, 0}, {5, 5, 6}, true);
  append(scene, test_shapes::box({-1, -1, 0}, {1, 1, 2}));
  const Bvh bvh(scene);
  const ReachableLattice lattice(
      bvh, {.bounds = Box3(Point3(-9, -9, -3), Point3(9, 9, 9)), .start = {3, 3, 3}});
  const auto samples = sample_surface(scene, {.density = 20}).cloud;
  const auto seen = observable_surface(samples, bvh, lattice, wide_camera());
  for (const std::uint8_t sides : seen.seen_from) CHECK((sides & ObservableSurface::kBack) == 0);
}

TEST(rooms_without_a_door_are_not_entered) {
  TriangleMesh scene = test_shapes::box({-2, -2, -2}, {2, 2, 2}, true);
  append(scene, test_shapes::box({4, -2, -2}, {8, 2, 2}, true));
  const Bvh bvh(scene);
  const FlightSpace space{.bounds = Box3(Point3(-3, -3, -3), Point3(9, 3, 3)),
                          .start = {0, 0, 0},
                          .radius = 0.4,
                          .spacing = 0.4};
  const ReachableLattice lattice(bvh, space);
  CHECK(lattice.count() > 100);
  for (const Point3& p : lattice.positions()) CHECK(p.x() < 2.0);
  const auto samples = sample_surface(scene, {.density = 4}).cloud;
  const auto seen = observable_surface(samples, bvh, lattice, wide_camera());
  CHECK(share(samples, seen, [](const Point3& p) { return p.x() > 3.0; }) == 0.0);
  CHECK(share(samples, seen, [](const Point3& p) { return p.x() < 3.0; }) > 0.97);
}

TEST(a_thin_wall_stops_the_body_but_a_wide_gap_lets_it_pass) {
  // A wall at x = 0 across the whole space with a gap of `gap` metres.
  for (const double gap : {0.7, 1.7}) {
    TriangleMesh wall;
    const double g = 0.5 * gap;
    append(wall, test_shapes::box({-0.001, -10, -10}, {0.001, -g, 10}));
    append(wall, test_shapes::box({-0.001, g, -10}, {0.001, 10, 10}));
    const ReachableLattice lattice(Bvh(wall), {.bounds = Box3(Point3(-3, -3, -1), Point3(3, 3, 1)),
                                               .start = {-2, 0, 0},
                                               .radius = 0.5,
                                               .spacing = 0.9});
    bool beyond = false;
    for (const Point3& p : lattice.positions()) beyond = beyond || p.x() > 0.5;
    CHECK(beyond == (gap > 1.0));
  }
}

TEST(a_closed_box_stops_the_body_but_no_view) {
  TriangleMesh scene = test_shapes::box({-5, -2, 0}, {5, 2, 4}, true);
  const Bvh bvh(scene);
  FlightSpace space{.bounds = Box3(Point3(-5, -2, 0), Point3(5, 2, 4)),
                    .start = {-3, 0, 2},
                    .radius = 0.5,
                    .spacing = 0.25};
  space.keep_out = {{Box3(Point3(0, -9, -9), Point3(1, 9, 9))}};
  const ReachableLattice lattice(bvh, space);
  CHECK(lattice.count() > 100);
  for (const Point3& p : lattice.positions()) CHECK(p.x() <= -0.5 + 1e-9);
  // The far wall is still in sight.
  const auto samples = sample_surface(scene, {.density = 10}).cloud;
  const auto seen = observable_surface(samples, bvh, lattice, wide_camera());
  CHECK_NEAR(share(samples, seen, [](const Point3& p) { return p.x() > 4.99; }), 1.0, 0.01);
  space.keep_out.boxes[0] = Box3(Point3(-2.6, -9, -9), Point3(1, 9, 9));
  CHECK_THROWS(Error, ReachableLattice(bvh, space));
}

TEST(range_field_of_view_and_incidence_limit_what_is_seen) {
  // A floor seen from a layer of positions at z = 4 by a level camera.
  const TriangleMesh floor = test_shapes::plane(20.0, 4, 0.0);
  const Bvh bvh(floor);
  const ReachableLattice lattice(
      bvh, {.bounds = Box3(Point3(-3, -3, 4), Point3(3, 3, 4)), .start = {0, 0, 4}, .radius = 1.0});
  const auto samples = sample_surface(floor, {.density = 5}).cloud;
  const auto seen_by = [&](double vertical_fov, double range, double pitch, double incidence) {
    ObservabilityOptions o;
    o.camera = PinholeCamera::from_fov(radians(90), vertical_fov, 200, 200, 0.5, range);
    o.T_body_camera = forward_camera_mount(pitch);
    o.max_incidence = incidence;
    return observable_surface(samples, bvh, lattice, o).visible_count;
  };
  // Level with ±30°: the floor comes into view 4 / tan 30° = 6.9 m away; nothing within 6 m.
  CHECK(seen_by(radians(60), 6.0, 0.0, radians(85)) == 0);
  CHECK(seen_by(radians(60), 9.0, 0.0, radians(85)) > 0);
  CHECK(seen_by(radians(60), 6.0, radians(45), radians(85)) > samples.size() / 10);
  // At such an angle the ray meets the floor 60° from its normal or more.
  CHECK(seen_by(radians(60), 9.0, 0.0, radians(55)) == 0);
  // Straight down.
  CHECK(seen_by(radians(60), 6.0, radians(90), radians(85)) > samples.size() / 8);
}

TEST(a_lidar_sees_all_around_between_its_lowest_and_highest_beam) {
  const TriangleMesh floor = test_shapes::plane(20.0, 4, 0.0);
  const Bvh bvh(floor);
  const ReachableLattice lattice(
      bvh, {.bounds = Box3(Point3(-1, -1, 4), Point3(1, 1, 4)), .start = {0, 0, 4}, .radius = 1.0});
  const auto samples = sample_surface(floor, {.density = 5}).cloud;
  ObservabilityOptions o;
  o.T_body_camera = forward_camera_mount(0.0, Point3(0.0, 0.0, 0.5));
  o.lidar = LidarModel{.lowest = radians(-50.0), .highest = radians(20.0), .max_range = 7.0};
  o.max_incidence = radians(85);
  o.stride = 1;
  const auto seen = observable_surface(samples, bvh, lattice, o);
  const std::vector<Point3> places = lattice.positions();
  std::size_t visible = 0, wrong = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    // From 4.5 m above, by brute force: no farther than 7 m, no steeper than 50 degrees.
    bool sees = false;
    for (const Point3& p : places) {
      const double level = (samples.points[i] - p).head<2>().norm();
      sees = sees || (std::hypot(level, 4.5) <= 7.0 && std::atan2(4.5, level) <= radians(50.0));
    }
    visible += sees ? 1 : 0;
    wrong += sees != (seen.seen_from[i] != 0) ? 1 : 0;
  }
  CHECK(wrong == 0 && visible > 100 && visible < samples.size() / 2);
}

TEST(one_sided_surfaces_show_their_front) {
  const TriangleMesh floor = test_shapes::plane(6.0, 2, 0.0);
  const Bvh bvh(floor);
  const ReachableLattice below(
      bvh, {.bounds = Box3(Point3(-4, -4, -4), Point3(4, 4, -2)), .start = {0, 0, -3}});
  const auto samples = sample_surface(floor, {.density = 5}).cloud;
  ObservabilityOptions o = wide_camera();
  CHECK(observable_surface(samples, bvh, below, o).fraction() > 0.95);
  o.two_sided = false;
  CHECK(observable_surface(samples, bvh, below, o).visible_count == 0);
}

TEST(a_sheet_is_seen_from_two_sides_and_a_wall_from_one_each) {
  const FlightSpace around{.bounds = Box3(Point3(-5, -5, -4), Point3(5, 5, 4)), .start = {4, 4, 3}};
  // A sheet without thickness, its back turned to half of the space.
  const TriangleMesh sheet = test_shapes::plane(6.0, 2, 0.0);
  const Bvh sheet_bvh(sheet);
  const auto samples = sample_surface(sheet, {.density = 10}).cloud;
  const ReachableLattice lattice(sheet_bvh, around);
  const auto seen = observable_surface(samples, sheet_bvh, lattice, wide_camera());
  const PointCloud oriented = oriented_samples(samples, seen);
  CHECK(seen.fraction() == 1.0);
  CHECK(oriented.size() == 2 * samples.size());
  for (std::size_t i = 0; i < oriented.size(); ++i)
    CHECK(oriented.normals[i].z() == (i < samples.size() ? 1.0F : -1.0F));
  for (std::size_t i = 0; i < samples.size(); ++i)
    CHECK(seen.viewers[i][0].z() > 0.0 && seen.viewers[i][1].z() < 0.0);
  // From above alone it has one side, whichever way its triangles are wound.
  FlightSpace above = around;
  above.bounds.min().z() = 1.5;
  TriangleMesh turned = sheet;
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  for (const TriangleMesh& mesh : {sheet, turned}) {
    const Bvh bvh(mesh);
    const auto front = sample_surface(mesh, {.density = 10}).cloud;
    const PointCloud up = oriented_samples(
        front, observable_surface(front, bvh, ReachableLattice(bvh, above), wide_camera()));
    CHECK(up.size() == front.size());
    for (const Eigen::Vector3f& n : up.normals) CHECK(n.z() == 1.0F);
  }
  // A wall of 2 cm, closed: each face has its outer side alone.
  const TriangleMesh wall = test_shapes::box({-3, -3, -0.01}, {3, 3, 0.01});
  const Bvh wall_bvh(wall);
  const auto faces = sample_surface(wall, {.density = 10}).cloud;
  const auto outside =
      observable_surface(faces, wall_bvh, ReachableLattice(wall_bvh, around), wide_camera());
  for (const std::uint8_t sides : outside.seen_from) CHECK(sides <= ObservableSurface::kFront);
  CHECK(outside.fraction() > 0.99);
  CHECK_THROWS(Error, oriented_samples(faces, seen));
}

TEST(threads_change_nothing_and_bad_input_is_refused) {
  const TriangleMesh block = test_shapes::box({-1, -1, 0}, {1, 1, 2});
  const Bvh bvh(block);
  const FlightSpace space{.bounds = Box3(Point3(-6, -6, 1), Point3(6, 6, 6)), .start = {4, 4, 4}};
  const ReachableLattice lattice(bvh, space);
  const auto samples = sample_surface(block, {.density = 40}).cloud;
  ObservabilityOptions o = wide_camera();
  const auto one = observable_surface(samples, bvh, lattice, o);
  o.threads = 2;
  const auto two = observable_surface(samples, bvh, lattice, o);
  CHECK(one.seen_from == two.seen_from && one.viewers == two.viewers);
  CHECK(observable_surface({}, bvh, lattice, o).fraction() == 0.0);
  FlightSpace bad = space;
  bad.start = {0.5, 0, 1.0};
  CHECK_THROWS(Error, ReachableLattice(bvh, bad));
  bad = space;
  bad.spacing = 1e-4;
  CHECK_THROWS(Error, ReachableLattice(bvh, bad));
  bad = space;
  bad.bounds = Box3();
  CHECK_THROWS(Error, ReachableLattice(bvh, bad));
  PointCloud bare;
  bare.points = {Point3::Zero()};
  CHECK_THROWS(Error, observable_surface(bare, bvh, lattice, o));
}
