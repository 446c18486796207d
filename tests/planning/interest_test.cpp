// SPDX-License-Identifier: MIT
#include <surfleet/planning/interest.hpp>
//
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include <surfleet/planning/rolling_tours.hpp>

#include "check.hpp"
#include "paint_states.hpp"
#include "still_mission.hpp"

namespace interest_test {
using namespace surfleet;

const FreeSpaceOptions kBody{
    .radius = 0.2, .bounds = Box3(Point3(-2, -2, -0.5), Point3(2, 2, 2)), .margin = 0.1};

PinholeCamera camera(double range) {
  return PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, range);
}
/// A floor of which a third is unknown, in voxels of 0.1 m.
TsdfMap floor_map() {
  TsdfMap map({.voxel_size = 0.1});
  map_test::paint(map, {-24, -24, -8}, {23, 23, 23}, [](const VoxelIndex& v) {
    return v.x() > 7 ? VoxelState::unknown : v.z() == -7 ? VoxelState::occupied : VoxelState::empty;
  });
  return map;
}
int down(int a, int b) { return static_cast<int>(std::floor(static_cast<double>(a) / b)); }

TEST(every_element_is_of_one_target_of_its_cell) {
  InterestOptions options;
  options.frontier_gain = options.prediction_gain = 0.0;
  const std::vector<Teammate> team{{{Point3(0, 0, 0.5), 0.0}, true, {}}};
  std::size_t fine_targets = 0;
  for (const auto& [range, finely, cell] :
       {std::tuple(8.0, true, 2), {8.0, false, 6}, {5.1, false, 4}, {2.0, false, 2}}) {
    StillMission still(floor_map(), kBody, camera(range),
                       Box3(Point3(-2.4, -2.4, -1.0), Point3(2.4, 2.4, 2.4)));
    const SurfaceSituation s = still.situation(team);
    Interest interest(options);
    const std::vector<SightTarget> targets = interest(s, finely);
    CHECK(interest.is_fine() == (cell == 2) && s.goals.size() > 40);
    std::multiset<std::int32_t> members;
    for (std::size_t t = 0; t < targets.size(); ++t) {
      const auto of = interest.goals(t);
      if (of.empty()) continue;  // predicted
      CHECK_NEAR(targets[t].gain, options.element_faces * 0.01 * static_cast<double>(of.size()),
                 1e-12);
      const IncompleteElement& first = s.goals[static_cast<std::size_t>(of[0])];
      for (const std::int32_t i : of) {
        members.insert(i);
        const IncompleteElement& e = s.goals[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3; ++k) CHECK(down(e.voxel[k], cell) == down(first.voxel[k], cell));
        CHECK(e.direction.dot(first.direction) > 0.0);
      }
    }
    CHECK(members.size() == s.goals.size());
    for (const std::int32_t i : members) CHECK(members.count(i) == 1);
    const auto count = static_cast<std::size_t>(std::count_if(
        targets.begin(), targets.end(), [](const SightTarget& t) { return t.gain > 0.0; }));
    if (finely) fine_targets = count;
    if (cell == 6) CHECK(2 * count < fine_targets);
    if (cell == 2) CHECK(count == fine_targets);
  }
}

TEST(surface_is_predicted_in_cells_and_covers_as_much) {
  const std::vector<Teammate> team{{{Point3(0, 0, 0.5), 0.0}, true, {}}};
  double fine_area = 0.0;
  std::size_t fine_count = 0;
  for (const double share : {0.02, 0.08}) {
    InterestOptions options{.cell_share = share, .frontier_gain = 0.0};
    StillMission still(floor_map(), kBody, camera(8.0),
                       Box3(Point3(-2.4, -2.4, -1.0), Point3(2.4, 2.4, 2.4)));
    Interest interest(options);
    const auto targets = interest(still.situation(team));
    double area = 0.0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < targets.size(); ++t)
      if (interest.goals(t).empty()) {
        area += targets[t].gain;
        ++count;
      }
    if (share == 0.02) {
      fine_area = area;
      fine_count = count;
    }
    CHECK(area > 1.0 && std::abs(area - fine_area) < 0.35 * fine_area);
    if (share == 0.08) CHECK(5 * count < fine_count);
  }
}

TEST(what_shows_beside_the_element_that_stands_for_a_cell_is_viewed_at_last) {
  // In a cell of six voxels: an element in a closed hollow, and one in the open that faces alike.
  const VoxelIndex hidden(7, 7, 7), shown(10, 10, 8);
  TsdfMap map({.voxel_size = 0.1});
  map_test::paint(map, {-24, -24, -8}, {23, 23, 23}, [&](const VoxelIndex& v) {
    if (v == hidden) return VoxelState::empty;
    if (v == VoxelIndex(7, 7, 8) || v == VoxelIndex(11, 10, 8)) return VoxelState::unknown;
    const bool shell = (v.array() >= 6).all() && v.x() <= 8 && v.y() <= 8 && v.z() <= 9;
    return shell || v == VoxelIndex(10, 10, 7) ? VoxelState::occupied : VoxelState::empty;
  });
  StillMission still(std::move(map), kBody, camera(7.6),
                     Box3(Point3(0.5, 0.5, 0.5), Point3(1.1, 1.1, 1.2)));
  CHECK(still.work.size() == 2 && still.work[0].voxel == hidden && still.work[1].voxel == shown);
  RollingToursOptions options;
  options.interest.frontier_gain = options.interest.prediction_gain = 0.0;
  const std::vector<Teammate> team{{{Point3(-1, -1, 1), 0.0}, true, {}}};
  const SurfaceSituation s = still.situation(team);
  CHECK(Interest(options.interest)(s)[0].gain > 0.05);  // both are one target
  const Stops route = RollingTours(options)(s).routes.at(0);
  CHECK(route.size() == 1);
  for (const Stop& stop : route) CHECK(stop.targets == std::vector<VoxelIndex>{shown});
}
}  // namespace interest_test
