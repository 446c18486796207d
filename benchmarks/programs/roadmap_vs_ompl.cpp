// SPDX-License-Identifier: MIT
// requires: ompl
/// @file
/// @brief Our roadmap's queries against OMPL's LazyPRM* in the free space of the power plant's map.
///
///     roadmap_vs_ompl [PAIRS = 20] [SECONDS_FOR_OMPL = 1]
///
/// Both ask the same `FreeSpace` whether a segment is free. OMPL is given its time for every pair
/// anew, and its path is also measured after OMPL's own simplification. Ours answers the pairs one
/// after the other from one roadmap, the first one cold. Prints JSON.
#include <surfleet/core/random.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/simulation/mesh_map.hpp>
#include <surfleet/simulation/scenes.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/prm/LazyPRMstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace {
using namespace surfleet;
namespace ob = ompl::base;
namespace og = ompl::geometric;

Point3 point_of(const ob::State* s) {
  const auto* v = s->as<ob::RealVectorStateSpace::StateType>();
  return {v->values[0], v->values[1], v->values[2]};
}
class SegmentValidator : public ob::MotionValidator {
 public:
  SegmentValidator(const ob::SpaceInformationPtr& si, const FreeSpace& space)
      : ob::MotionValidator(si), space_(space) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return space_.is_free_segment(point_of(a), point_of(b));
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last) const override {
    const double length = (point_of(b) - point_of(a)).norm();
    const double free = space_.free_length(point_of(a), point_of(b));
    if (free >= length) return true;
    last.second = free / length;
    if (last.first != nullptr) si_->getStateSpace()->interpolate(a, b, last.second, last.first);
    return false;
  }

 private:
  const FreeSpace& space_;
};

struct OmplResult {
  double raw = -1.0, simplified = -1.0;
};
OmplResult plan(const FreeSpace& space, const Point3& a, const Point3& b, double seconds) {
  auto rv = std::make_shared<ob::RealVectorStateSpace>(3);
  ob::RealVectorBounds bounds(3);
  for (unsigned i = 0; i < 3; ++i) {
    bounds.setLow(i, space.options().bounds.min()[i]);
    bounds.setHigh(i, space.options().bounds.max()[i]);
  }
  rv->setBounds(bounds);
  og::SimpleSetup setup(rv);
  const auto si = setup.getSpaceInformation();
  setup.setStateValidityChecker([&](const ob::State* s) { return space.is_free(point_of(s)); });
  si->setMotionValidator(std::make_shared<SegmentValidator>(si, space));
  ob::ScopedState<> start(rv), goal(rv);
  for (unsigned i = 0; i < 3; ++i) {
    start[i] = a[i];
    goal[i] = b[i];
  }
  setup.setStartAndGoalStates(start, goal);
  setup.setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));
  setup.setPlanner(std::make_shared<og::LazyPRMstar>(si));
  OmplResult r;
  if (setup.solve(seconds) == ob::PlannerStatus::EXACT_SOLUTION) {
    r.raw = setup.getSolutionPath().length();
    setup.simplifySolution();
    r.simplified = setup.getSolutionPath().length();
  }
  return r;
}
}  // namespace

int main(int argc, char** argv) {
  const int pairs = argc > 1 ? std::atoi(argv[1]) : 20;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 1.0;
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(1);

  const Scene scene = scene_by_name("powerplant");
  const TsdfMap map = map_from_mesh(Bvh(scene.mesh), scene.bounds, 0.3);
  const VoxelStateMap states(map);
  const FreeSpace space(states, {.radius = 1.0, .bounds = scene.bounds});
  using Clock = std::chrono::steady_clock;
  const auto ms = [](auto d) { return std::chrono::duration<double, std::milli>(d).count(); };
  auto t = Clock::now();
  LazyPrmStar roadmap(space);
  const double build_ms = ms(Clock::now() - t);

  Random random(3);
  const auto draw = [&] {
    for (;;) {
      const Point3 p =
          scene.bounds.min() + Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform())
                                   .cwiseProduct(scene.bounds.sizes());
      // Not inside a tank, which is as empty as the rest.
      if (space.is_free(p) && roadmap.reachable(scene.station.position, p)) return p;
    }
  };
  double ratio_raw = 0.0, ratio_simplified = 0.0, mean_ms = 0.0, cpu_ms = 0.0, worst_ms = 0.0,
         worst_ratio = 0.0;
  int compared = 0, ours_only = 0, theirs_only = 0;
  for (int i = 0; i < pairs;) {
    const Point3 a = draw(), b = draw();
    // Pairs in sight of each other are no test.
    if (space.is_free_segment(a, b) || !roadmap.reachable(a, b)) continue;
    ++i;
    t = Clock::now();
    const std::clock_t cpu = std::clock();
    const auto path = roadmap.query(a, b);
    cpu_ms += 1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / pairs;
    const double took = ms(Clock::now() - t);
    mean_ms += took / pairs;
    worst_ms = std::max(worst_ms, took);
    const OmplResult theirs = plan(space, a, b, seconds);
    if (path && theirs.raw > 0.0) {
      ++compared;
      ratio_raw += path->length / theirs.raw;
      ratio_simplified += path->length / theirs.simplified;
      worst_ratio = std::max(worst_ratio, path->length / theirs.raw);
    } else {
      ours_only += path ? 1 : 0;
      theirs_only += theirs.raw > 0.0 ? 1 : 0;
    }
  }
  const double n = std::max(compared, 1);
  std::printf(
      "{\n  \"pairs\": %d,\n  \"compared\": %d,\n  \"found_by_us_alone\": %d,\n"
      "  \"found_by_ompl_alone\": %d,\n  \"ompl_seconds\": %.3f,\n"
      "  \"length_over_ompl\": %.4f,\n  \"length_over_ompl_worst\": %.4f,\n"
      "  \"length_over_ompl_simplified\": %.4f,\n  \"query_ms_mean\": %.3f,\n  "
      "\"query_cpu_ms_mean\": %.3f,\n"
      "  \"query_ms_worst\": %.3f,\n  \"roadmap_build_ms\": %.3f,\n  \"roadmap_nodes\": %zu\n}\n",
      pairs, compared, ours_only, theirs_only, seconds, ratio_raw / n, worst_ratio,
      ratio_simplified / n, mean_ms, cpu_ms, worst_ms, build_ms, roadmap.size());
  return theirs_only == 0 ? 0 : 1;
}
