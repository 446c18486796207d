// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/teammate_mask.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/planning/rolling_tours.hpp>
#include <surfleet/planning/tour_planner.hpp>
#include <surfleet/viewpoint/frontiers.hpp>
#include <surfleet/viewpoint/gain.hpp>
#include <surfleet/viewpoint/gain_around.hpp>
#include <surfleet/viewpoint/gain_bound.hpp>
#include <surfleet/viewpoint/view_ledger.hpp>
#include <surfleet/viewpoint/view_memory.hpp>

#include "check.hpp"
#include "paint_states.hpp"
#include "still_mission.hpp"

namespace {
using namespace surfleet;

/// Free but for a slab 4 < x < 5 with a gap at y > 8.
struct Slab {
  bool is_free(const Point3& p) const { return !(p.x() > 4.0 && p.x() < 5.0 && p.y() < 8.0); }
  bool is_free_segment(const Point3& a, const Point3& b) const {
    for (int i = 0; i <= 200; ++i)
      if (!is_free(a + (b - a) * (i / 200.0))) return false;
    return true;
  }
};

TEST(lattice_search_goes_outward_and_around) {
  const Slab slab;
  const Box3 box(Point3(0, 0, 0), Point3(10, 10, 3));
  FlightLattice<Slab> lattice(slab, box, 1.0);
  CHECK(lattice.size() == 11 * 11 * 4);
  double last = 0.0, behind = 0.0;
  std::size_t visited = 0;
  lattice.search({1.2, 1.1, 1.0}, [&](const auto& site) {
    CHECK(site.distance >= last - 1e-9);
    CHECK(slab.is_free(site.position) && box.contains(site.position));
    last = site.distance;
    ++visited;
    if ((site.position - Point3(9, 1, 1)).norm() < 1e-9) behind = site.distance;
    return true;
  });
  CHECK(visited == lattice.size());  // every node lies on a free integer coordinate
  CHECK(behind > 14.0 && behind < 20.0);
}
TEST(lattice_search_stops_when_told_and_finds_nothing_when_shut_in) {
  const Slab slab;
  FlightLattice<Slab> lattice(slab, {Point3(0, 0, 0), Point3(10, 10, 3)}, 1.0);
  int visits = 0;
  lattice.search({1, 1, 1}, [&](const auto&) { return ++visits < 5; });
  CHECK(visits == 5);
  struct Nowhere {
    bool is_free(const Point3&) const { return false; }
    bool is_free_segment(const Point3&, const Point3&) const { return false; }
  } nowhere;
  FlightLattice<Nowhere> none(nowhere, {Point3(0, 0, 0), Point3(3, 3, 3)}, 1.0);
  none.search({1, 1, 1}, [&](const auto&) {
    CHECK(false);
    return true;
  });
}

TEST(lattice_search_goes_on_beyond_passages_too_narrow_for_it) {
  // Four rooms along x; only the caller knows of passages into the others, but the last.
  struct Walls {
    static int room(const Point3& p) { return static_cast<int>(p.x() / 5.0); }
    bool is_free(const Point3& p) const { return std::fmod(p.x(), 5.0) < 3.5; }
    bool is_free_segment(const Point3& a, const Point3& b) const { return room(a) == room(b); }
  } walls;
  FlightLattice<Walls> lattice(walls, {Point3(0, 0, 0), Point3(18, 4, 2)}, 1.0);
  const std::array<double, 4> length{0.0, 30.0, 7.5, std::numeric_limits<double>::infinity()};
  std::array<std::size_t, 4> asked{}, met{};
  std::array<double, 4> nearest{1e9, 1e9, 1e9, 1e9};
  double last = 0.0;
  VoxelIndex end = VoxelIndex::Zero();
  lattice.search(
      {1, 1, 1},
      [&](const auto& site) {
        const auto room = static_cast<std::size_t>(Walls::room(site.position));
        ++met[room];
        nearest[room] = std::min(nearest[room], site.distance);
        if (room == 0) CHECK(met[1] + met[2] == 0);
        if (met[0] == 60 && room > 0) {
          CHECK(site.distance >= last);
          last = site.distance;
          end = site.cell;
        }
        return true;
      },
      [&](const Point3& p) {
        const auto room = static_cast<std::size_t>(Walls::room(p));
        CHECK(walls.is_free(p) && room > 0);
        ++asked[room];
        if (room < 3) CHECK(p.x() == 5.0 * Walls::room(p) && p.y() == 1.0 && p.z() == 1.0);
        return length[room];
      });
  // One of a room's nodes is asked about, the nearest, and the lattice has the rest from there.
  CHECK(met == (std::array<std::size_t, 4>{60, 60, 60, 0}));
  CHECK(asked == (std::array<std::size_t, 4>{0, 1, 1, 60}));
  CHECK(nearest[1] == 30.0 && nearest[2] == 7.5);
  const std::vector<VoxelIndex> path = lattice.path_to(end);
  CHECK(path.front() == lattice.nearest({5, 1, 1}) && path.back() == end);
  // Whoever has enough is not led on.
  std::size_t visits = 0;
  lattice.search(
      {1, 1, 1}, [&](const auto&) { return ++visits < 60; },
      [](const Point3&) {
        CHECK(false);
        return 1.0;
      });
  CHECK(visits == 60);
}

TEST(lattice_search_follows_the_space_where_it_is_told_to) {
  // Boxes come and go; a lattice that is told where finds what a new one does.
  struct Boxes {
    std::vector<Box3> boxes;
    bool is_free(const Point3& p) const {
      return std::none_of(boxes.begin(), boxes.end(), [&](const Box3& b) { return b.contains(p); });
    }
    bool is_free_segment(const Point3& a, const Point3& b) const {
      for (int i = 0; i <= 20; ++i)
        if (!is_free(a + (b - a) * (i / 20.0))) return false;
      return true;
    }
  } space;
  const Box3 box(Point3(-7, 3, 0), Point3(5, 13, 4));
  FlightLattice<Boxes> kept(space, box, 0.9);
  const auto sites = [&](FlightLattice<Boxes>& lattice) {
    std::vector<std::pair<std::size_t, double>> met;
    lattice.search({-6.5, 3.5, 0.5}, [&](const auto& site) {
      met.emplace_back(lattice.index(site.cell), site.distance);
      return true;
    });
    return met;
  };
  Random random(5);
  std::size_t fewest = kept.size();
  for (int round = 0; round < 40; ++round) {
    const auto at = [&](double low, double high) { return random.uniform(low, high); };
    const Point3 corner(at(-9, 5), at(1, 13), at(-2, 4));
    if (space.boxes.size() > 6) {
      kept.forget(space.boxes.front());
      space.boxes.erase(space.boxes.begin());
    }
    space.boxes.emplace_back(corner, corner + Point3(at(0.1, 4), at(0.1, 9), at(0.1, 5)));
    kept.forget(space.boxes.back());
    FlightLattice<Boxes> fresh(space, box, 0.9);
    const auto met = sites(kept);
    CHECK(met == sites(fresh));
    fewest = std::min(fewest, met.size());
  }
  CHECK(fewest < kept.size() * 9 / 10);
  kept.forget(Box3());
}

/// Targets of any gain, to be seen from any side, all over a box.
std::vector<SightTarget> scattered_targets(Random& random, int count, const Box3& box) {
  std::vector<SightTarget> targets;
  for (int i = 0; i < count; ++i) {
    SightTarget t;
    for (int axis = 0; axis < 3; ++axis)
      t.position[axis] = random.uniform(box.min()[axis], box.max()[axis]);
    t.gain = random.uniform(0.1, 2.0);
    targets.push_back(t);
  }
  return targets;
}

TEST(gain_bound_is_never_below_what_is_in_view) {
  // A camera that is pitched down a little, and targets beyond the lattice on all sides.
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 40, 30, 0.8, 4.0);
  Pose mount = forward_camera_mount();
  mount.rotate(Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitX()));
  const HeadingTable headings(camera, mount);
  Random random(8);
  struct Anything {
    bool operator()(const Point3&, const SightTarget&) const { return true; }
  };
  const SightTargets<Anything> targets(
      scattered_targets(random, 3000, {Point3(-9, -8, -6), Point3(11, 12, 9)}), Anything{},
      headings);
  const Slab slab;
  const FlightLattice<Slab> lattice(slab, {Point3(-3, -2, 0), Point3(5, 6, 3)}, 0.7);
  const GainBound most(targets.all(), lattice, headings, targets.reach());
  const std::vector<char> none(targets.size(), 0);
  double bounds = 0.0, gains = 0.0;
  for (int i = 0; i < 200; ++i) {
    VoxelIndex node;
    for (int axis = 0; axis < 3; ++axis)
      node[axis] = static_cast<int>(random.uniform(0, lattice.count()[axis]));
    const auto seen = gain_by_view(targets, targets.seen_from(lattice.position(node)), none);
    const auto bound = most(node);
    for (std::size_t k = 0; k < kHeadings; ++k) {
      CHECK(bound[k] >= seen[k]);
      CHECK(most.in_any_view(node) >= bound[k] - 1e-9);
      bounds += bound[k];
      gains += seen[k];
    }
  }
  CHECK(gains > 0.1 * bounds);  // and of use
  // A single target shows where a box is too small.
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    const VoxelIndex node(2 + i % 8, 3 + i % 5, 1 + i % 3);
    Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    d *= random.uniform(3.6, 4.0) / d.norm();
    const SightTargets<Anything> one(
        {{lattice.position(node) + d, Eigen::Vector3d::Zero(), 1.0, 0}}, Anything{}, headings);
    const GainBound bound(one.all(), lattice, headings, one.reach());
    const auto gain = gain_by_view(one, one.seen_from(lattice.position(node)), none);
    for (std::size_t k = 0; k < kHeadings; ++k) {
      CHECK(bound(node)[k] >= gain[k]);
      seen += gain[k] > 0.0 ? 1 : 0;
    }
  }
  CHECK(seen > 400);
  const GainBound nothing({}, lattice, headings, 4.0);
  CHECK(nothing.in_any_view(VoxelIndex::Zero()) == 0.0);
}

TEST(gain_around_bounds_what_a_view_can_see) {
  Random random(3);
  const std::vector<SightTarget> targets =
      scattered_targets(random, 300, {Point3::Constant(-9), Point3::Constant(9)});
  const double reach = 2.5;
  const GainAround around(targets, reach);
  double most = 0.0;
  for (int i = 0; i < 200; ++i) {
    const Point3 p(random.uniform(-11, 11), random.uniform(-11, 11), random.uniform(-11, 11));
    double ball = 0.0, cube = 0.0;
    const Eigen::Array3i cell = (p / reach).array().floor().cast<int>();
    for (const SightTarget& t : targets) {
      if ((t.position - p).norm() <= reach) ball += t.gain;
      const Eigen::Array3i c = (t.position / reach).array().floor().cast<int>();
      if ((c - cell).abs().maxCoeff() <= 1) cube += t.gain;
    }
    CHECK(around(p) >= ball - 1e-9);
    CHECK(std::abs(around(p) - cube) < 1e-9);
    most = std::max(most, cube);
  }
  CHECK(around.largest() >= most - 1e-9);
  CHECK(GainAround({}, 1.0).largest() == 0.0 && GainAround({}, 1.0)({0, 0, 0}) == 0.0);
}

/// Pillars on a floor, and unknown space among them that ends what is known.
VoxelState among_pillars(const VoxelIndex& v) {
  const bool pillar = (v.x() & 15) < 4 && (v.y() & 15) < 4 && v.z() < 9;
  return v.z() == 0 || pillar                 ? VoxelState::occupied
         : (v.x() + 40) % 23 < 3 && v.z() < 6 ? VoxelState::unknown
                                              : VoxelState::empty;
}

/// What robots believe of a hall of 20 × 14 m.
template <typename StateAt>
StillMission in_hall(const StateAt& state) {
  TsdfMap map({.voxel_size = 0.3});
  map_test::paint(map, {-36, -24, 0}, {36, 24, 13}, state);
  return {std::move(map),
          {.radius = 0.4, .margin = 0.3},
          PinholeCamera::from_fov(1.0, 0.8, 160, 120, 0.3, 4.0),
          Box3(Point3(-10.0, -7.0, 0.0), Point3(10.0, 7.0, 3.5))};
}

TEST(what_is_remembered_of_views_is_what_would_be_found_anew) {
  constexpr double kVoxel = 0.3;
  TsdfMap map({.voxel_size = kVoxel});
  Random random(6);
  map_test::paint(map, {-36, -36, 0}, {36, 36, 13}, among_pillars);
  VoxelStateMap states(map);
  FreeSpace free(states, {.radius = 0.4, .margin = 0.3});
  IncompleteSurface incomplete;
  incomplete.update(states);
  const PinholeCamera camera = PinholeCamera::from_fov(1.0, 0.8, 160, 120, 0.3, 4.0);
  const ViewFrustum frustum(camera);
  ViewLedger ledger({.max_views = 3});

  ChangedRegions changed;
  ViewpointMemory viewpoints;
  SightMemory sights;
  double wall = 9.0;  // nothing beyond can be reached
  std::size_t asked = 0;
  const auto is_free = [&](const Configuration& q) { return free.is_free(q.position); };
  const auto is_reachable = [&](const Configuration& q) { return q.position.x() < wall; };
  const auto promises = [&](const IncompleteElement& e, const Eigen::Vector3d& d) {
    ++asked;
    return ledger.promises(e.voxel, d);
  };
  std::size_t anew = 0, remembered = 0;
  for (int round = 0; round < 12; ++round) {
    const std::vector<IncompleteElement> elements = incomplete.elements();
    const std::vector<Box3> boxes = changed(states, states, free);
    CHECK(round == 0 || !boxes.empty());
    viewpoints.forget(boxes);
    sights.forget(boxes);

    asked = 0;
    const ViewpointOptions options{.distance = 2.5};
    const ViewpointSet fresh = generate_viewpoints(std::span(elements), states, camera, options,
                                                   is_free, is_reachable, promises);
    if (round > 0) anew += asked;
    asked = 0;
    ViewpointGenerator generate(states, camera, options);
    const ViewpointSet kept =
        viewpoints(generate, elements, ledger, is_free, is_reachable, promises);
    if (round > 0) remembered += asked;
    CHECK(fresh.size() > 20 && !fresh.unseen.empty());
    CHECK(kept.size() == fresh.size() && kept.unseen.size() == fresh.unseen.size());
    for (std::size_t i = 0; i < std::min(kept.size(), fresh.size()); ++i) {
      CHECK(kept[i].configuration.position == fresh[i].configuration.position);
      CHECK(kept[i].configuration.yaw == fresh[i].configuration.yaw);
      CHECK(kept[i].targets == fresh[i].targets);
    }
    for (std::size_t i = 0; i < std::min(kept.unseen.size(), fresh.unseen.size()); ++i)
      CHECK(kept.unseen[i].element == fresh.unseen[i].element &&
            kept.unseen[i].reason == fresh.unseen[i].reason);
    const IncompleteSurfaceGain gain(elements, states, frustum);
    CHECK(sights(kept.views, elements, frustum, [&](const Configuration& q) {
            return gain.seen(q);
          }) == seen_from_all(gain, kept.views));

    // A little of the map changes, a view is in vain, and much more or less can be reached.
    const VoxelIndex middle(static_cast<int>(random.below(70)) - 35,
                            static_cast<int>(random.below(70)) - 35, 4);
    for (int k = 0; k < 60; ++k) {
      const VoxelIndex v = middle + VoxelIndex(static_cast<int>(random.below(7)) - 3,
                                               static_cast<int>(random.below(7)) - 3,
                                               static_cast<int>(random.below(7)) - 3);
      map_test::set_state(map, v,
                          random.uniform(0.0, 1.0) < 0.6 ? VoxelState::empty
                          : random.below(2) == 0         ? VoxelState::occupied
                                                         : VoxelState::unknown);
    }
    const Viewpoint& view = kept[random.below(kept.size())];
    ledger.viewed_in_vain(elements[static_cast<std::size_t>(view.targets[0])].voxel,
                          view.direction);
    wall = random.uniform(6.0, 12.0);
    states.update(map);
    free.update();
    incomplete.update(states);
  }
  CHECK(remembered * 2 < anew);  // what cannot be reached is always asked about
}

TEST(nobody_is_sent_where_he_cannot_get) {
  // Two rooms, and between them a wall without a door.
  StillMission still = in_hall([](const VoxelIndex& v) {
    return std::abs(v.x() - 3) < 2 ? VoxelState::occupied : among_pillars(v);
  });
  const auto check = [&](auto planner) {
    std::size_t stops = 0;
    Random random(4);
    for (int round = 0; round < 2; ++round) {
      std::vector<Teammate> robots;
      while (robots.size() < 3) {
        const Point3 p(random.uniform(-8, 8), random.uniform(-6, 6), random.uniform(1, 2.5));
        if (still.free.is_free(p)) robots.push_back({{p, 0.0}, true, {}});
      }
      const Plan result = planner(still.situation(robots));
      std::size_t served = 0;
      for (RobotId r = 0; r < robots.size(); ++r) {
        served += result.routes.at(r).empty() ? 0 : 1;
        for (const Stop& stop : result.routes.at(r)) {
          CHECK(still.roadmap.reachable(robots[r].configuration.position,
                                        stop.configuration.position));
          ++stops;
        }
      }
      CHECK(served >= 2);
    }
    CHECK(stops > 10);
  };
  TourPlannerOptions options;
  options.distance = 2.5;
  check(TsgaPlanner(options));
  check(NnbPlanner(options));
  check(MakespanPlanner(options));
  check(CoverPlanner(options));
  check(TourPlanner<GreedyAllocator<>, KeepAllocation, MergeNearby, RatioUtility, UnknownInSight>(
      options));
}

TEST(clusters_gain_what_their_views_show) {
  StillMission still = in_hall(among_pillars);
  std::vector<Teammate> robots{{{still.free.free_start(Point3(-8, 0, 1.5)), 0.0}, true, {}}};
  const SurfaceSituation situation = still.situation(robots);
  const std::vector<IncompleteElement> elements(situation.goals.begin(), situation.goals.end());
  const ViewFrustum& frustum = situation.space().frustum;
  const VoxelStateMap& states = situation.belief.observed();
  std::vector<Viewpoint> views;
  for (const Configuration& q :
       {Configuration{Point3(-8.0, 2.0, 0.9), 0.0}, Configuration{Point3(-7.6, 2.3, 0.9), 0.1},
        Configuration{Point3(-2.0, 2.0, 0.9), kPi},
        Configuration{Point3(0.6, 0.6, 1.5), 0.0}})  // in a pillar
    views.push_back({.configuration = q, .targets = {}});
  std::vector<ViewpointCluster> clusters(3);
  clusters[0].views = {0, 1};
  clusters[1].views = {2};
  clusters[2].views = {3};  // shows nothing
  const auto gains = [&](auto gain) {
    gain({views, elements, frustum, situation}, clusters);
    std::vector<double> found;
    for (const ViewpointCluster& c : clusters) found.push_back(c.gain);
    return found;
  };
  const auto together = [](auto a, const auto& b) {
    a.insert(a.end(), b.begin(), b.end());
    std::sort(a.begin(), a.end());
    return static_cast<double>(std::unique(a.begin(), a.end()) - a.begin());
  };
  const auto expected = [&](const auto& g, double one) {
    const auto seen = seen_from_all(g, views);
    return std::vector<double>{one * together(seen[0], seen[1]),
                               one * static_cast<double>(seen[2].size()), 0.5 * one};
  };
  const auto check = [](const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) CHECK_NEAR(a[i], b[i], 1e-12);
    CHECK(a[0] > a[2] && a[1] > a[2]);
  };
  const double share = 1.0 / static_cast<double>(elements.size());
  ElementsInSight ending;
  ending.ends_at_unknown = true;
  check(gains(ElementsInSight{}),
        expected(IncompleteSurfaceGain(elements, states, frustum), share));
  check(
      gains(ending),
      expected(IncompleteSurfaceGain(elements, states, frustum, {.unknown_blocks = true}), share));
  check(gains(UnknownInSight{}), expected(UnknownVolumeGain(states, frustum), 0.027));
}

TEST(a_single_cluster_is_made_finer_for_a_team) {
  StillMission still = in_hall(among_pillars);
  const auto stops = [&](std::size_t least_clusters) {
    TourPlannerOptions options;
    options.distance = 2.5;
    options.clusters = {.radius = 50.0, .max_radius = 50.0};
    options.least_clusters = least_clusters;
    std::vector<Teammate> robots;
    for (const double x : {-8.0, 8.0})
      robots.push_back({{still.free.free_start(Point3(x, 0.0, 1.5)), 0.0}, true, {}});
    const Plan result = MakespanPlanner(options)(still.situation(robots));
    return std::pair(result.routes.at(0).size(), result.routes.at(1).size());
  };
  const auto [a, b] = stops(0);
  CHECK(std::min(a, b) == 0 && std::max(a, b) > 10);
  const auto [c, d] = stops(4);
  CHECK(std::min(c, d) > 3 && c + d == a + b);
}

TEST(paths_to_views_cost_their_stops_and_their_turns) {
  const Configuration a{Point3(0, 0, 1), 3.0}, b{Point3(0, 3, 1), -3.0}, c{Point3(0, 3, 1), 0.0};
  CHECK(StopDistance{}(a, c) == 3.0);
  const StopDistance d{.stop = 1.0, .turn = 2.0};
  CHECK(d(a, b) == 4.0);  // It turns by the smaller angle, and meanwhile.
  CHECK(std::abs(d(a, c) - (1.0 + 2.0 * 3.0)) < 1e-12 && d(a, c) == d(c, a));
  // Eight views close together: where only lengths count, the one robot beside them has them all.
  const auto stops_of_the_far_one = [](const StopDistance& cost) {
    std::vector<ConfigurationCluster<Configuration>> views;
    for (int i = 0; i < 8; ++i) views.push_back({{{Point3(0.3 * i, 0, 0), 0.0}}, 1.0});
    const std::vector<Configuration> starts{{Point3(0, -1, 0), 0.0}, {Point3(2, 5, 0), 0.0}};
    const ClusterGraph<Configuration, ExponentialUtility, StopDistance> graph(views, starts, {{}},
                                                                              cost);
    const ImproveAllocation<MakespanAndMean, TourShortness<LinKernighan>> improve;
    return improve(graph, MakespanAllocator{}(graph)).routes[1].size();
  };
  CHECK(stops_of_the_far_one({}) == 0);
  CHECK(stops_of_the_far_one({.stop = 5.0}) >= 2);
}

TEST(rolling_tours_end_where_the_roadmap_leads) {
  // Crumbs everywhere, and a body so small that it fits between where no row of voxel centres does.
  TsdfMap map({.voxel_size = 0.3});
  Random random(3);
  map_test::paint(map, {-16, -16, -8}, {16, 16, 8}, [&](const VoxelIndex&) {
    const double u = random.uniform();
    return u < 0.1 ? VoxelState::occupied : u < 0.2 ? VoxelState::unknown : VoxelState::empty;
  });
  const Box3 region(Point3(-4.5, -4.5, -2.2), Point3(4.5, 4.5, 2.2));
  StillMission still(map, {.radius = 0.2, .bounds = region, .margin = 0.1},
                     PinholeCamera::from_fov(1.0, 0.8, 160, 120, 0.1, 2.0), region);
  RollingTours planner;
  int stops = 0;
  while (stops < 150) {
    const Point3 p(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-2, 2));
    if (!still.free.is_free(p)) continue;
    const std::vector<Teammate> robots{{{p, 0.0}, true, {}}};
    const Plan result = planner(still.situation(robots));
    Point3 from = p;
    for (const Stop& stop : result.routes.at(0)) {
      CHECK(still.roadmap.query(from, stop.configuration.position).has_value());
      from = stop.configuration.position;
    }
    ++stops;
  }
}

TEST(frontiers_are_the_border_of_what_is_known_empty) {
  // Empty for x < 3 m, a wall at x = 3 m where y < 0, unknown behind either.
  TsdfMap map({.voxel_size = 0.2});
  map_test::paint(map, {0, -20, -10}, {19, 19, 9}, [](const VoxelIndex& v) {
    return v.x() < 15 ? VoxelState::empty : v.y() < 0 ? VoxelState::occupied : VoxelState::unknown;
  });
  VoxelStateMap states(map);
  Frontiers space({.max_views = 2});
  const Box3 region(Point3(0.1, -3.9, -1.9), Point3(9.9, 3.9, 1.9));
  space.update(states, region, 1.04);  // five voxels: 1 m
  CHECK_NEAR(space.edge(), 1.0, 1e-12);
  CHECK(space.size() == 4 * 4);  // of the layer at 3 to 4 m, where nothing stands before it
  for (std::size_t i = 0; i < space.size(); ++i) {
    CHECK_NEAR(space.center(i).x(), 3.5, 1e-12);
    CHECK(space.center(i).y() > 0.0 && region.contains(space.center(i)));
  }
  space.note_view(3);
  space.update(states, region, 1.0);
  CHECK(space.size() == 16);
  const Point3 given_up = space.center(3);
  space.note_view(3);
  space.update(states, region, 1.0);
  CHECK(space.size() == 15);
  for (std::size_t i = 0; i < space.size(); ++i) CHECK((space.center(i) - given_up).norm() > 0.5);
  space.update(states, Box3(), 1.0);
  CHECK(space.size() == 0);

  // Followed by the change it is what it would be found to be anew.
  Random random(4);
  Frontiers followed;
  const Box3 inner(Point3(0.1, -3.7, -1.7), Point3(9.7, 3.7, 1.7));
  for (int round = 0; round < 20; ++round) {
    for (int k = 0; k < 400; ++k)
      map_test::set_state(
          map,
          VoxelIndex(static_cast<int>(random.below(50)), static_cast<int>(random.below(40)) - 20,
                     static_cast<int>(random.below(20)) - 10),
          random.uniform(0.0, 1.0) < 0.7 ? VoxelState::empty : VoxelState::occupied);
    states.update(map);
    Frontiers anew;
    followed.update(states, inner, 0.6);
    anew.update(states, inner, 0.6);
    CHECK(followed.size() == anew.size() && followed.size() > 0);
    for (std::size_t i = 0; i < std::min(followed.size(), anew.size()); ++i)
      CHECK(followed.center(i) == anew.center(i));
    // Every cell there is, by the definition.
    std::size_t count = 0;
    const auto at = [&](int x, int y, int z) {
      return states(VoxelIndex(3 * x + 1, 3 * y + 1, 3 * z + 1));
    };
    for (int z = -10; z < 10; ++z)
      for (int y = -20; y < 20; ++y)
        for (int x = -2; x < 30; ++x) {
          const bool border =
              at(x - 1, y, z) == VoxelState::empty || at(x + 1, y, z) == VoxelState::empty ||
              at(x, y - 1, z) == VoxelState::empty || at(x, y + 1, z) == VoxelState::empty ||
              at(x, y, z - 1) == VoxelState::empty || at(x, y, z + 1) == VoxelState::empty;
          count += border && at(x, y, z) == VoxelState::unknown &&
                           inner.contains(Point3(x + 0.5, y + 0.5, z + 0.5) * 0.6)
                       ? 1
                       : 0;
        }
    CHECK(followed.size() == count);
  }
}
TEST(what_frontiers_held_tells_what_they_may_hold) {
  // Empty for x < 3 m, unknown behind; cells of 1 m, of which a layer at a time is opened.
  TsdfMap map({.voxel_size = 0.2});
  map_test::paint(map, {0, -20, -20}, {14, 19, 19},
                  [](const VoxelIndex&) { return VoxelState::empty; });
  VoxelStateMap states(map);
  Frontiers space({.prior_chance = 0.25, .prior_cells = 4.0});
  const Box3 region(Point3(0.1, -3.9, -3.9), Point3(9.9, 3.9, 3.9));
  const auto chance_at = [&](double z) {
    for (std::size_t i = 0; i < space.size(); ++i)
      if (std::abs(space.center(i).z() - z) < 0.1) return space.chance(i);
    return -1.0;
  };
  space.update(states, region, 1.0);
  for (std::size_t i = 0; i < space.size(); ++i) CHECK_NEAR(space.chance(i), 0.25, 1e-12);
  // The sky is empty; of the eight cells at z = -2.5 m three hold a voxel of surface, two of them
  // in their middle.
  map_test::paint(map, {15, -20, 10}, {19, 19, 14},
                  [](const VoxelIndex&) { return VoxelState::empty; });
  map_test::paint(map, {15, -20, -15}, {19, 19, -11}, [](const VoxelIndex& v) {
    const bool surface = v == VoxelIndex(17, -18, -13) || v == VoxelIndex(17, -3, -13) ||
                         v == VoxelIndex(19, 13, -11);
    return surface ? VoxelState::occupied : VoxelState::empty;
  });
  states.update(map);
  space.update(states, region, 1.0);
  for (const double z : {1.5, 2.5, 3.5}) CHECK_NEAR(chance_at(z), 1.0 / 12.0, 1e-12);
  for (const double z : {-3.5, -2.5, -1.5}) CHECK_NEAR(chance_at(z), 4.0 / 12.0, 1e-12);
  for (const double z : {-0.5, 0.5}) CHECK_NEAR(chance_at(z), 0.25, 1e-12);
  // What was near surface when it was opened does not count; told once, it holds for one update.
  for (const int side : {-20, -10}) {
    for (std::size_t i = 0; i < space.size(); ++i)
      if (side == -20 && space.center(i).z() < -3.0) space.note_near(i);
    map_test::paint(map, {15, side, -20}, {19, side + 9, -16},
                    [](const VoxelIndex&) { return VoxelState::empty; });
    states.update(map);
    space.update(states, region, 1.0);
    CHECK_NEAR(chance_at(-3.5), side == -20 ? 4.0 / 12.0 : 4.0 / 14.0, 1e-12);
  }
  // Asked again it is not counted again; another region starts anew.
  space.update(states, region, 1.0);
  CHECK_NEAR(chance_at(2.5), 1.0 / 12.0, 1e-12);
  space.update(states, Box3(Point3(0.1, -3.9, -3.9), Point3(9.8, 3.9, 3.9)), 1.0);
  CHECK_NEAR(chance_at(2.5), 0.25, 1e-12);
  CHECK_THROWS(Error, Frontiers({.prior_chance = 0.0}));
  CHECK_THROWS(Error, Frontiers({.prior_cells = 0.0}));
}
TEST(ledger_gives_up_after_so_many_views) {
  ViewLedger ledger({.max_views = 2, .max_failures = 2});
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), side = Eigen::Vector3d::UnitX();
  const VoxelIndex v(1, -2, 3), w(4, 5, 6);
  CHECK(!ledger.given_up(v) && ledger.fresh(v) && ledger.promises(v, up));
  ledger.viewed_in_vain(v, up);
  CHECK(!ledger.given_up(v) && !ledger.fresh(v));
  CHECK(!ledger.promises(v, (up + 0.3 * side).normalized()) && ledger.promises(v, side));
  ledger.viewed_in_vain(v, side);
  CHECK(ledger.reason(v) == LeftReason::seen_incomplete);
  const std::array<VoxelIndex, 3> one_place{w, VoxelIndex(5, 4, 6), VoxelIndex(4, 4, 7)};
  ledger.not_reached(one_place);  // one path that was not found, however many elements it led to
  CHECK(!ledger.given_up(w));
  ledger.not_reached(one_place);
  CHECK(ledger.reason(w) == LeftReason::unreachable);
  CHECK(!ledger.given_up({0, 0, 0}));
}

TEST(teammates_are_masked_and_nothing_else) {
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 80, 46, 0.5, 8.0);
  const Pose T_world_camera = Configuration{Point3(1, 2, 3), 0.4}.pose() * forward_camera_mount();
  const Point3 mate = T_world_camera * Point3(0.7, -0.3, 4.0);
  DepthImage image(camera.width, camera.height, 8.08F);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      // A wall at 6 m, and the teammate's ball of 0.5 m before it.
      const Eigen::Vector3d ray = camera.ray(u, v), c(0.7, -0.3, 4.0);
      const double a = ray.squaredNorm(), b = ray.dot(c), q = b * b - a * (c.squaredNorm() - 0.25);
      image(u, v) = static_cast<float>(q >= 0.0 ? (b - std::sqrt(q)) / a : 6.0);
    }
  const DepthImage before = image;
  const std::vector<Point3> mates{mate, T_world_camera * Point3(0, 0, -3.0)};
  mask_teammates(image, camera, T_world_camera, mates, 0.8);
  int masked = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const bool is_mate = before.depth[i] < 5.0F;
    CHECK((image.depth[i] == 0.0F) == is_mate);
    if (!is_mate) CHECK(image.depth[i] == before.depth[i]);
    masked += is_mate ? 1 : 0;
  }
  CHECK(masked > 20);
}
}  // namespace
