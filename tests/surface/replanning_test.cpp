// SPDX-License-Identifier: MIT
#include <surfleet/surface/strip_replanning.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;
constexpr double kBlocked = std::numeric_limits<double>::infinity();

SurfacePoint anywhere(const TriangleMesh& mesh, Random& random) {
  Eigen::Vector3d w(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
  return {static_cast<std::int32_t>(random.below(mesh.triangles.size())), w / w.sum()};
}
/// A strip's cost, added up piece by piece.
double cost_of(const StripSearch& graph, const std::vector<std::int32_t>& strip,
               const SurfacePoint& start, const SurfacePoint& goal) {
  if (strip.size() == 1) return graph.within_triangle(start, goal);
  std::vector<std::int32_t> nodes;
  for (std::size_t i = 0; i + 1 < strip.size(); ++i)
    for (std::int32_t k = 0; k < 3; ++k)
      if (graph.twin(3 * strip[i] + k) / 3 == strip[i + 1] && graph.twin(3 * strip[i] + k) >= 0)
        nodes.push_back(3 * strip[i] + k);
  if (nodes.size() + 1 != strip.size()) return -1.0;
  const TriangleMesh& mesh = graph.mesh();
  double cost = graph.factor(start.triangle) * (graph.at(nodes[0]) - start.position(mesh)).norm();
  for (std::size_t i = 1; i < nodes.size(); ++i) cost += graph.piece(nodes[i - 1], nodes[i]);
  return cost + graph.factor(goal.triangle) * (graph.at(nodes.back()) - goal.position(mesh)).norm();
}
void check_replanning(const TriangleMesh& mesh, const StripCosts& costs, StripNodes nodes,
                      std::uint64_t seed) {
  Random random(seed);
  const SurfacePoint goal = anywhere(mesh, random);
  StripReplanner plan(mesh, goal, costs, nodes);
  SurfacePoint at = anywhere(mesh, random);
  int found = 0, lost = 0;
  for (int round = 0; round < 30; ++round) {
    const auto strip = plan(at);
    const auto again = StripSearch(mesh, plan.graph().costs(), nodes)(at, goal);
    CHECK(strip.has_value() == again.has_value());
    ++(strip ? found : lost);
    if (strip && again) {
      CHECK_NEAR(strip->cost, again->cost, 1e-9 * (1.0 + again->cost));
      CHECK(strip->triangles.front() == at.triangle && strip->triangles.back() == goal.triangle);
      CHECK_NEAR(cost_of(plan.graph(), strip->triangles, at, goal), strip->cost,
                 1e-9 * (1.0 + strip->cost));
      // On along the strip, and now and then set down elsewhere.
      const std::size_t step = std::min<std::size_t>(3, strip->triangles.size() - 1);
      at = round % 7 == 6 ? anywhere(mesh, random) : SurfacePoint{strip->triangles[step]};
    } else {
      at = anywhere(mesh, random);
    }
    for (std::size_t k = 0; k < mesh.triangles.size() / 50 + 1; ++k) {
      const auto t = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
      const double u = random.uniform();
      plan.set_user_cost(t, u < 0.5 ? kBlocked : u < 0.8 ? 0.0 : 3.0 * random.uniform());
    }
    if (round % 5 == 4)  // freed again, the goal as well
      for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
        if (plan.graph().blocked(t)) plan.set_user_cost(t, 0.0);
  }
  CHECK(found > 15);
}
}  // namespace

TEST(replanned_strips_cost_what_new_ones_do) {
  const TriangleMesh torus = make_torus(Point3::Zero(), 1.0, 0.4, 30, 16);
  const TriangleMesh slope = bumpy_slope({.edge = 0.2, .hole = true});
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    check_replanning(torus, {}, StripNodes::centroids, seed);
    check_replanning(torus, {.curvature = 0.2, .turn = 0.1}, StripNodes::edge_midpoints, seed);
    check_replanning(slope, {.slope = 1.0}, StripNodes::centroids, seed);
    check_replanning(slope, {}, StripNodes::edge_midpoints, seed);
  }
}

TEST(replanning_ends_where_no_path_is) {
  const TriangleMesh plane = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 8, 8);
  const SurfacePoint start{0}, goal{static_cast<std::int32_t>(plane.triangles.size()) - 1};
  StripReplanner plan(plane, goal);
  CHECK(plan(start).has_value());
  CHECK(plan(goal)->triangles == std::vector<std::int32_t>{goal.triangle});
  plan.set_user_cost(goal.triangle, kBlocked);
  CHECK(!plan(start).has_value());
  plan.set_user_cost(goal.triangle, 50.0);  // as dear as that at its end
  CHECK_NEAR(plan(start)->cost, StripSearch(plane, plan.graph().costs())(start, goal)->cost, 1e-9);
  plan.set_user_cost(goal.triangle, 0.0);
  CHECK(plan(start).has_value());
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(plane.triangles.size()); ++t)
    if (t != start.triangle && t != goal.triangle) plan.set_user_cost(t, kBlocked);
  CHECK(!plan(start).has_value());
  CHECK_THROWS(Error, (plan.set_user_cost(-1, 0.0), 0));
  CHECK_THROWS(Error, (plan.set_user_cost(0, -1.0), 0));
}

TEST(replanning_far_from_the_goal_is_little_work) {
  const TriangleMesh plane = make_plane(Box2(Point2(0, 0), Point2(1, 1)), 0.0, 60, 60);
  const SurfacePoint start{0}, goal{static_cast<std::int32_t>(plane.triangles.size()) - 1};
  StripReplanner plan(plane, goal);
  const auto first = plan(start);
  plan.set_user_cost(first->triangles[5], kBlocked);
  const auto second = plan(start);
  CHECK(second->cost >= first->cost);
  CHECK(10 * second->expanded < first->expanded);
}
