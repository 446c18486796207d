// SPDX-License-Identifier: MIT
#include <surfleet/localization/p3p_kneip.hpp>
#include <surfleet/localization/p3p_lambda_twist.hpp>

#include <algorithm>

#include "check.hpp"
#include "scenes.hpp"

namespace {
using namespace surfleet;

struct Problem {
  Bearings3 bearings;
  Points3 points;
  Pose truth;
};
Problem random_problem(Random& random, double near = 0.1, double far = 10.0) {
  Problem problem;
  problem.truth = Pose::Identity();
  problem.truth.linear() = scenes::random_rotation(random);
  problem.truth.translation() = Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  for (std::size_t k = 0; k < 3; ++k) {
    problem.bearings[k] =
        Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 1.0).normalized();
    problem.points[k] = problem.truth.inverse() * (random.uniform(near, far) * problem.bearings[k]);
  }
  return problem;
}
bool contains(const P3pSolutions& solutions, const Pose& T, double tolerance = 1e-6) {
  return std::any_of(solutions.begin(), solutions.end(), [&](const Pose& found) {
    return (found.matrix() - T.matrix()).norm() < tolerance;
  });
}

/// Every solution shows the points along their bearings; the truth is among them.
template <P3pSolver Solver>
void solver_laws(const Solver& solver) {
  Random random(5);
  int missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const Problem problem = random_problem(random);
    const P3pSolutions solutions = solver(problem.bearings, problem.points);
    if (!contains(solutions, problem.truth)) ++missed;
    for (const Pose& T : solutions) {
      CHECK_NEAR((T.linear().transpose() * T.linear() - Eigen::Matrix3d::Identity()).norm(), 0.0,
                 1e-12);
      for (std::size_t k = 0; k < 3; ++k)
        CHECK_NEAR(((T * problem.points[k]).normalized() - problem.bearings[k]).norm(), 0.0, 1e-7);
    }
  }
  CHECK(missed <= 2);
  // Nothing from collinear or coinciding points.
  const Problem p = random_problem(random);
  const Point3 a = p.points[0], b = p.points[1];
  CHECK(solver(p.bearings, {a, b, 0.5 * (a + b)}).empty());
  CHECK(solver(p.bearings, {a, b, b}).empty());
  CHECK(solver({p.bearings[0], p.bearings[0], p.bearings[2]}, p.points).size() <= 4);
}

TEST(solvers_obey_the_laws) {
  solver_laws(LambdaTwistP3p{});
  solver_laws(KneipP3p{});
}
TEST(solvers_agree) {
  Random random(6);
  int disagree = 0;
  for (int i = 0; i < 20000; ++i) {
    const Problem p = random_problem(random);
    const auto a = LambdaTwistP3p{}(p.bearings, p.points), b = KneipP3p{}(p.bearings, p.points);
    for (const Pose& T : a)
      if (!contains(b, T, 1e-4)) ++disagree;
    for (const Pose& T : b)
      if (!contains(a, T, 1e-4)) ++disagree;
  }
  CHECK(disagree <= 10);  // pairs of solutions about to coincide
}
TEST(four_solutions_of_the_equilateral_triangle_are_found) {
  // From straight above its centre: the pose and three that are leaning.
  Points3 points;
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = 2.0 * kPi / 3.0 * static_cast<double>(k);
    points[k] = Point3(std::cos(a), std::sin(a), 0.0);
  }
  Bearings3 bearings;
  for (std::size_t k = 0; k < 3; ++k)
    bearings[k] = (points[k] + Eigen::Vector3d(0, 0, 2.0)).normalized();
  Pose T = Pose::Identity();
  T.translation().z() = 2.0;
  const auto twist = LambdaTwistP3p{}(bearings, points), kneip = KneipP3p{}(bearings, points);
  CHECK(contains(twist, T) && contains(kneip, T));
  CHECK(twist.size() == 4 && kneip.size() == 4);
}
TEST(on_the_danger_cylinder_a_pose_is_found_roughly) {
  // The camera stands on the cylinder through the points, where two solutions meet.
  Random random(7);
  int lambda = 0, kneip = 0;
  for (int i = 0; i < 200; ++i) {
    Points3 points;
    for (auto& p : points) {
      const double a = random.uniform(0, 2 * kPi);
      p = Point3(std::cos(a), std::sin(a), 0.0);
    }
    const double a = random.uniform(0, 2 * kPi);
    const Point3 camera(std::cos(a), std::sin(a), random.uniform(0.5, 2.0));
    Pose T = Pose::Identity();
    T.translation() = -camera;
    Bearings3 bearings;
    for (std::size_t k = 0; k < 3; ++k) bearings[k] = (T * points[k]).normalized();
    if (contains(LambdaTwistP3p{}(bearings, points), T, 1e-2)) ++lambda;
    if (contains(KneipP3p{}(bearings, points), T, 1e-2)) ++kneip;
  }
  CHECK(lambda >= 175 && kneip >= 190);
}
}  // namespace
