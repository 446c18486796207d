// SPDX-License-Identifier: MIT
#include <surfleet/simulation/agreeing_judges.hpp>
#include <surfleet/simulation/judge.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// The bare concept: the distance to a plane z = 0.
struct ArchetypeDistance {
  double distance(const Point3& p) const { return std::abs(p.z()); }
};
static_assert(DistanceJudge<ArchetypeDistance> && !DistanceJudge<int>);
}  // namespace

TEST(judge_sees_what_happens_between_the_instants) {
  const Bvh post(make_cylinder({0, 0, -5}, {0, 0, 5}, 0.2, 64));
  Judge judge(post, 1.0);
  judge.observe(std::vector<Point3>{{-10, 1.1, 0}});
  judge.observe(std::vector<Point3>{{10, 1.1, 0}});  // hull overlaps the post by 0.1 in passing
  CHECK(judge.report().collisions_with_scene == 1);
  CHECK_NEAR(judge.report().min_clearance_m, -0.1, 2e-3);
  judge.observe(std::vector<Point3>{{10, 5, 0}});
  judge.observe(std::vector<Point3>{{-10, 5, 0}});
  CHECK(judge.report().collisions == 1);
  judge.observe(std::vector<Point3>{{-10, 1.15, 0}});
  judge.observe(std::vector<Point3>{{10, 1.15, 0}});
  CHECK(judge.report().collisions == 2);
  CHECK_NEAR(judge.report().min_distance_m, 0.9, 2e-3);
}

TEST(judge_counts_an_overlap_once) {
  const ArchetypeDistance ground;
  Judge judge(ground, 0.5);
  for (const double z : {2.0, 0.4, 0.3, 0.2, 2.0, 3.0, 0.4, 3.0})
    judge.observe(std::vector<Point3>{{z, 0, z}});
  CHECK(judge.report().collisions_with_scene == 2 && judge.report().collisions == 2);
  CHECK_NEAR(judge.report().min_clearance_m, -0.3, 1e-9);
  CHECK(judge.report().min_separation_m == JudgeReport::kNone);
}

TEST(judge_watches_robots_against_each_other) {
  const ArchetypeDistance ground;
  const std::vector<std::vector<Point3>> crossing{
      {{-5, 0, 9}, {5, 0, 9}}, {{5, 1.5, 9}, {-5, 1.5, 9}}, {{0, 9, 9}, {0, 9, 9}}};
  const JudgeReport report = judge_paths(ground, crossing, 1.0);
  CHECK(report.collisions_of_robots == 1 && report.collisions_with_scene == 0);
  CHECK_NEAR(report.min_separation_m, -0.5, 1e-9);
  CHECK_NEAR(report.min_clearance_m, 8.0, 1e-9);
  // The same lines at other times do not meet.
  const std::vector<std::vector<Point3>> waiting{{{-5, 0, 9}, {5, 0, 9}, {5, 0, 9}},
                                                 {{5, 9, 9}, {5, 9, 9}, {-5, 9, 9}}};
  CHECK(judge_paths(ground, waiting, 1.0).collisions == 0);
}

TEST(judge_agrees_with_dense_sampling) {
  const Bvh bvh(make_torus({0, 0, 0}, 3.0, 0.8));
  Random random(11);
  for (int i = 0; i < 60; ++i) {
    const auto draw = [&] {
      return Point3(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-3, 3));
    };
    const Point3 a = draw(), b = draw();
    double least = 1e9;
    for (int k = 0; k <= 2000; ++k) least = std::min(least, bvh.distance(a + (b - a) * k / 2000.0));
    const JudgeReport report = judge_paths(bvh, std::vector<std::vector<Point3>>{{a, b}}, 0.05);
    CHECK_NEAR(report.min_distance_m, least, 5e-3);
  }
}

TEST(a_robot_that_is_gone_is_not_in_the_way) {
  const ArchetypeDistance ground;
  std::vector<std::vector<Point3>> paths{{{0, 0, 5}, {10, 0, 5}, {20, 0, 5}},
                                         {{20, 0, 5}, {20, 0, 5}, {20, 0, 5}}};
  CHECK(judge_paths(ground, paths, 1.0).collisions_of_robots == 1);
  paths[1].back() = Point3::Constant(JudgeReport::kNone);
  CHECK(judge_paths(ground, paths, 1.0).collisions == 0);
  std::swap(paths[0], paths[1]);
  CHECK(judge_paths(ground, paths, 1.0).collisions == 0);
}

TEST(judge_refuses_nonsense) {
  const ArchetypeDistance ground;
  CHECK_THROWS(Error, Judge(ground, 0.0));
  Judge judge(ground, 1.0);
  judge.observe(std::vector<Point3>{{0, 0, 5}});
  CHECK_THROWS(Error, judge.observe(std::vector<Point3>{{0, 0, 5}, {9, 9, 9}}));
  const std::vector<std::vector<Point3>> uneven{{{0, 0, 1}}, {}};
  CHECK_THROWS(Error, judge_paths(ground, uneven, 1.0));
  CHECK(judge_paths(ground, {}, 1.0).collisions == 0);
}

TEST(judge_of_keep_out_boxes) {
  const KeepOut closed{
      {Box3(Point3(0, -1, -1), Point3(2, 1, 1)), Box3(Point3(9, 9, 9), Point3(10, 10, 10))}};
  static_assert(DistanceJudge<KeepOut>);
  CHECK(closed.distance({1, 0, 0}) == 0.0 && KeepOut{}.distance({1, 0, 0}) == JudgeReport::kNone);
  CHECK_NEAR(closed.distance({3, 2, 0}), std::sqrt(2.0), 1e-12);
  const auto flown = [&](double y) {
    return judge_paths(closed, std::vector<std::vector<Point3>>{{{-5, y, 0}, {5, y, 0}}}, 0.5)
        .collisions;
  };
  CHECK(flown(0.0) == 1 && flown(1.4) == 1 && flown(1.6) == 0);
}

TEST(two_judges_agree_or_say_so) {
  struct Off {
    double by;
    double distance(const Point3& p) const { return std::abs(p.z()) + (p.x() > 0.0 ? by : 0.0); }
  };
  const Off true_one{0.0}, near_one{5e-4}, high{0.3}, low{-0.2};
  const std::vector<std::vector<Point3>> path{{{-3, 0, 2}, {-1, 0, 1.1}, {1, 0, 1.1}, {3, 0, 2}}};
  const AgreeingJudges same(true_one, near_one);
  CHECK(judge_paths(same, path, 1.0).collisions == 0);
  CHECK(same.disagreements() == 0);
  CHECK_NEAR(same.largest_disagreement(), 5e-4, 1e-12);
  // Neither hides what the other sees, whichever is asked first.
  const AgreeingJudges a(true_one, low), b(low, true_one), c(true_one, high);
  CHECK(judge_paths(a, path, 1.0).collisions == 1 && judge_paths(b, path, 1.0).collisions == 1);
  CHECK(judge_paths(c, path, 1.0).collisions == 0);
  CHECK(a.disagreements() > 0 && b.disagreements() == a.disagreements() && c.disagreements() > 0);
  CHECK_NEAR(a.largest_disagreement(), 0.2, 1e-12);
  CHECK_NEAR(c.largest_disagreement(), 0.3, 1e-12);
  // Nothing to measure is no disagreement; one that gives no number is the largest.
  const Bvh nothing;
  const AgreeingJudges empty(nothing, nothing);
  CHECK(empty.distance({0, 0, 0}) == JudgeReport::kNone && empty.disagreements() == 0);
  const Off none{std::numeric_limits<double>::quiet_NaN()};
  const AgreeingJudges broken(none, true_one);
  CHECK_NEAR(broken.distance({1, 0, 2}), 2.0, 1e-12);
  CHECK(broken.disagreements() == 1 && std::isinf(broken.largest_disagreement()));
  CHECK_THROWS(Error, AgreeingJudges(true_one, low, 0.0));
}
TEST(a_robot_that_comes_from_nowhere_has_flown_no_line) {
  constexpr double kNone = JudgeReport::kNone;
  const Bvh post(make_cylinder({0, 0, -5}, {0, 0, 5}, 0.2, 64));
  const Point3 gone = Point3::Constant(kNone);
  const std::vector<std::vector<Point3>> set_down{{{-10, 0, 0}, gone, {10, 0, 0}, {10, 0, 0}},
                                                  {gone, gone, {4, 0, 0}, {9, 0, 0}}};
  const JudgeReport report = judge_paths(post, set_down, 1.0);
  CHECK(report.collisions_with_scene == 0 && report.collisions_of_robots == 1);
  CHECK_NEAR(report.min_clearance_m, 2.8, 1e-2);
}
