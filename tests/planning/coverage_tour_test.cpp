// SPDX-License-Identifier: MIT
#include <surfleet/planning/coverage_tour.hpp>

#include <algorithm>
#include <utility>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

namespace {
using namespace surfleet;

/// The box world, known: a map whose voxels within the box are occupied.
struct Known {
  box_world::World world;
  TsdfMap map{{.voxel_size = 0.2}};
  std::vector<Point3> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<double> areas;
  Known() {
    const MissionOptions o = box_world::options(world);
    const VoxelIndex low = map.index_of(o.kind.bounds.min()),
                     high = map.index_of(o.kind.bounds.max());
    for_each_index(low, high, [&](const VoxelIndex& v) {
      const bool inside = box_world::box().contains(map.center(v));
      map.ensure(v) = {inside ? -0.2F : 0.2F, 1.0F};
    });
    for (std::uint32_t s = 0; s < map.block_count(); ++s) map.mark_changed(s);
    for (std::size_t t = 0; t < world.mesh.triangles.size(); ++t) {
      const double area = world.mesh.area(t);
      for (double u = 1.0 / 6; u < 1.0; u += 1.0 / 3)
        for (double v = 1.0 / 6; u + v < 1.0; v += 1.0 / 3) {
          points.push_back(world.mesh.corner(t, 0) * (1.0 - u - v) + world.mesh.corner(t, 1) * u +
                           world.mesh.corner(t, 2) * v);
          normals.push_back(world.mesh.area_vector(t).normalized());
          areas.push_back(area / 6.0);
        }
    }
  }
};

TEST(tour_of_a_box_sees_what_it_promises_and_is_free) {
  const Known known;
  const VoxelStateMap states(known.map);
  const MissionOptions o = box_world::options(known.world);
  const FreeSpace space(states, {.radius = o.kind.body_radius, .bounds = o.kind.bounds});
  LazyPrmStar roadmap(space, {.spacing = 1.0});
  const Configuration start = box_world::starts(1).front();
  double last = 0.0, reachable = 0.0;
  for (const auto& [share, pitches] : {std::pair<double, std::vector<double>>{0.5, {0.0}},
                                       {0.9, {0.0}},
                                       {1.0, {0.0}},
                                       {1.0, {0.0, 1.0, -1.0}}}) {
    const bool gimbal = pitches.size() > 1;
    const CoverageTour tour = plan_coverage_tour(
        {known.points, known.normals, known.areas}, known.world.bvh, space, roadmap, o.kind.camera,
        start, {.coverage = share, .spacing = 1.0}, forward_camera_mount(), pitches);
    if (!gimbal) reachable = tour.reachable_area;
    // A gimbal takes no view away, and spares flights to where a level camera sees top and bottom.
    CHECK(tour.reachable_area >= reachable && (!gimbal || tour.length < last));
    CHECK(std::any_of(tour.viewpoints.begin(), tour.viewpoints.end(),
                      [](const Configuration& q) { return q.pitch != 0.0; }) == gimbal);
    for (const Configuration& q : tour.images)
      CHECK(std::find(pitches.begin(), pitches.end(), q.pitch) != pitches.end());
    CHECK(tour.coverage() >= share - 0.01);
    CHECK(tour.reachable_area > 0.8 * known.world.mesh.area());
    CHECK_NEAR(tour.length, polyline_length(tour.path), 1e-9);
    CHECK((tour.path.front() - start.position).norm() == 0.0);
    for (std::size_t k = 1; k < tour.path.size(); ++k)
      CHECK(space.is_free_segment(tour.path[k - 1], tour.path[k]));
    if (!gimbal) CHECK(tour.length >= last - 1.0);
    last = tour.length;
    // Flown, it comes by every viewpoint with its heading, in order, as fast as it may.
    const TourFlightOptions flight{
        .speed = 0.7, .yaw_rate = 0.9, .pitch_rate = 0.4, .image_period = 0.3, .hold = 0.5};
    const auto images = fly_tour(tour, start, flight);
    CHECK(images.front().first == 0.0 && images.front().second.position == start.position);
    std::size_t next = 0;
    double flown = 0.0, held = 0.0;
    for (std::size_t k = 0; k < images.size(); ++k) {
      const Configuration& q = images[k].second;
      if (next < tour.viewpoints.size() && q.position == tour.viewpoints[next].position &&
          std::abs(wrap_angle(q.yaw - tour.viewpoints[next].yaw)) < 1e-9 &&
          std::abs(q.pitch - tour.viewpoints[next].pitch) < 1e-9)
        ++next;
      if (k == 0) continue;
      const Configuration& before = images[k - 1].second;
      const double step = (q.position - before.position).norm();
      flown += step;
      CHECK(step <= 0.21 + 1e-9);
      CHECK(std::abs(wrap_angle(q.yaw - before.yaw)) <= 0.27 + 1e-9);
      CHECK(std::abs(q.pitch - before.pitch) <= 0.12 + 1e-9);
      const double dt = images[k].first - images[k - 1].first;
      CHECK(dt > 0.0 && dt <= 0.3 + 1e-9);
      held = step == 0.0 && q.yaw == before.yaw && q.pitch == before.pitch ? held + dt : held;
      CHECK(space.is_free_segment(before.position, q.position));
    }
    CHECK(next == tour.viewpoints.size());
    CHECK_NEAR(flown, tour.length, 1e-6);
    CHECK(held >= 0.5 * static_cast<double>(tour.viewpoints.size()));
    CHECK_THROWS(Error, fly_tour(tour, start, {.speed = 0.0}));
    // The stops alone and the images en route account for what is claimed.
    CHECK(!tour.viewpoints.empty() && tour.viewpoints.size() < 20);
  }
  CHECK(last < 30.0);
}
TEST(refuses_bad_settings) {
  const Known known;
  const VoxelStateMap states(known.map);
  const MissionOptions o = box_world::options(known.world);
  const FreeSpace space(states, {.radius = o.kind.body_radius, .bounds = o.kind.bounds});
  LazyPrmStar roadmap(space);
  const auto plan = [&](const KnownSurface& s, const CoverageTourOptions& t) {
    return plan_coverage_tour(s, known.world.bvh, space, roadmap, o.kind.camera,
                              box_world::starts(1).front(), t);
  };
  const KnownSurface good{known.points, known.normals, known.areas};
  CHECK_THROWS(Error, plan(good, {.coverage = 0.0}));
  CHECK_THROWS(Error, plan(good, {.coverage = 1.5}));
  CHECK_THROWS(Error, plan(good, {.spacing = 0.0}));
  CHECK_THROWS(Error, plan({known.points, {}, known.areas}, {}));
  CHECK(plan({}, {}).viewpoints.empty());
}
}  // namespace
