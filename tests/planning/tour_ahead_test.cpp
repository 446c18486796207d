// SPDX-License-Identifier: MIT
#include <surfleet/planning/tour_ahead.hpp>
//
#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/planning/opening_look.hpp>
#include <surfleet/planning/rate_planner.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>

#include "check.hpp"
#include "paint_states.hpp"
#include "still_mission.hpp"

namespace {
using namespace surfleet;

/// Looks that show things of a worth each, by site and heading. Bounds are loose or exact.
struct ListedLooks {
  std::vector<std::array<std::vector<int>, kHeadings>> shows;
  std::vector<double> things;
  bool loose = false;
  int asked = 0;

  double look(std::size_t s, double enough, WorthByHeading& worth) {
    double most = 0.0;
    for (std::size_t k = 0; k < kHeadings; ++k) {
      worth[k] = 0.0;
      for (const int i : shows[s][k]) worth[k] += things[static_cast<std::size_t>(i)];
      most = std::max(most, worth[k]);
    }
    if (loose && most < enough) {
      worth.fill(1e9);  // not to be read
      return enough;
    }
    ++asked;
    return most;
  }
  void take(std::size_t s, int heading) {
    for (const int i : shows[s][static_cast<std::size_t>(heading)])
      things[static_cast<std::size_t>(i)] = 0.0;
  }
};
static_assert(LooksFromSites<ListedLooks> && !LooksFromSites<int>);

struct Scattered {
  std::vector<TourSite> sites;
  ListedLooks looks;
  Configuration from{Point3(5, 5, 5), 0.3};
};
Scattered scattered(std::uint64_t seed) {
  Random random(seed);
  Scattered all;
  for (int i = 0; i < 60; ++i) all.looks.things.push_back(random.uniform(0.1, 3.0));
  for (int s = 0; s < 40; ++s) {
    const Point3 p(random.uniform(0, 10), random.uniform(0, 10), random.uniform(0, 10));
    all.sites.push_back({p, (p - all.from.position).norm() * random.uniform(1.0, 1.4)});
    all.looks.shows.emplace_back();
    for (auto& things : all.looks.shows.back())
      for (int n = static_cast<int>(random.uniform(0.0, 6.0)); n > 0; --n)
        things.push_back(static_cast<int>(random.uniform(0.0, 59.9)));
    for (auto& things : all.looks.shows.back()) {
      std::sort(things.begin(), things.end());
      things.erase(std::unique(things.begin(), things.end()), things.end());
    }
  }
  return all;
}

TEST(the_first_stop_of_a_tour_ahead_is_the_one_that_pays_best) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scattered all = scattered(seed);
    double best = 0.0;
    for (std::size_t s = 0; s < all.sites.size(); ++s)
      for (int k = 0; k < kHeadings; ++k) {
        double worth = 0.0;
        for (const int i : all.looks.shows[s][static_cast<std::size_t>(k)])
          worth += all.looks.things[static_cast<std::size_t>(i)];
        const double turn = std::abs(wrap_angle(heading_angle(k) - all.from.yaw));
        best = std::max(best, worth / (all.sites[s].distance + 0.7 + 0.2 * turn));
      }
    const auto tour = tour_ahead(all.from, all.sites, all.looks,
                                 {.stops = 1, .stop_cost = 0.7, .turn_cost = 0.2});
    CHECK(tour.size() == 1);
    CHECK_NEAR(tour.at(0).rate, best, 1e-12);
  }
}

TEST(a_tour_ahead_shows_new_things_at_every_stop_however_loose_bounds_are) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scattered exact = scattered(seed), loose = scattered(seed);
    loose.looks.loose = true;
    const auto a = tour_ahead(exact.from, exact.sites, exact.looks, {.stops = 12});
    const auto b = tour_ahead(loose.from, loose.sites, loose.looks, {.stops = 12});
    CHECK(a.size() == 12 && b.size() == a.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      CHECK(a[k].site == b[k].site && a[k].heading == b[k].heading && a[k].rate == b[k].rate);
    CHECK(loose.looks.asked < exact.looks.asked);
    ListedLooks again = scattered(seed).looks;
    std::set<int> seen;
    for (const TourAheadStop& stop : a) {
      CHECK(stop.rate > 0.0);
      const auto& shown = again.shows[stop.site][static_cast<std::size_t>(stop.heading)];
      seen.insert(shown.begin(), shown.end());
    }
    double left = 0.0;
    for (std::size_t i = 0; i < again.things.size(); ++i)
      CHECK(exact.looks.things[i] == (seen.contains(static_cast<int>(i)) ? 0.0 : again.things[i]));
    for (const double w : exact.looks.things) left += w;
    // Told to go on, it stops when nothing is left to be seen from anywhere.
    CHECK(tour_ahead(exact.from, exact.sites, exact.looks, {.stops = 1000}).size() <= 48);
    CHECK(tour_ahead(exact.from, exact.sites, exact.looks, {.stops = 5}).empty());
    CHECK(left > 0.0);
  }
}

TEST(a_tour_ahead_takes_the_small_on_the_way_to_the_broad) {
  // The broad pays best and is far off; alone it would be flown to at once.
  Scattered all;
  all.from = {Point3::Zero(), 0.0};
  all.looks.things = {60.0, 2.0, 2.0, 2.0};
  for (const double x : {20.0, 12.0, 8.0, 4.0}) {
    all.sites.push_back({Point3(x, 0.1, 0), x});
    all.looks.shows.emplace_back();
    all.looks.shows.back()[0] = {static_cast<int>(all.sites.size()) - 1};
  }
  const auto alone = tour_ahead(all.from, all.sites, all.looks, {.stops = 1});
  CHECK(alone.at(0).site == 0);
  all.looks.things[0] = 60.0;
  const auto tour = tour_ahead(all.from, all.sites, all.looks, {.stops = 4});
  CHECK(tour.size() == 4 && tour[0].site == 3 && tour[1].site == 2 && tour[2].site == 1 &&
        tour[3].site == 0);
  std::vector<TourSite> none;
  CHECK(tour_ahead(all.from, none, all.looks).empty());
  CHECK(tour_ahead(all.from, all.sites, all.looks, {.stops = 0}).empty());
}

/// Empty below 2.4 m, where a body fits; all the rest unknown but for what `block` says is there.
template <typename Block>
void paint_hall(TsdfMap& map, Block&& block) {
  map_test::paint(map, {-24, -16, -8}, {23, 15, 39}, [&](const VoxelIndex& v) {
    return block(v) ? VoxelState::occupied : v.z() < 8 ? VoxelState::empty : VoxelState::unknown;
  });
}
const FreeSpaceOptions kBody{
    .radius = 0.4, .bounds = Box3(Point3(-6.0, -4.0, -1.2), Point3(6.0, 4.0, 10.0)), .margin = 0.3};

TEST(an_optimistic_lattice_leads_through_what_is_not_known_to_be_blocked) {
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex&) { return false; });
  VoxelStateMap states(map);
  FreeSpace space(states, kBody);
  FlightLattice<FreeSpace> known(space, space.options().bounds, 0.6);
  OptimisticLattice hope({.level_cost = 1.5, .climb_cost = 4.0});
  const Point3 start(0.1, 0.1, 0.5);
  std::size_t seen = 0, below = 0, above = 0;
  VoxelIndex top = VoxelIndex::Zero();
  double highest = 0.0, cost = 0.0;
  const auto search = [&] {
    seen = below = above = 0;
    highest = 0.0;
    hope.follow(space, 0.6);
    double last = 0.0;
    hope.search(start, known, [&](const auto& site, bool is_known) {
      CHECK(site.distance >= last - 1e-6);
      last = site.distance;
      CHECK(is_known == space.is_free(site.position));
      ++seen;
      ++(is_known ? below : above);
      if (site.position.z() > highest) {
        highest = site.position.z();
        top = site.cell;
        cost = site.distance;
      }
      return true;
    });
  };
  search();
  CHECK(seen == known.size() && below > 0 && above > 2 * below);
  const std::vector<VoxelIndex> way = hope.way_to(top);
  CHECK(way.back() == top && (known.position(way.front()) - start).norm() < 1.5);
  double up = 0.0;
  Point3 at = start;
  for (const VoxelIndex& c : way) {
    const Eigen::Vector3d step = known.position(c) - at;
    CHECK(step.cwiseAbs().maxCoeff() < 0.6 + 1e-9);
    const bool free = known.is_free(c);
    up += std::hypot((free ? 1.0 : 1.5) * step.head<2>().norm(), (free ? 1.0 : 4.0) * step.z());
    at += step;
  }
  CHECK_NEAR(up, cost, 1e-4);
  // A ceiling is seen: nothing above it is hoped for any more.
  for_each_index(VoxelIndex(-24, -16, 14), VoxelIndex(23, 15, 14),
                 [&](const VoxelIndex& v) { map_test::set_state(map, v, VoxelState::occupied); });
  states.update(map);
  space.update();
  known.forget(space.options().bounds);
  OptimisticLattice copy(hope);
  search();
  CHECK(below > 0 && highest < 14 * 0.3);
  const std::size_t left = seen;
  hope = copy;
  search();
  CHECK(seen == left);
}

TEST(the_look_that_opens_a_way_shows_what_a_body_needs_of_it) {
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex&) { return false; });
  StillMission still(map, kBody, PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 4.0),
                     Box3(Point3(-6.0, -4.0, -2.0), Point3(6.0, 4.0, 10.0)));
  FlightLattice<FreeSpace> lattice(still.free, still.free.options().bounds, 0.6);
  const Point3 start(-3.0, 0.1, 0.5);
  const std::vector<Teammate> robots{{{start, 0.0}, true, {}}};
  const SurfaceSituation situation = still.situation(robots);
  const auto reach = still.roadmap.reach_from(start);
  const std::vector<Point3> way{Point3(0, 0, 1.2), Point3(0, 0, 1.8), Point3(0, 0, 2.4),
                                Point3(0, 0, 3.0)};
  OpeningLooks opens;
  int looks = 0;
  std::set<VoxelKey> shown;
  while (const auto look = opens(situation, lattice, reach, robots[0].configuration, start, way)) {
    CHECK(++looks < 200);
    CHECK(look->targets.empty() && reach(look->configuration.position));
    // Unknown cells beside the way are in the image.
    const ViewFrustum frustum(still.camera, still.mount);
    const auto view = frustum.at(look->configuration);
    SpaceCells cells(still.states);
    std::size_t count = 0;
    for (std::size_t k = 1; k < way.size(); ++k)
      cells.has_room(way[k], still.free.required_distance(), [&](const VoxelKey& c) {
        const Point3 p = cells.center(VoxelIndex(c[0], c[1], c[2]));
        if (!view.contains(p)) return;
        ++count;
        shown.insert(c);
      });
    CHECK(count > 0);
    if (looks > 200) break;
  }
  // The map stands still, so in the end all is given up.
  CHECK(looks >= 3 && !shown.empty());
  const std::vector<Point3> open{Point3(0, 0, 0.5), Point3(1, 0, 0.5)};
  CHECK(!OpeningLooks()(situation, lattice, reach, robots[0].configuration, start, open));
}

TEST(one_drone_opens_the_way_to_what_it_cannot_see_yet) {
  // A box high above, seen from elsewhere, of which a side is not; no look from below reaches it.
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex& v) {
    return (v - VoxelIndex(0, 0, 24)).cwiseAbs().maxCoeff() <= 1;
  });
  for_each_index(VoxelIndex(-3, -3, 22), VoxelIndex(3, 3, 22),
                 [&](const VoxelIndex& v) { map_test::set_state(map, v, VoxelState::empty); });
  StillMission still(map, kBody, PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 3.0),
                     Box3(Point3(-5.0, -4.0, 5.0), Point3(5.0, 4.0, 9.0)));
  CHECK(!still.work.empty());
  const std::vector<Teammate> robots{{{Point3(0.1, 0.1, 0.5), 0.0}, true, {}}};
  RatePlannerOptions options;
  options.space_worth = 0.0;
  RatePlanner ahead(options);
  options.ahead = 0;
  RatePlanner near(options);
  CHECK(near(still.situation(robots)).routes.at(0).empty());
  const Plan result = ahead(still.situation(robots));
  CHECK(result.routes.at(0).size() == 1 && result.routes.at(0).front().targets.empty());
  CHECK(ahead.last_rate() > 0.0 && result.impossible.empty());
  CHECK(still.roadmap.reachable(robots[0].configuration.position,
                                result.routes.at(0).front().configuration.position));
}
}  // namespace
