// SPDX-License-Identifier: MIT
#include <surfleet/planning/team_tour.hpp>
//
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/planning/opening_view.hpp>
#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>

#include "check.hpp"
#include "paint_states.hpp"
#include "still_mission.hpp"

namespace {
using namespace surfleet;

/// Views that show things of a gain each, by site and heading. Bounds are loose or exact.
struct ListedViews {
  std::vector<std::array<std::vector<int>, kHeadings>> shows;
  std::vector<double> things;
  bool loose = false;
  int asked = 0;

  double gain(std::size_t s, std::size_t view) const {
    double sum = 0.0;
    for (const int i : shows[s][view]) sum += things[static_cast<std::size_t>(i)];
    return sum;
  }
  double most(std::size_t s) const {
    double most = 0.0;
    for (std::size_t k = 0; k < kHeadings; ++k) most = std::max(most, gain(s, k));
    return loose ? 1.5 * most + 0.1 : most;
  }
  double evaluate(std::size_t s, double enough, GainByView& by_view) {
    for (std::size_t k = 0; k < kHeadings; ++k) by_view[k] = gain(s, k);
    const double most = by_view.most();
    if (loose && most < enough) {
      by_view.fill(1e9);  // not to be read
      return enough;
    }
    ++std::atomic_ref<int>(asked);
    return most;
  }
  void take(std::size_t s, int view) {
    for (const int i : shows[s][static_cast<std::size_t>(view)])
      things[static_cast<std::size_t>(i)] = 0.0;
  }
};
static_assert(ViewsFromSites<ListedViews> && !ViewsFromSites<int>);

struct Scattered {
  std::vector<Point3> sites;
  ListedViews views;
  std::vector<TourStart> team;

  std::vector<std::vector<TeamTourStop>> tours(const TeamTourOptions& options) {
    return TeamTours(team, sites, views, options)();
  }
};
Scattered scattered(std::uint64_t seed, int robots, int stops) {
  Random random(seed);
  Scattered all;
  const auto place = [&] {
    const double x = random.uniform(0, 10), y = random.uniform(0, 10), z = random.uniform(0, 10);
    return Point3(x, y, z);
  };
  for (int i = 0; i < 60; ++i) all.views.things.push_back(random.uniform(0.1, 3.0));
  for (int s = 0; s < 40; ++s) {
    all.sites.push_back(place());
    all.views.shows.emplace_back();
    for (auto& things : all.views.shows.back()) {
      std::set<int> distinct;
      for (int n = static_cast<int>(random.uniform(0.0, 6.0)); n > 0; --n)
        distinct.insert(static_cast<int>(random.uniform(0.0, 59.9)));
      things.assign(distinct.begin(), distinct.end());
    }
  }
  for (int r = 0; r < robots; ++r) {
    const Point3 from = place();
    TourStart start{{from, random.uniform(-3.0, 3.0)}, {}, stops};
    for (const Point3& p : all.sites)
      start.distance.push_back((p - from).norm() * random.uniform(1.0, 1.4));
    all.team.push_back(std::move(start));
  }
  return all;
}

TEST(the_first_stop_of_a_team_is_the_one_that_pays_best) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scattered all = scattered(seed, 3, 1);
    all.team[1].goal = 7;
    all.team[2].distance[3] = std::numeric_limits<double>::infinity();
    double best = 0.0;
    std::size_t robot = 0;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t s = 0; s < all.sites.size(); ++s)
        for (std::size_t k = 0; k < kHeadings; ++k) {
          const double turn =
              std::abs(wrap_angle(heading_angle(static_cast<int>(k)) - all.team[r].from.yaw));
          const double keep = r == 1 && s == 7 ? 1.5 : 1.0;
          const double rate =
              all.views.gain(s, k) / ((all.team[r].distance[s] + 0.7) / keep + 0.2 * turn);
          if (rate > best) robot = r;
          best = std::max(best, rate);
        }
    const auto tours = all.tours({.stop_cost = 0.7, .turn_cost = 0.2, .keep = 1.5});
    CHECK(tours.size() == 3 && tours[0].size() == 1 && tours[1].size() == 1 &&
          tours[2].size() == 1);
    CHECK_NEAR(tours[robot].at(0).rate, best, 1e-12);
    CHECK(tours[0][0].rate <= best && tours[1][0].rate <= best && tours[2][0].rate <= best);
    CHECK(tours[2][0].site != 3);
  }
}

TEST(tours_show_new_things_at_every_stop_however_loose_bounds_are) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scattered exact = scattered(seed, 2, 6), loose = scattered(seed, 2, 6);
    loose.views.loose = true;
    const auto a = exact.tours({}), b = loose.tours({});
    CHECK(a.size() == 2 && b.size() == 2 && a[0].size() == 6 && a[1].size() == 6);
    std::set<int> seen;
    const ListedViews before = scattered(seed, 2, 6).views;
    for (std::size_t r = 0; r < 2; ++r) {
      CHECK(b[r].size() == a[r].size());
      for (std::size_t k = 0; k < a[r].size(); ++k) {
        CHECK(a[r][k].site == b[r][k].site && a[r][k].view == b[r][k].view &&
              a[r][k].rate == b[r][k].rate);
        CHECK(a[r][k].rate > 0.0);
        const auto& shown = before.shows[a[r][k].site][static_cast<std::size_t>(a[r][k].view)];
        seen.insert(shown.begin(), shown.end());
      }
    }
    CHECK(loose.views.asked < exact.views.asked);
    for (std::size_t i = 0; i < before.things.size(); ++i)
      CHECK(exact.views.things[i] == (seen.contains(static_cast<int>(i)) ? 0.0 : before.things[i]));
    // Told to go on, tours end when nothing is left to be seen from anywhere.
    exact.team[0].stops = exact.team[1].stops = 1000;
    const auto rest = exact.tours({});
    CHECK(rest[0].size() + rest[1].size() < 60);
    for (std::size_t s = 0; s < exact.sites.size(); ++s)
      for (std::size_t k = 0; k < kHeadings; ++k) CHECK(exact.views.gain(s, k) == 0.0);
    exact.team[0].stops = 0;
    CHECK(exact.tours({})[0].empty());
  }
}

TEST(tours_are_the_same_on_any_number_of_threads) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto alone = scattered(seed, 3, 8).tours({});
    for (const int threads : {2, 5}) {
      Scattered all = scattered(seed, 3, 8);
      all.views.loose = seed % 2 == 0;
      const auto tours = all.tours({.threads = threads});
      for (std::size_t r = 0; r < 3; ++r) {
        CHECK(tours[r].size() == alone[r].size());
        for (std::size_t k = 0; k < alone[r].size(); ++k)
          CHECK(tours[r][k].site == alone[r][k].site && tours[r][k].view == alone[r][k].view &&
                tours[r][k].rate == alone[r][k].rate);
      }
    }
  }
}

/// Remembers which sites were evaluated since the last stop was taken.
struct OnceViews : ListedViews {
  explicit OnceViews(ListedViews v) : ListedViews(std::move(v)) {}
  std::multiset<std::size_t> evaluated;

  double evaluate(std::size_t s, double enough, GainByView& by_view) {
    evaluated.insert(s);
    return ListedViews::evaluate(s, enough, by_view);
  }
  void take(std::size_t s, int view) {
    for (const std::size_t e : evaluated) CHECK(evaluated.count(e) == 1);
    evaluated.clear();
    ListedViews::take(s, view);
  }
};

// Sites are evaluated at the same time, so the same one twice would be a race.
TEST(no_site_is_evaluated_twice_for_a_stop) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const bool loose : {false, true}) {
      Scattered all = scattered(seed, 2, 6);
      all.views.loose = loose;
      OnceViews views(all.views);
      const auto tours = TeamTours(all.team, all.sites, views, TeamTourOptions{.turn_cost = 1.0})();
      CHECK(tours[0].size() == 6);
    }
}

TEST(a_tour_takes_the_small_en_route_to_the_broad) {
  // The broad pays best and is far off; alone it would be flown to at once.
  const auto row = [](int stops) {
    Scattered all;
    all.views.things = {60.0, 2.0, 2.0, 2.0};
    all.team.push_back({{Point3::Zero(), 0.0}, {}, stops});
    for (const double x : {20.0, 12.0, 8.0, 4.0}) {
      all.sites.push_back(Point3(x, 0.1, 0));
      all.team[0].distance.push_back(x);
      all.views.shows.emplace_back();
      all.views.shows.back()[0] = {static_cast<int>(all.sites.size()) - 1};
    }
    return all.tours({});
  };
  CHECK(row(1).at(0).at(0).site == 0);
  const auto tour = row(4).at(0);
  CHECK(tour.size() == 4 && tour[0].site == 3 && tour[1].site == 2 && tour[2].site == 1 &&
        tour[3].site == 0);
  Scattered nowhere;
  nowhere.team.push_back({{Point3::Zero(), 0.0}, {}, 10});
  CHECK(nowhere.tours({}).at(0).empty());
  nowhere.team.clear();
  CHECK(nowhere.tours({}).empty());
}

TEST(a_team_shares_what_one_could_do_alone) {
  // A row of things before two robots, one of them a little nearer to all.
  const auto stops_of_first = [](double balance) {
    Scattered all;
    all.team.push_back({{Point3(0.0, 0.0, 0.0), 0.0}, {}, 20});
    all.team.push_back({{Point3(-0.5, 0.5, 0.0), 0.0}, {}, 20});
    for (int i = 0; i < 20; ++i) {
      all.views.things.push_back(1.0);
      all.sites.push_back(Point3(2.0 + 0.1 * i, i % 2 == 0 ? 1.0 : -1.0, 0.0));
      for (TourStart& start : all.team)
        start.distance.push_back((all.sites.back() - start.from.position).norm());
      all.views.shows.emplace_back();
      all.views.shows.back()[0] = {i};
    }
    const auto tours = all.tours({.balance = balance});
    CHECK(tours[0].size() + tours[1].size() == 20);
    return tours[0].size();
  };
  CHECK(stops_of_first(0.0) == 20);
  CHECK(stops_of_first(0.3) >= 8 && stops_of_first(0.3) <= 14);
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
  const std::vector<VoxelIndex> path = hope.path_to(top);
  CHECK(path.back() == top && (known.position(path.front()) - start).norm() < 1.5);
  double up = 0.0;
  Point3 at = start;
  for (const VoxelIndex& c : path) {
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

TEST(the_view_that_opens_a_path_shows_what_a_body_needs_of_it) {
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex&) { return false; });
  StillMission still(map, kBody, PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 4.0),
                     Box3(Point3(-6.0, -4.0, -2.0), Point3(6.0, 4.0, 10.0)));
  FlightLattice<FreeSpace> lattice(still.free, still.free.options().bounds, 0.6);
  const Point3 start(-3.0, 0.1, 0.5);
  const std::vector<Teammate> robots{{{start, 0.0}, true, {}}};
  const SurfaceSituation situation = still.situation(robots);
  const auto reach = still.roadmap.reach_from(start);
  const std::vector<Point3> path{Point3(0, 0, 1.2), Point3(0, 0, 1.8), Point3(0, 0, 2.4),
                                 Point3(0, 0, 3.0)};
  OpeningViews opens;
  int taken = 0;
  std::set<VoxelKey> shown;
  while (const auto found =
             opens(situation, lattice, reach, robots[0].configuration, start, path)) {
    CHECK(++taken < 200);
    CHECK(found->targets.empty() && reach(found->configuration.position));
    // Unknown cells beside the path are in the image.
    const ViewFrustum frustum(still.camera, still.mount);
    const auto view = frustum.at(found->configuration);
    SpaceCells cells(still.states);
    std::size_t count = 0;
    for (std::size_t k = 1; k < path.size(); ++k)
      cells.has_room(path[k], still.free.required_distance(), [&](const VoxelKey& c) {
        const Point3 p = cells.center(VoxelIndex(c[0], c[1], c[2]));
        if (!view.contains(p)) return;
        ++count;
        shown.insert(c);
      });
    CHECK(count > 0);
    if (taken > 200) break;
  }
  // The map stands still, so in the end all is given up.
  CHECK(taken >= 3 && !shown.empty());
  const std::vector<Point3> open{Point3(0, 0, 0.5), Point3(1, 0, 0.5)};
  CHECK(!OpeningViews()(situation, lattice, reach, robots[0].configuration, start, open));
}

TEST(robots_open_the_path_to_what_they_cannot_see_yet) {
  // A box high above, seen from elsewhere, of which a side is not; no view from below reaches it.
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex& v) {
    return (v - VoxelIndex(0, 0, 24)).cwiseAbs().maxCoeff() <= 1;
  });
  for_each_index(VoxelIndex(-3, -3, 22), VoxelIndex(3, 3, 22),
                 [&](const VoxelIndex& v) { map_test::set_state(map, v, VoxelState::empty); });
  StillMission still(map, kBody, PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 3.0),
                     Box3(Point3(-5.0, -4.0, 5.0), Point3(5.0, 4.0, 9.0)));
  CHECK(!still.work.empty());
  RollingToursOptions options;
  options.interest.frontier_gain = 0.0;
  for (const std::size_t robots : {1U, 2U}) {
    std::vector<Teammate> team{{{Point3(0.1, 0.1, 0.5), 0.0}, true, {}},
                               {{Point3(3.1, 0.1, 0.5), 0.0}, true, {}}};
    team.resize(robots);
    RollingTours planner(options);
    const Plan result = planner(still.situation(team));
    options.threads = 3;
    RollingTours beside(options);
    const Plan same = beside(still.situation(team));
    for (RobotId r = 0; r < robots; ++r) {
      CHECK(same.routes.at(r).size() == result.routes.at(r).size());
      for (std::size_t k = 0; k < std::min(same.routes.at(r).size(), result.routes.at(r).size());
           ++k)
        CHECK(same.routes.at(r)[k].configuration.position ==
                  result.routes.at(r)[k].configuration.position &&
              same.routes.at(r)[k].configuration.yaw == result.routes.at(r)[k].configuration.yaw);
    }
    std::size_t sent = 0;
    for (RobotId r = 0; r < robots; ++r)
      for (const Stop& stop : result.routes.at(r)) {
        CHECK(stop.targets.empty());
        CHECK(still.roadmap.reachable(team[r].configuration.position, stop.configuration.position));
        ++sent;
      }
    CHECK(sent >= 1 && result.impossible.empty());
  }
}

TEST(views_gain_what_is_in_sight_and_not_taken_however_much_is_enough) {
  TsdfMap map({.voxel_size = 0.3});
  paint_hall(map, [](const VoxelIndex& v) { return v.x() == 4 && v.z() < 6; });
  VoxelStateMap states(map);
  FreeSpace space(states, kBody);
  FlightLattice<FreeSpace> lattice(space, space.options().bounds, 0.6);
  const HeadingTable headings(PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 4.0),
                              forward_camera_mount());
  Random random(8);
  std::vector<SightTarget> list;
  for (int i = 0; i < 400; ++i) {
    const double x = random.uniform(-6, 6), y = random.uniform(-4, 4), z = random.uniform(-1, 3);
    list.push_back({Point3(x, y, z), Eigen::Vector3d::UnitX() * (i % 3 == 0 ? 0.0 : 1.0),
                    random.uniform(0.1, 1.0), i % 4});
  }
  const SightTargets<> targets(list, MapSight(states), headings);
  MapSight through(states);
  through.see_through_unknown();
  const SightTargets<> hoped(list, through, headings);
  const ViewsInVain vain;
  LatticeViews views(targets, lattice, headings, vain, 0.7);
  for_each_index(VoxelIndex::Zero(), lattice.count() - VoxelIndex::Ones(),
                 [&](const VoxelIndex& c) {
                   if (random.uniform(0.0, 1.0) < 0.1) views.add({c, c.z() % 2 == 0});
                 });
  CHECK(views.size() > 50);
  std::vector<char> done(targets.size(), 0);
  int enough_said = 0, told = 0;
  for (int round = 0; round < 1500; ++round) {
    const auto s =
        static_cast<std::size_t>(random.uniform(0.0, 1.0) * static_cast<double>(views.size()));
    const LatticeViews::Site site = views[s];
    const auto seen = (site.known ? targets : hoped).seen_from(lattice.position(site.cell));
    GainByView truth = gain_by_view(targets, seen, done), gain;
    for (std::size_t k = 0; k < truth.size(); ++k) truth[k] *= site.known ? 1.0 : 0.7;
    const double best = truth.most();
    CHECK(views.most(s) >= best - 1e-9);
    const double enough = random.uniform(0.0, 1.5) * best;
    const double most = views.evaluate(s, enough, gain);
    CHECK(most >= best - 1e-9);
    if (most <= enough) {
      CHECK(best <= enough + 1e-9);
      ++enough_said;
      continue;
    }
    CHECK_NEAR(most, best, 1e-12);
    ++told;
    for (std::size_t k = 0; k < kHeadings; ++k) {
      if (truth[k] > enough) CHECK_NEAR(gain[k], truth[k], 1e-12);
      CHECK(gain[k] >= truth[k] - 1e-9 && (truth[k] > enough || gain[k] <= enough));
    }
    if (round % 10 != 0) continue;
    const int heading = round / 10 % kHeadings;
    views.take(s, heading);
    mark_in_view(seen, heading, done, [](std::size_t) {});
    CHECK(std::equal(done.begin(), done.end(), views.done().begin()));
  }
  CHECK(enough_said > 200 && told > 200);
}

TEST(a_gimbal_views_what_is_above_its_shaft) {
  // Of a plate 1.3 m above the highest place in a shaft 1.6 m wide, the underside is incomplete.
  TsdfMap map({.voxel_size = 0.3});
  const auto near = [](const VoxelIndex& v, int r) {
    return v.head<2>().cwiseAbs().maxCoeff() <= r;
  };
  paint_hall(map, [&](const VoxelIndex& v) { return v.z() == 10 && near(v, 2); });
  for_each_index(VoxelIndex(-4, -4, 8), VoxelIndex(4, 4, 9),
                 [&](const VoxelIndex& v) { map_test::set_state(map, v, VoxelState::empty); });
  FreeSpaceOptions body = kBody;
  body.bounds = Box3(Point3(-0.8, -0.8, -1.2), Point3(0.8, 0.8, 1.7));
  RobotKind kind =
      StillMission::kind_of(body, PinholeCamera::from_fov(1.2, 1.0, 160, 120, 0.1, 4.0));
  RollingToursOptions options;
  options.interest.frontier_gain = options.interest.prediction_gain = 0.0;
  options.slack = 0.0;  // stops stay at their places
  const std::vector<Teammate> team{{{Point3(0.1, 0.1, 0.5), 0.0}, true, {}}};
  for (const bool gimbal : {false, true}) {
    kind.pitches = {0.0, 1.0, -1.0};
    if (!gimbal) kind.pitches = {0.0};
    StillMission still(map, kind, Box3(Point3(-2.0, -2.0, 2.0), Point3(2.0, 2.0, 3.3)));
    CHECK(!still.work.empty());
    RollingTours planner(options);
    const Stops route = planner(still.situation(team)).routes.at(0);
    CHECK(route.empty() != gimbal);
    if (!gimbal) continue;
    CHECK(route[0].configuration.pitch == -1.0 && !route[0].targets.empty());
    const ViewFrustum frustum(still.camera, still.mount);
    for (const VoxelIndex& v : route[0].targets) {
      const Point3 p = still.states.grid().center(v);
      CHECK(frustum.at(route[0].configuration).may_contain(p, 0.3));
      Configuration level = route[0].configuration;
      level.pitch = 0.0;
      CHECK(!frustum.at(level).may_contain(p, 0.3));
    }
    // No other is sent to view the same, nor the robot once more when it is there.
    const std::vector<Teammate> two{{route[0].configuration, false, route},
                                    {{Point3(-0.4, -0.4, 0.5), 0.0}, true, {}}};
    const Stops second = planner(still.situation(two)).routes.at(1);
    for (const Stop& stop : second)
      for (const VoxelIndex& v : stop.targets)
        CHECK(std::find(route[0].targets.begin(), route[0].targets.end(), v) ==
              route[0].targets.end());
    const std::vector<Teammate> there{{route[0].configuration, true, {}}};
    const Stops again = planner(still.situation(there)).routes.at(0);
    for (const Stop& stop : again)
      CHECK(stop.configuration.position != route[0].configuration.position ||
            stop.configuration.yaw != route[0].configuration.yaw ||
            stop.configuration.pitch != route[0].configuration.pitch);
  }
}
TEST(the_beginning_of_a_route_that_pays_best_counts) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    Outlook outlook;
    double gain = 0.0, distance = 0.0, most = 0.0;
    for (int k = 0; k < 6; ++k) {
      const double g = random.uniform(0.0, 5.0), w = random.uniform(0.1, 9.0);
      outlook.add(g, w);
      gain += g;
      distance += w;
      most = std::max(most, gain / distance);
    }
    CHECK_NEAR(outlook.best().gain / outlook.best().distance, most, 1e-12);
    CHECK(outlook.whole().gain == gain && outlook.whole().distance == distance);
  }
  Outlook at_once;  // what takes no flight pays more than anything that does
  at_once.add(1e-3, 0.0);
  at_once.add(1e3, 1.0);
  CHECK(at_once.best().distance == 0.0);
}
}  // namespace
