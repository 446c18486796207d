// SPDX-License-Identifier: MIT
#include <surfleet/motion/traffic_policy.hpp>

#include <functional>

#include <surfleet/core/random.hpp>
#include <surfleet/motion/kinematics.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;
using Free = std::function<bool(const Point3&, const Point3&)>;

struct Outcome {
  bool all_arrived = false;
  double nearest = 1e9;  // between centres
  double time = 0.0;
  double longest = 0.0;  // path of one robot
};

/// Robots of radius 1 that each want to go straight to their goals, every one with a policy of its
/// own, all deciding at once on what the others told before.
Outcome simulate(const std::vector<std::pair<Point3, Point3>>& trips, const Free& free,
                 double limit = 400.0) {
  enum class Phase { waiting, flying, aside };
  const std::size_t n = trips.size();
  std::vector<AerialMotion> robots;
  std::vector<TrafficPolicy> policies(n);
  std::vector<Phase> phase(n, Phase::waiting);
  std::vector<char> held(n, 0), done(n, 0);
  std::vector<Point3> aside(n);
  std::vector<double> length(n, 0.0);
  for (const auto& [start, goal] : trips) robots.emplace_back(Configuration{start, 0.0});
  Outcome out;
  const double dt = 0.2;
  const auto announce = [&](std::size_t i) {
    TrafficAgent a;
    a.id = static_cast<int>(i);
    a.position = robots[i].configuration().position;
    if (phase[i] != Phase::waiting || !robots[i].standing()) a.path = robots[i].remaining();
    a.idle = done[i] != 0;
    a.cornered = policies[i].cornered(out.time);
    a.held = held[i] && robots[i].standing();
    return a;
  };
  for (; out.time < limit; out.time += dt) {
    std::size_t arrived = 0;
    std::vector<TrafficAgent> agents;
    for (std::size_t i = 0; i < n; ++i) {
      const Point3 at = robots[i].configuration().position;
      const bool there = (at - trips[i].second).norm() < 0.05 && robots[i].standing();
      done[i] = done[i] || there;
      arrived += there ? 1 : 0;
      if (phase[i] == Phase::flying && robots[i].finished()) phase[i] = Phase::waiting;
      if (phase[i] == Phase::waiting && robots[i].standing() && !there) {
        robots[i].follow(std::vector<Point3>{at, trips[i].second}, 0.0);
        phase[i] = Phase::flying;
      }
    }
    for (std::size_t i = 0; i < n; ++i) agents.push_back(announce(i));
    if (arrived == n) {
      out.all_arrived = true;
      break;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Maneuver m = policies[i](agents[i], agents, free, out.time);
      const bool moving = phase[i] != Phase::waiting;
      switch (m.kind) {
        case Maneuver::Kind::none:
          if (held[i]) robots[i].resume();
          held[i] = 0;
          if (phase[i] == Phase::aside && robots[i].finished()) phase[i] = Phase::waiting;
          break;
        case Maneuver::Kind::stop:
          if (!moving) break;
          robots[i].stop();
          held[i] = 1;
          break;
        case Maneuver::Kind::step_aside:
          if (phase[i] == Phase::aside && !robots[i].finished() &&
              (m.target - aside[i]).norm() < 1.0) {
            const bool hold = policies[i].too_close(agents[i], agents) >= 0;
            if (hold && !held[i]) robots[i].stop();
            if (!hold && held[i]) robots[i].resume();
            held[i] = hold;
          } else if (!robots[i].standing()) {
            robots[i].stop();
            held[i] = moving;
          } else {
            robots[i].follow(std::vector<Point3>{agents[i].position, m.target}, 0.0);
            aside[i] = m.target;
            phase[i] = Phase::aside;
            held[i] = 0;
          }
      }
    }
    for (int k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        const Point3 before = robots[i].configuration().position;
        robots[i].advance(dt / 4);
        length[i] += (robots[i].configuration().position - before).norm();
      }
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j)
          out.nearest = std::min(
              out.nearest,
              (robots[i].configuration().position - robots[j].configuration().position).norm());
    }
  }
  out.longest = *std::max_element(length.begin(), length.end());
  return out;
}
const Free open_space = [](const Point3&, const Point3&) { return true; };
/// Centres stay in |y| ≤ w, |z| ≤ 0.2: a flat corridor.
Free corridor(double w) {
  return [w](const Point3&, const Point3& b) {
    return std::abs(b.y()) <= w && std::abs(b.z()) <= 0.2;
  };
}
void expect_good(const Outcome& o) {
  CHECK(o.all_arrived);
  CHECK(o.nearest >= 2.0);
}
}  // namespace

TEST(head_on_in_the_open_and_in_a_corridor) {
  const std::vector<std::pair<Point3, Point3>> trips{{{-10, 0, 0}, {10, 0, 0}},
                                                     {{10, 0.1, 0}, {-10, 0.1, 0}}};
  expect_good(simulate(trips, open_space));
  expect_good(simulate(trips, corridor(3.0)));
  const auto o = simulate(trips, corridor(3.0));
  CHECK(o.time < 60.0);  // 20 m at 0.6 m/s are 34 s
}

TEST(exactly_head_on) {
  expect_good(simulate({{{-10, 0, 0}, {10, 0, 0}}, {{10, 0, 0}, {-10, 0, 0}}}, open_space));
  expect_good(simulate({{{10, 0, 0}, {-10, 0, 0}}, {{-10, 0, 0}, {10, 0, 0}}}, corridor(2.7)));
}

TEST(crossing_at_right_angles) {
  const auto o = simulate({{{-10, 0, 0}, {10, 0, 0}}, {{0, -10, 0}, {0, 10, 0}}}, open_space);
  expect_good(o);
  CHECK(o.longest < 20.5);  // one waits, none leaves its path
  CHECK(o.time < 55.0);
}

TEST(the_junior_waits_no_sooner_than_it_has_to) {
  // Its path crosses the senior's 6 m ahead, when the senior will be there.
  TrafficAgent senior, junior;
  senior.position = {-6, 0, 0};
  senior.path = {senior.position, {6, 0, 0}};
  junior.id = 1;
  TrafficPolicy policy;
  const auto decide = [&](double before_the_crossing) {
    junior.position = {0, -before_the_crossing, 0};
    junior.path = {junior.position, {0, 6, 0}};
    return policy(junior, std::vector{senior, junior}, open_space, 0.0).kind;
  };
  CHECK(decide(6.0) == Maneuver::Kind::none);
  CHECK(decide(3.5) == Maneuver::Kind::none);
  CHECK(decide(2.7) == Maneuver::Kind::stop);        // bodies of 1 m and half a metre between them
  CHECK(decide(2.0) == Maneuver::Kind::step_aside);  // in the senior's way
}

TEST(five_meet_in_a_point) {
  std::vector<std::pair<Point3, Point3>> trips;
  for (int i = 0; i < 5; ++i) {
    const double a = 2 * kPi * i / 5;
    const Point3 p(12 * std::cos(a), 12 * std::sin(a), 0);
    trips.emplace_back(p, -p);
  }
  expect_good(simulate(trips, open_space));
  expect_good(
      simulate(trips, [](const Point3&, const Point3& b) { return std::abs(b.z()) < 0.2; }));
}

TEST(random_traffic_in_a_plane) {
  Random random(12);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<std::pair<Point3, Point3>> trips;
    const auto draw = [&](bool goal) {
      for (;;) {
        const Point3 p(random.uniform(-12, 12), random.uniform(-12, 12), 0);
        bool apart = true;
        for (const auto& t : trips) apart = apart && ((goal ? t.second : t.first) - p).norm() > 3.5;
        if (apart) return p;
      }
    };
    for (int i = 0; i < 3 + trial % 3; ++i) {
      const Point3 start = draw(false), goal = draw(true);
      trips.emplace_back(start, goal);
    }
    expect_good(simulate(trips, [](const Point3&, const Point3& b) {
      return b.head<2>().cwiseAbs().maxCoeff() < 16 && std::abs(b.z()) < 0.2;
    }));
  }
}

TEST(an_idle_robot_gives_way_and_comes_back) {
  expect_good(simulate({{{-10, 0, 0}, {10, 0, 0}}, {{0, 0.2, 0}, {0, 0.2, 0}}}, open_space));
}

TEST(a_senior_yields_to_a_cornered_robot) {
  // The junior sits in a dead end; the senior wants in, and has a niche at x < −4 to go to.
  const Free slot = [](const Point3& a, const Point3& b) {
    for (int k = 0; k <= 40; ++k) {
      const Point3 p = a + (b - a) * (k / 40.0);
      if (std::abs(p.z()) > 0.2 || p.x() > 3.3 || (std::abs(p.y()) > 0.3 && p.x() > -4))
        return false;
    }
    return true;
  };
  TrafficPolicy policy;
  TrafficAgent junior{.id = 1, .position = {3, 0, 0}, .path = {{3, 0, 0}, {-10, 0, 0}}};
  const TrafficAgent senior{.id = 0, .position = {-5, 0, 0}, .path = {{-5, 0, 0}, {4, 0, 0}}};
  const std::vector<TrafficAgent> others{senior};
  CHECK(policy(junior, others, slot, 0.0).kind == Maneuver::Kind::stop);
  CHECK(policy.cornered(1.0));
  junior.cornered = true;
  TrafficPolicy theirs;
  const std::vector<TrafficAgent> seen{junior};
  const auto m = theirs(senior, seen, slot, 1.0);
  CHECK(m.kind == Maneuver::Kind::step_aside);
  CHECK(std::abs(m.target.y()) >= 2.4);
}

TEST(a_mate_not_heard_of_for_long_may_be_anywhere_along_its_path) {
  // 20 s ago it was at the origin, to fly 30 m along x at 0.6 m/s.
  TrafficAgent mate, self;
  mate.path = {mate.position, {30, 0, 0}};
  mate.age = 20.0;
  self.id = 1;
  TrafficPolicy policy;
  const auto decide = [&](const Point3& from, const Point3& to) {
    self.position = from;
    self.path = {from, to};
    CHECK((policy.too_close(self, std::vector{mate, self}) >= 0) <=
          (policy(self, std::vector{mate, self}, open_space, 0.0).kind != Maneuver::Kind::none));
    return policy(self, std::vector{mate, self}, open_space, 0.0).kind != Maneuver::Kind::none;
  };
  // Across its path where it may be by now, or soon; not behind it, nor far beside.
  CHECK(decide({11, 7.6, 0}, {11, -8, 0}) && decide({16, 7.6, 0}, {16, -8, 0}));
  CHECK(!decide({-8, 0, 0}, {-7.6, 8, 0}) && !decide({11, 20, 0}, {11, 12, 0}));
  // Whatever its age and its path, none comes nearer to it than when it stands there, or is there
  // after all.
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    mate.age = random.uniform(0.0, 40.0);
    mate.path = {mate.position, {random.uniform(0, 20), random.uniform(-5, 5), 0}};
    mate.path.push_back(mate.path.back() + Point3(random.uniform(-9, 9), random.uniform(0, 9), 0));
    const double flown = random.uniform(0.0, mate.speed * mate.age);
    const Point3 there = detail::point_along(mate.path, flown);
    CHECK(mate.distance(there) <= mate.extent() - mate.radius + 1e-9);
    CHECK(mate.extent() <= mate.radius + 5.0);
    self.position = {random.uniform(-15, 25), random.uniform(-15, 15), 0};
    self.path = {self.position, there};
    const double gap = (there - self.position).norm() - self.radius - mate.radius;
    if (gap < 0.5 && gap > 0.0) CHECK(policy.too_close(self, std::vector{mate, self}) >= 0);
  }
  // What is fresh is as it was.
  mate.age = 0.0;
  CHECK(mate.extent() == mate.radius && mate.places() == std::vector<Point3>{mate.position});
}

TEST(of_two_that_wait_for_each_other_one_goes) {
  TrafficAgent senior{.id = 0, .position = {0, 0, 0}, .path = {{0, 0, 0}, {2, 0, 0}}};
  TrafficAgent junior{.id = 1, .position = {2.3, 0, 0}, .path = {{2.3, 0, 0}, {0, 0, 0}}};
  senior.held = junior.held = true;
  const std::vector<TrafficAgent> both{senior, junior};
  const TrafficPolicy policy;
  CHECK(policy.too_close(senior, both) == -1);
  CHECK(policy.too_close(junior, both) == 0);
}

TEST(the_rule_above_all_keeps_robots_apart_on_crooked_paths) {
  // Nothing but `too_close` between two that fly about each other, corners cut, one after the
  // other deciding; or one of them stands.
  Random random(9);
  const auto crooked = [&](const Point3& from) {
    std::vector<Point3> path{from};
    for (int k = 0; k < 6; ++k)
      path.push_back(path.back() + Point3(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5),
                                          random.uniform(-0.5, 0.5)));
    return path;
  };
  const AerialLimits limits;
  const TrafficPolicy policy(
      {.least_gap = 0.05 + limits.corner_tolerance, .period = 0.25, .braking = limits.braking});
  double nearest = 1e9;
  for (int trial = 0; trial < 3000; ++trial) {
    const bool stands = trial % 2 == 0;
    std::vector<AerialMotion> robots;
    std::vector<TrafficAgent> agents(2);
    for (int r = 0; r < 2; ++r) {
      const Point3 start =
          r == 0 ? Point3::Zero() : Point3(2.5 * std::cos(trial), 2.5 * std::sin(trial), 0.0);
      robots.emplace_back(Configuration{start, 0.0}, limits);
      if (r == 1 || !stands) robots.back().follow(crooked(start), 0.0);
      agents[static_cast<std::size_t>(r)].id = r;
    }
    const auto announce = [&](std::size_t r) {
      agents[r].position = robots[r].configuration().position;
      agents[r].path = robots[r].remaining();
    };
    for (int step = 0; step < 60; ++step) {
      announce(0);
      announce(1);
      for (std::size_t r = 0; r < 2; ++r) {
        if (policy.too_close(agents[r], agents) >= 0)
          robots[r].stop();
        else
          robots[r].resume();
        robots[r].advance(0.25);
        announce(r);
      }
      nearest = std::min(nearest, (agents[0].position - agents[1].position).norm());
    }
  }
  CHECK(nearest >= 2.0);
  CHECK(nearest < 2.4);  // or nothing was put to the test
}

TEST(segment_distance_matches_sampling) {
  Random random(2);
  const auto draw = [&] {
    return Point3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (int i = 0; i < 200; ++i) {
    const Point3 a = draw(), b = i % 7 == 0 ? a : draw(), c = draw(),
                 d = i % 3 == 0   ? c
                     : i % 5 == 0 ? Point3(c + 0.5 * (b - a))
                                  : draw();
    double best = 1e9;
    for (int s = 0; s <= 60; ++s)
      for (int t = 0; t <= 60; ++t)
        best = std::min(best, (a + (b - a) * (s / 60.0) - c - (d - c) * (t / 60.0)).norm());
    const double got = detail::segment_distance(a, b, c, d);
    CHECK(got <= best + 1e-12);
    CHECK(got >= best - 0.05);
  }
}
