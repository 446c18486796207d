// SPDX-License-Identifier: MIT
// requires: cgal
// Triangle strips over meshes: their shortened paths against CGAL's exact geodesics, fields
// followed from many starts, and a tracked robot with a noisy pose. Prints JSON.
//
//   surface_strips [--seeds 20] [--first-seed 101] [--pairs 50]
#include <CGAL/Surface_mesh_shortest_path.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "cgal_mesh.hpp"
#include "support/stopwatch.hpp"
#include "surface_figures.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/coverage/covering_strip.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/steam_chest.hpp>
#include <surfleet/simulation/surfaces.hpp>
#include <surfleet/surface/drive_path.hpp>
#include <surfleet/surface/geodesic_strip.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
using Kernel = benchmarks::CgalKernel;
using Mesh = benchmarks::CgalMesh;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
using Exact = CGAL::Surface_mesh_shortest_path<Traits>;

/// A point as CGAL names it: weights from the source of its face's half-edge on.
Exact::Face_location location(const Mesh& other, const TriangleMesh& mesh, const SurfacePoint& at) {
  const Mesh::Face_index face(static_cast<unsigned>(at.triangle));
  const Mesh::Vertex_index first = other.source(other.halfedge(face));
  Eigen::Index k = 0;
  while (Mesh::Vertex_index(static_cast<unsigned>(
             mesh.triangles[static_cast<std::size_t>(at.triangle)][static_cast<std::size_t>(k)])) !=
         first)
    ++k;
  return {face, {at.weights[k], at.weights[(k + 1) % 3], at.weights[(k + 2) % 3]}};
}
void measure(const char* name, const TriangleMesh& mesh, const benchmarks::Seeds& seeds, int pairs,
             bool exact) {
  const SurfaceWalk walk(mesh);
  const GeodesicStrips strips(walk);
  const Mesh other = exact ? benchmarks::cgal_mesh(mesh) : Mesh();
  benchmarks::Figure ratio, query, field_ratio, squarely_ratio, rms, worst;
  std::size_t shared = 0, breaks = 0, left = 0, unreached = 0, drives = 0;
  for (int seed = 0; seed < seeds.count; ++seed) {
    Random random(seeds.first + static_cast<std::uint64_t>(seed));
    const SurfacePoint start = benchmarks::random_point(mesh, random);
    Exact solver(other);
    if (exact) solver.add_source_point(location(other, mesh, start));
    for (int k = 0; k < pairs; ++k) {
      const SurfacePoint goal = benchmarks::random_point(mesh, random);
      const auto begin = Clock::now();
      const auto path = strips(start, goal);
      query.add(1000.0 * (seconds_since(begin)));
      if (!path) {
        ++unreached;
        continue;
      }
      const double length = path->length();
      if (exact) {
        const auto at = location(other, mesh, goal);
        const double best = solver.shortest_distance_to_source_points(at.first, at.second).first;
        if (best > 0.0) ratio.add(length / best);
      }
      const StripField<> field(mesh, path->triangles, path->goal);
      const FieldDrive drive = follow_field(walk, field, path->start);
      shared += field.field.shared();
      breaks += field.field.breaks();
      left += drive.left_strip;
      unreached += drive.reached ? 0U : 1U;
      ++drives;
      const StripField<PerpendicularField> square(mesh, path->triangles, path->goal);
      const FieldDrive climbed = follow_field(walk, square, path->start);
      left += climbed.left_strip;
      unreached += climbed.reached ? 0U : 1U;
      ++drives;
      if (length > 0.2) {
        field_ratio.add(drive.length / length);
        squarely_ratio.add(climbed.length / length);
      }
      if (k % 10 != 0 || length < 0.2) continue;
      TrackOptions options;
      options.position_noise = 0.01;
      options.heading_noise = radians(1.0);
      options.seed = seeds.first + static_cast<std::uint64_t>(seed * pairs + k);
      const TrackedDrive tracked =
          track_path(walk, *path, FrontDriveBicycle{},
                     surface_pose(mesh, path->start, path->points[1] - path->points[0]), options);
      rms.add(100.0 * tracked.rms);
      worst.add(100.0 * tracked.worst);
    }
  }
  std::printf("{\"surface\": \"%s\", \"vertices\": %zu", name, mesh.vertices.size());
  ratio.print("taut_over_exact");
  query.print("query_ms");
  field_ratio.print("field_over_taut");
  squarely_ratio.print("perpendicular_over_taut");
  rms.print("tracking_rms_cm");
  worst.print("tracking_worst_cm");
  std::printf(
      ", \"drives\": %zu, \"left_strip\": %zu, \"unreached\": %zu, \"shared_share\": %.4f}", drives,
      left, unreached,
      static_cast<double>(shared) / static_cast<double>(std::max<std::size_t>(1, shared + breaks)));
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  cli::Options app("Triangle strips over meshes against exact geodesics. Prints JSON.");
  benchmarks::Seeds seeds;
  int pairs = 50;
  seeds.declare(app);
  app.add("--pairs", pairs, "starts and goals for each seed");
  app.parse(argc, argv);
  seeds.check();
  require(pairs >= 1, "--pairs: expected at least 1");
  std::printf("[");
  measure("bumpy slope, 50 mm", bumpy_slope({.edge = 0.05}), seeds, pairs, true);
  std::printf(",\n");
  measure("bumpy slope, 10 mm", bumpy_slope({.edge = 0.01}), seeds, pairs, true);
  std::printf(",\n");
  measure("torus", make_torus(Point3::Zero(), 1.0, 0.4, 96, 38), seeds, pairs, true);
  std::printf(",\n");
  measure("steam chest, 40 mm", clean_surface(steam_chest(0.04)), seeds, pairs, true);
  std::printf(",\n");
  measure("steam chest, 20 mm", clean_surface(steam_chest(0.02)), seeds, pairs, false);
  std::printf("]\n");
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return cli::run("surface_strips", [&] { return run(argc, argv); });
}
