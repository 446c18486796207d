// SPDX-License-Identifier: MIT
// Two rooms joined by a doorway that a body fits through, and that nodes of a flight lattice meet
// or miss by where it happens to be.
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/planning/coverage_tour.hpp>
#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/viewpoint/frontier_view.hpp>

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include "check.hpp"
#include "paint_states.hpp"
#include "still_mission.hpp"

namespace {
using namespace surfleet;

constexpr double kDoorVoxel = 0.15;
const FreeSpaceOptions kDoorBody{.radius = 0.35,
                                 .bounds = Box3(Point3(-3.0, -3.0, 0.0), Point3(3.0, 3.3, 2.4)),
                                 .margin = kDoorVoxel};
const Point3 kStart(1.5, -1.8, 1.2);

/// A wall of two voxels on y = 0, and in it a doorway of eight voxels from `door` on, or none. The
/// wall's farther half is known in part alone, which is incomplete from the farther room.
TsdfMap two_rooms(int door, bool closed = false) {
  TsdfMap map({.voxel_size = kDoorVoxel});
  map_test::paint(map, {-21, -21, -1}, {20, 22, 16}, [&](const VoxelIndex& v) {
    const bool in_wall = v.y() == 0 || v.y() == 1;
    if ((v.array() == Eigen::Array3i(-21, -21, -1)).any() ||
        (v.array() == Eigen::Array3i(20, 22, 16)).any())
      return VoxelState::occupied;
    if (!in_wall || (!closed && v.x() >= door && v.x() < door + 8)) return VoxelState::empty;
    return v.y() == 1 && v.z() % 2 == 0 ? VoxelState::unknown : VoxelState::occupied;
  });
  return map;
}
PinholeCamera camera() { return PinholeCamera::from_fov(1.5, 1.0, 160, 120, 0.4, 5.0); }
bool is_beyond(const Point3& p) { return p.y() > 2 * kDoorVoxel; }
bool leads_beyond(FlightLattice<FreeSpace>& lattice) {
  bool met = false;
  lattice.search(kStart, [&](const auto& site) { return !(met = is_beyond(site.position)); });
  return met;
}

TEST(what_can_be_seen_beyond_a_doorway_alone_is_seen_wherever_that_is) {
  int missed = 0;  // by the lattice alone
  for (int door = -16; door <= 2; ++door) {
    StillMission still(two_rooms(door), kDoorBody, camera(),
                       Box3(Point3(-3.0, 2 * kDoorVoxel, 0.3), Point3(3.0, 0.5, 2.1)));
    CHECK(!still.work.empty() && still.roadmap.reachable(kStart, {0.0, 1.8, 1.2}));
    FlightLattice<FreeSpace> lattice(still.free, still.free.options().bounds, 0.75);
    missed += leads_beyond(lattice) ? 0 : 1;

    const std::vector<Teammate> robots{{{kStart, 0.0}, true, {}}};
    const SurfaceSituation situation = still.situation(robots);
    const Plan plan = RollingTours()(situation);
    CHECK(!plan.nothing() && plan.impossible.empty());
    bool beyond = false;
    for (const Stop& stop : plan.routes.at(0)) {
      beyond = beyond || is_beyond(stop.configuration.position);
      CHECK(still.roadmap.reachable(kStart, stop.configuration.position));
    }
    CHECK(beyond);

    // So it is with views of space.
    FrontierViews views;
    const VoxelIndex corner = SpaceCells(still.states).at({0.15, 0.35, 1.2});
    FrontierViews::Search search(views, lattice, still.roadmap, {{key_of(corner)}}, still.states,
                                 situation.space().headings, 4.0);
    const auto view = search.best(
        kStart, {}, [](const auto& site) { return is_beyond(site.position) ? 1.0 : 1e6; });
    CHECK(view && is_beyond(view->configuration.position));
  }
  CHECK(missed > 3);
}

TEST(hope_leads_wherever_what_is_known_does) {
  // A robot in the doorway, as near to its sides as it may be.
  FreeSpaceOptions body = kDoorBody;
  body.margin = 0.2;
  body.unknown_margin = kDoorVoxel;
  const TsdfMap map = two_rooms(-4);
  const VoxelStateMap states(map);
  const FreeSpace space(states, body);
  FlightLattice<FreeSpace> lattice(space, body.bounds, 0.75);
  OptimisticLattice hope;
  hope.follow(space, 0.75);
  int starts = 0;
  for (double x = -0.6; x < 0.6; x += 0.04)
    for (double y = -0.6; y < 0.9; y += 0.1) {
      const Point3 start(x, y, 1.3);
      if (!space.is_free(start)) continue;
      ++starts;
      std::set<std::size_t> known, hoped;
      lattice.search(start, [&](const auto& site) {
        known.insert(lattice.index(site.cell));
        return true;
      });
      hope.search(start, lattice, [&](const auto& site, bool) {
        hoped.insert(lattice.index(site.cell));
        return true;
      });
      CHECK(!known.empty());
      CHECK(std::includes(hoped.begin(), hoped.end(), known.begin(), known.end()));
    }
  CHECK(starts > 50);
}

TEST(nothing_is_hoped_for_behind_a_closed_door) {
  StillMission still(two_rooms(0, true), kDoorBody, camera(),
                     Box3(Point3(-3.0, 2 * kDoorVoxel, 0.3), Point3(3.0, 0.5, 2.1)));
  const std::vector<Teammate> robots{{{kStart, 0.0}, true, {}}};
  const Plan plan = RollingTours()(still.situation(robots));
  CHECK(plan.nothing() && !still.work.empty() && plan.impossible.size() == still.work.size());
  for (const auto& [voxel, reason] : plan.impossible) CHECK(reason == LeftReason::no_free_pose);
}

TEST(tours_of_known_surface_lead_through_doorways_that_a_lattice_misses) {
  // The farther room's back wall, which shows through the doorway in part.
  const Bvh walls(make_box({-10.0, 3.3, -10.0}, {10.0, 3.5, 10.0}));
  std::vector<Point3> points;
  for (double x = -2.8; x < 2.9; x += 0.2) points.emplace_back(x, 3.29, 1.2);
  const std::vector<Eigen::Vector3d> normals(points.size(), -Eigen::Vector3d::UnitY());
  const std::vector<double> areas(points.size(), 1.0);
  int missed = 0;
  for (int door = -16; door <= 2; ++door) {
    StillMission still(two_rooms(door), kDoorBody, camera(), kDoorBody.bounds);
    FlightLattice<FreeSpace> lattice(still.free, still.free.options().bounds, 0.75);
    missed += leads_beyond(lattice) ? 0 : 1;
    const CoverageTour tour =
        plan_coverage_tour({points, normals, areas}, walls, still.free, still.roadmap, camera(),
                           {kStart, 0.0}, {.coverage = 1.0, .spacing = 0.75, .max_range = 2.5});
    CHECK_NEAR(tour.reachable_area, static_cast<double>(points.size()), 1e-9);
    CHECK(!tour.viewpoints.empty() && is_beyond(tour.viewpoints.back().position));
  }
  CHECK(missed > 3);
}
}  // namespace
