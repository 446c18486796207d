// SPDX-License-Identifier: MIT
// Meshes from scans of the steam chest, strips replanned among blocked triangles, strips that cover
// every piece once, and RRT* over clouds. Prints JSON.
//
//   surface_planning [--seeds 20] [--first-seed 101]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "steam_chest_openings.hpp"
#include "support/scanned_surface.hpp"
#include "support/stopwatch.hpp"
#include "surface_figures.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/geometry/mesh_borders.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/surface/geodesic_strip.hpp>
#include <surfleet/surface/single_strip.hpp>
#include <surfleet/surface/sparse_planner.hpp>
#include <surfleet/surface/strip_replanning.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
constexpr double kBlocked = std::numeric_limits<double>::infinity();

void reconstruction(const char* method, const benchmarks::Seeds& seeds) {
  benchmarks::Figure error, missing, others, nonmanifold, time;
  std::vector<double> open;
  for (int k = 0; k < seeds.count; ++k) {
    ScannedSurface s;
    s.scene = "steam_chest";
    s.reconstruct = method;
    s.noise = 0.018;
    s.edge = 0.02;
    s.seed = seeds.first + static_cast<std::uint64_t>(k);
    nlohmann::json metrics;
    const TriangleMesh mesh = scanned_surface_mesh(s, metrics);
    const auto parts = mesh_borders(mesh);
    error.add(100.0 * metrics["reconstruction_error_mean_m"].get<double>());
    missing.add(100.0 * metrics["reconstruction_missing_p95_m"].get<double>());
    time.add(metrics["reconstruction_time_s"].get<double>());
    open.push_back(benchmarks::steam_chest_openings(mesh, parts));
    others.add(static_cast<double>(parts.size()) - open.back());
    nonmanifold.add(static_cast<double>(MeshAdjacency(mesh).non_manifold_edges().size()));
  }
  std::printf("{\"reconstruction\": \"%s\", \"least_openings\": %.0f", method,
              *std::min_element(open.begin(), open.end()));
  error.print("mean_error_cm");
  missing.print("missing_p95_cm");
  others.print("other_borders");
  nonmanifold.print("nonmanifold_edges");
  time.print("time_s");
  std::printf("},\n");
  std::fflush(stdout);
}

/// A hundredth of the triangles blocked, anywhere or among the four hundredths about the robot.
void replanning(const char* name, const TriangleMesh& mesh, bool near,
                const benchmarks::Seeds& seeds) {
  std::vector<double> share;
  benchmarks::Figure again_ms, fresh_ms;
  int differ = 0;
  for (int k = 0; k < seeds.count; ++k) {
    Random random(seeds.first + static_cast<std::uint64_t>(k));
    const SurfacePoint start = benchmarks::random_point(mesh, random),
                       goal = benchmarks::random_point(mesh, random);
    StripReplanner plan(mesh, goal);
    const auto before = plan(start);
    if (!before) continue;
    const SurfacePoint at{
        before->triangles[std::min<std::size_t>(10, before->triangles.size() - 1)]};
    std::vector<std::pair<double, std::int32_t>> order;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      order.push_back({near ? (mesh.centroid(t) - at.position(mesh)).norm() : 0.0,
                       static_cast<std::int32_t>(t)});
    std::sort(order.begin(), order.end());
    const std::size_t count = mesh.triangles.size() / 100;
    const std::size_t among = near ? 4 * count : order.size();
    const auto begin = Clock::now();
    for (std::size_t b = 0; b < count; ++b) {
      const std::int32_t t = order[random.below(among)].second;
      if (t != at.triangle && t != goal.triangle) plan.set_user_cost(t, kBlocked);
    }
    const auto again = plan(at);
    const double spent = seconds_since(begin);
    const StripSearch search(mesh, plan.graph().costs());
    const auto scratch = Clock::now();
    const auto fresh = search(at, goal);
    const double whole = seconds_since(scratch);
    if (again.has_value() != fresh.has_value() ||
        (fresh && std::abs(again->cost - fresh->cost) > 1e-9 * (1.0 + fresh->cost)))
      ++differ;
    again_ms.add(1000.0 * spent);
    fresh_ms.add(1000.0 * whole);
  }
  double a = 0.0, f = 0.0;
  for (const double v : again_ms.values) a += v;
  for (const double v : fresh_ms.values) f += v;
  std::printf(
      "{\"replanning\": \"%s\", \"triangles\": %zu, \"costs_that_differ\": %d, "
      "\"time_over_scratch\": %.4f",
      name, mesh.triangles.size(), differ, a / f);
  again_ms.print("again_ms");
  fresh_ms.print("scratch_ms");
  std::printf("},\n");
}

void covering(const char* name, const TriangleMesh& mesh, const benchmarks::Seeds& seeds) {
  benchmarks::Figure split, places;
  std::vector<double> covered;
  for (int k = 0; k < seeds.count; ++k) {
    Random random(seeds.first + static_cast<std::uint64_t>(k));
    const auto start = static_cast<std::int32_t>(random.below(mesh.triangles.size()));
    const SingleStrip strip = single_strip(mesh, start);
    std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);
    for (const std::int32_t t : strip.triangles)
      seen[static_cast<std::size_t>(strip.source[static_cast<std::size_t>(t)])] = 1;
    const auto n = static_cast<double>(mesh.triangles.size());
    covered.push_back(static_cast<double>(std::count(seen.begin(), seen.end(), 1)) / n);
    split.add(static_cast<double>(strip.split) / n);
    places.add(static_cast<double>(strip.triangles.size()) /
               static_cast<double>(strip.mesh.triangles.size()));
  }
  std::printf("{\"covering\": \"%s\", \"triangles\": %zu, \"least_covered\": %.4f", name,
              mesh.triangles.size(), *std::min_element(covered.begin(), covered.end()));
  split.print("split_share");
  places.print("places_over_pieces");
  std::printf("},\n");
}

void tree(const char* name, const TriangleMesh& mesh, double density, bool last,
          const benchmarks::Seeds& seeds) {
  const Bvh bvh(mesh);
  const SurfaceWalk walk(mesh);
  const GeodesicStrips strips(walk);
  benchmarks::Figure ratio, time;
  int missed = 0;
  for (int k = 0; k < seeds.count; ++k) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(k);
    PointCloud cloud = sample_surface(mesh, {.density = density, .seed = seed}).cloud;
    cloud.normals = plane_normals(cloud.points);
    turn_consistently(cloud.points, 12, cloud.normals);
    SparsePlannerOptions options;
    options.seed = seed;
    const SparsePlanner plan(cloud, options);
    Random random(seed);
    for (int pair = 0; pair < 5; ++pair) {
      const auto a = static_cast<std::int32_t>(random.below(cloud.size())),
                 b = static_cast<std::int32_t>(random.below(cloud.size()));
      const auto begin = Clock::now();
      const auto path = plan(a, b);
      time.add(seconds_since(begin));
      if (!path) {
        ++missed;
        continue;
      }
      const auto from = nearest_surface_point(mesh, bvh, cloud.points[static_cast<std::size_t>(a)]),
                 to = nearest_surface_point(mesh, bvh, cloud.points[static_cast<std::size_t>(b)]);
      const auto shortest = strips(*from, *to);
      if (shortest && shortest->length() > 0.2) ratio.add(path->length / shortest->length());
    }
  }
  std::printf("{\"rrt_star\": \"%s\", \"missed\": %d", name, missed);
  ratio.print("over_taut");
  time.print("time_s");
  std::printf("}%s\n", last ? "]" : ",");
}

int run(int argc, char** argv) {
  cli::Options app(
      "Meshes from scans, strips replanned and single, and RRT* over clouds. Prints JSON.");
  benchmarks::Seeds seeds;
  seeds.declare(app);
  app.parse(argc, argv);
  seeds.check();
  std::printf("[");
  const TriangleMesh slope = bumpy_slope({.edge = 0.02}), chest = clean_surface(steam_chest(0.04));
  const TriangleMesh torus = make_torus(Point3::Zero(), 1.0, 0.4, 96, 38);
  replanning("slope, 20 mm, anywhere", slope, false, seeds);
  replanning("slope, 20 mm, about the robot", slope, true, seeds);
  replanning("steam chest, anywhere", chest, false, seeds);
  replanning("steam chest, about the robot", chest, true, seeds);
  covering("slope, 20 mm", slope, seeds);
  covering("slope with a hole, 50 mm", bumpy_slope({.edge = 0.05, .hole = true}), seeds);
  covering("torus", torus, seeds);
  covering("steam chest", chest, seeds);
  const benchmarks::Seeds few{seeds.first, std::min(seeds.count, 5)};
  reconstruction("mls", few);
  reconstruction("ftm", few);
  tree("slope", bumpy_slope({.edge = 0.05}), 3600.0, false, seeds);
  tree("tube with a hole", holed_tube(), 3600.0, false, seeds);
  tree("mock-up", mock_up(), 2000.0, true, seeds);
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return cli::run("surface_planning", [&] { return run(argc, argv); });
}
