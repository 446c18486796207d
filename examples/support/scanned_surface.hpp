// SPDX-License-Identifier: MIT
/// @file
/// @brief `surface_navigation --reconstruct`: scans of a scene, or a cloud in a file, made a mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/geometry/simplify.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>
#include <surfleet/surface/greedy_projection.hpp>
#include <surfleet/surface/moving_least_squares.hpp>
#include <surfleet/surface/scan_triangulation.hpp>

#include "stopwatch.hpp"
#include "surface_scene.hpp"

namespace surfleet::examples {
struct ScannedSurface {
  std::string scene, reconstruct = "none";
  std::optional<double> edge, spacing, support, voxel;  ///< [m]
  double noise = 0.0, outliers = 3.0;
  std::vector<double> scan_from;
  std::optional<int> faces;
  std::uint64_t seed = 1;
  int threads = 1;
};

namespace scanned_surface {
/// Places along the tubes of the steam chest, a quarter of a metre apart.
inline std::vector<Point3> steam_chest_stations() {
  std::vector<Point3> stations;
  for (const Tube& t : steam_chest_tubes()) {
    const int n = std::max(1, static_cast<int>(std::lround((t.b - t.a).norm() / 0.25)));
    for (int k = 0; k < n; ++k) stations.push_back(t.a + (k + 0.5) / n * (t.b - t.a));
  }
  return stations;
}

/// What is scanned from where: of a scene by a rotating lidar, of a file its points. `truth` is the
/// surface scanned, where there is one.
inline std::vector<Scan> scans(const ScannedSurface& s, TriangleMesh& truth) {
  require(s.scan_from.size() % 3 == 0, "--scan-from: expected three numbers for each scan");
  std::vector<Point3> stations;
  for (std::size_t k = 0; k + 2 < s.scan_from.size(); k += 3)
    stations.emplace_back(s.scan_from[k], s.scan_from[k + 1], s.scan_from[k + 2]);
  if (std::filesystem::path(s.scene).has_extension()) {
    try {
      truth = read_mesh(s.scene);
    } catch (const Error&) {  // no mesh: then what it says as a cloud
      const PointCloud cloud = read_point_cloud(s.scene);
      require(stations.size() <= 1, "--scan-from: expected one place of a cloud's sensor");
      std::vector<Scan> one(1);
      for (const std::size_t i : finite_points(cloud.points))
        one[0].points.push_back(cloud.points[i]);
      if (!stations.empty()) one[0].sensor = stations[0];
      return one;
    }
  } else {
    truth = surface_scene(s.scene, s.edge);
  }
  truth = clean_surface(truth);
  if (stations.empty() && s.scene == "steam_chest") stations = steam_chest_stations();
  require(!stations.empty(), "--reconstruct: expected --scan-from with it, places to scan from");
  const Bvh bvh(truth);
  std::vector<Scan> scans;
  RotatingLidar lidar;
  if (stations.size() > 1) {  // many scans need fewer beams each
    lidar.azimuths = 180;
    lidar.elevations = 91;
  }
  lidar.noise = s.noise;
  lidar.threads = s.threads;
  for (const Point3& station : stations) {
    Pose T = Pose::Identity();
    T.translation() = station;
    lidar.seed = mix64(s.seed) + scans.size();
    scans.push_back({lidar.scan(bvh, T).points, station});
  }
  return scans;
}

/// What averages many scans, with its cloud.
inline MovingLeastSquares<> averaging(const ScannedSurface& s) {
  MovingLeastSquares<> average;
  average.options.cloud = {.spacing = s.spacing.value_or(0.02),
                           .outliers = s.outliers,
                           .neighbors = 40,
                           .seed = s.seed,
                           .threads = s.threads};
  average.options.voxel = s.voxel.value_or(1.5 * average.options.cloud.spacing);
  average.options.support = s.support.value_or(4.0 * average.options.voxel);
  average.options.threads = s.threads;
  return average;
}
/// Distances between the triangles' centres of one and the other surface [m].
struct Errors {
  Summary to_truth, from_truth;
  Errors(const TriangleMesh& mesh, const TriangleMesh& truth) {
    const auto between = [](const TriangleMesh& a, const TriangleMesh& b) {
      const Bvh bvh(b);
      std::vector<double> distance;
      for (std::size_t t = 0; t < a.triangles.size(); ++t)
        distance.push_back(bvh.closest_point(a.centroid(t))->distance);
      return summarize(distance);
    };
    to_truth = between(mesh, truth);
    from_truth = between(truth, mesh);
  }
};
}  // namespace scanned_surface

/// The surface to drive on; what was scanned and how well the mesh agrees goes into `metrics`.
inline TriangleMesh scanned_surface_mesh(const ScannedSurface& s, nlohmann::json& metrics) {
  TriangleMesh mesh;
  if (s.reconstruct == "none") {
    mesh = surface_scene(s.scene, s.edge);
  } else {
    const auto begin = Clock::now();
    TriangleMesh truth;
    const std::vector<Scan> scans = scanned_surface::scans(s, truth);
    std::size_t points = 0;
    for (const Scan& scan : scans) points += scan.points.size();
    require(points >= 3, "--reconstruct: the scans have " + std::to_string(points) +
                             " points; expected three or more");
    const double scanned = seconds_since(begin);
    if (s.reconstruct == "itm") {
      require(scans.size() == 1,
              "--reconstruct itm: joins one scan's points; expected one place "
              "in --scan-from, or mls or ftm for many");
      mesh = ScanTriangulation{}(scans);
    } else if (s.reconstruct == "mls") {
      mesh = scanned_surface::averaging(s)(scans);
    } else {
      GreedyProjection reconstruct;
      // Points must lie apart by more than their noise before they are joined one by one.
      reconstruct.options.cloud = {.spacing = s.spacing.value_or(std::max(0.02, 3.0 * s.noise)),
                                   .outliers = s.outliers,
                                   .seed = s.seed,
                                   .threads = s.threads};
      mesh = reconstruct(scans);
    }
    require(!mesh.empty(), "--reconstruct: no triangle came of the points; expected denser scans");
    metrics["scans"] = scans.size();
    metrics["scan_points"] = points;
    metrics["reconstruction_time_s"] = seconds_since(begin) - scanned;
    if (!truth.empty()) {
      const scanned_surface::Errors error(mesh, truth);
      metrics["reconstruction_error_mean_m"] = error.to_truth.mean;
      metrics["reconstruction_error_p95_m"] = error.to_truth.percentile_95;
      metrics["reconstruction_missing_p95_m"] = error.from_truth.percentile_95;
    }
  }
  if (s.faces) {
    mesh = clean_surface(mesh);
    if (mesh.triangles.size() > static_cast<std::size_t>(*s.faces))
      mesh = simplified(mesh, {.triangles = static_cast<std::size_t>(*s.faces)});
  }
  return mesh;
}
}  // namespace surfleet::examples
