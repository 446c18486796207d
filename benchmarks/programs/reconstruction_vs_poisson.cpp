// SPDX-License-Identifier: MIT
// requires: cgal
// The steam chest from scans, by moving least squares and by Poisson reconstruction (CGAL's), of
// the same oriented points. Prints JSON.
//
//   reconstruction_vs_poisson [--seeds 10] [--first-seed 101] [--noise 0.018]
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "steam_chest_openings.hpp"
#include "support/scanned_surface.hpp"
#include "support/stopwatch.hpp"
#include "surface_figures.hpp"

#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_borders.hpp>
#include <surfleet/surface/moving_least_squares.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;

/// `detail` is the size of its triangles [m].
TriangleMesh by_poisson(const PointCloud& cloud, double detail) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Oriented = std::pair<Kernel::Point_3, Kernel::Vector_3>;
  std::vector<Oriented> points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Point3& p = cloud.points[i];
    const Eigen::Vector3f& n = cloud.normals[i];
    points.push_back({{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}});
  }
  CGAL::Surface_mesh<Kernel::Point_3> surface;
  CGAL::poisson_surface_reconstruction_delaunay(
      points.begin(), points.end(), CGAL::First_of_pair_property_map<Oriented>(),
      CGAL::Second_of_pair_property_map<Oriented>(), surface, detail);
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    Triangle t;
    int k = 0;
    for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface))
      t[k++] = static_cast<std::int32_t>(v.idx());
    mesh.triangles.push_back(t);
  }
  return mesh;
}

struct Judged {
  benchmarks::Figure error, missing, nonmanifold, time;
  std::vector<int> open;

  void add(const TriangleMesh& mesh, const TriangleMesh& truth, double seconds) {
    const scanned_surface::Errors errors(mesh, truth);
    error.add(100.0 * errors.to_truth.mean);
    missing.add(100.0 * errors.from_truth.percentile_95);
    nonmanifold.add(static_cast<double>(MeshAdjacency(mesh).non_manifold_edges().size()));
    time.add(seconds);
    open.push_back(benchmarks::steam_chest_openings(mesh, mesh_borders(mesh)));
  }
  void print(const char* method) const {
    std::printf("{\"reconstruction\": \"%s\", \"least_openings\": %d", method,
                *std::min_element(open.begin(), open.end()));
    error.print("mean_error_cm");
    missing.print("missing_p95_cm");
    nonmanifold.print("nonmanifold_edges");
    time.print("time_s");
    std::printf("}\n");
  }
};

int run(int argc, char** argv) {
  benchmarks::Seeds seeds;
  seeds.count = 10;
  double noise = 0.018;
  cli::Options app(
      "The steam chest from scans: moving least squares beside Poisson reconstruction. Prints "
      "JSON.");
  seeds.declare(app);
  app.add("--noise", noise, "along beams [m]");
  app.parse(argc, argv);
  seeds.check();
  require(noise >= 0.0, "--noise: expected 0 or more");
  Judged ours, poisson;
  for (int k = 0; k < seeds.count; ++k) {
    ScannedSurface s;
    s.scene = "steam_chest";
    s.noise = noise;
    s.edge = 0.02;
    s.seed = seeds.first + static_cast<std::uint64_t>(k);
    TriangleMesh truth;
    const MovingLeastSquares<> average = scanned_surface::averaging(s);
    const PointCloud cloud =
        oriented_cloud(scanned_surface::scans(s, truth), average.options.cloud);
    auto begin = Clock::now();
    const TriangleMesh averaged = average(cloud);
    ours.add(averaged, truth, seconds_since(begin));
    begin = Clock::now();
    const TriangleMesh filled = by_poisson(cloud, average.options.voxel);
    poisson.add(filled, truth, seconds_since(begin));
  }
  ours.print("moving least squares");
  poisson.print("Poisson");
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  return cli::run("reconstruction_vs_poisson", [&] { return run(argc, argv); });
}
