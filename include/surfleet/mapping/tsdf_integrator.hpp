// SPDX-License-Identifier: MIT
/// @file
/// @brief Folds depth images and laser scans into a TSDF map.
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/mapping/projective_update.hpp>
#include <surfleet/mapping/ray_traversal_update.hpp>
#include <surfleet/mapping/update_policy.hpp>

namespace surfleet {
/// Builds a TSDF map observation by observation [000 §1.3.3, §2.4.1].
///
/// ```cpp
/// TsdfMap map{{.voxel_size = 0.3}};
/// TsdfIntegrator<InverseSquareWeight, ProjectiveUpdate> integrate{{.truncation = 0.9}};
/// integrate(image, camera, T_world_camera, map);
/// ```
/// A voxel is the weighted mean of what was observed of it: φ ← (w φ + Δw φ′) / (w + Δw),
/// w ← min(w + Δw, max_weight). The map is the same, bit by bit, for any number of threads. Throws
/// `Error` on settings, images, ranges or poses out of bounds, before the map is touched; a scan
/// that reaches out of the grid's 2^30 voxels a side may be found out half way.
template <WeightPolicy Weight = InverseSquareWeight, UpdatePolicy Update = ProjectiveUpdate>
class TsdfIntegrator {
 public:
  TsdfOptions options;
  [[no_unique_address]] Weight weight;
  Update update;

  explicit TsdfIntegrator(TsdfOptions o = {}, Weight w = {}, Update u = {})
      : options(o), weight(std::move(w)), update(std::move(u)) {
    detail::check_options(options);
  }

  /// Folds a depth image; returns the number of changed blocks.
  std::size_t operator()(const DepthImage& image, const PinholeCamera& camera,
                         const Pose& T_world_camera, TsdfMap& map) {
    const DepthObservation o{image, camera, T_world_camera};
    detail::check_options(options);
    detail::check_observation(o);
    return update(o, weight, options, map);
  }

  /// Folds points seen from the sensor's origin, in its frame; ranges are distances [m].
  std::size_t operator()(std::span<const Point3> points_sensor, double min_range, double max_range,
                         const Pose& T_world_sensor, TsdfMap& map) {
    const ScanObservation o{points_sensor, min_range, max_range, T_world_sensor};
    detail::check_options(options);
    detail::check_observation(o);
    return update(o, weight, options, map);
  }
  std::size_t operator()(const PointCloud& cloud_sensor, double min_range, double max_range,
                         const Pose& T_world_sensor, TsdfMap& map) {
    return (*this)(std::span<const Point3>(cloud_sensor.points), min_range, max_range,
                   T_world_sensor, map);
  }
};
}  // namespace surfleet
