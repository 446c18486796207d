// SPDX-License-Identifier: MIT
/// @file
/// @brief What a TSDF integrator is told and what it asks of its voxel update.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/weight_policy.hpp>

namespace surfleet {
struct TsdfOptions {
  double truncation = 0.9;     ///< µ: distances are cut to [−µ, µ] [m]; three voxels is usual.
  double max_weight = 1000.0;  ///< A voxel's weight grows up to this.
  bool carve_free_space = true;    ///< Write +µ along the ray before the surface.
  bool carve_beyond_range = true;  ///< A finite reading beyond the range carves up to the range.
  double max_slope = 6.0;          ///< Tangent of the steepest incidence at which neighbouring
                                   ///< pixels count as one surface and are interpolated.
  bool keep_hits = true;  ///< Keep where rays ended beside the distances: thin things need it.
  int threads = 1;        ///< The result is the same for any number.
};

/// A depth image with the camera that took it.
struct DepthObservation {
  const DepthImage& image;
  const PinholeCamera& camera;
  Pose T_world_camera;
};

/// Points of one scan, all seen from the sensor's origin. Non-finite points are no measurement.
struct ScanObservation {
  std::span<const Point3> points;  ///< Sensor frame [m].
  double min_range = 0.0;          ///< Nearer points are no measurement [m].
  double max_range = 0.0;          ///< Farther points say that nothing was met up to here [m].
  Pose T_world_sensor;
};

/// How observations reach the voxels.
///
/// `update(observation, weight, options, map)` folds an observation into `map`, marks the blocks
/// that changed, makes no block it does not write, and returns the number of changed blocks. A
/// voxel takes at most one observation from an image or a scan.
template <typename U>
concept UpdatePolicy = std::movable<U> &&
    requires(U& update, const DepthObservation& depth, const ScanObservation& scan,
             const TsdfOptions& options, const ConstantWeight& weight, TsdfMap& map) {
  { update(depth, weight, options, map) } -> std::convertible_to<std::size_t>;
  { update(scan, weight, options, map) } -> std::convertible_to<std::size_t>;
};

namespace detail {
inline void check_pose(const Pose& pose) {
  require(pose.matrix().allFinite(), "sensor pose: expected finite numbers");
}
inline void check_options(const TsdfOptions& o) {
  require(o.truncation > 0.0 && std::isfinite(o.truncation),
          "truncation " + std::to_string(o.truncation) + " m: expected a positive length");
  require(o.max_weight > 0.0 && o.max_weight <= 1e30, "maximum weight: expected (0, 1e30]");
}
inline void check_observation(const DepthObservation& o) {
  check_pose(o.T_world_camera);
  const PinholeCamera& c = o.camera;
  require(c.width > 0 && c.height > 0 && o.image.width == c.width && o.image.height == c.height &&
              o.image.depth.size() ==
                  static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height),
          "depth image of " + std::to_string(o.image.width) + " x " +
              std::to_string(o.image.height) + " pixels: expected the camera's " +
              std::to_string(c.width) + " x " + std::to_string(c.height));
  require(c.fx > 0.0 && c.fy > 0.0 && std::isfinite(c.fx + c.fy + c.cx + c.cy),
          "camera: expected positive focal lengths and a finite principal point");
  require_range(c.min_range, c.max_range, "camera");
}
inline void check_observation(const ScanObservation& o) {
  check_pose(o.T_world_sensor);
  require_range(o.min_range, o.max_range, "scan");
}

/// Folds one observation into a voxel; true if the voxel changed.
inline bool fuse(TsdfVoxel& voxel, float sdf, float weight, float max_weight) {
  if (!(weight > 0.0F)) return false;
  const TsdfVoxel before = voxel;
  voxel.distance += (sdf - voxel.distance) * (weight / (voxel.weight + weight));
  voxel.weight = std::min(voxel.weight + weight, max_weight);
  return voxel.distance != before.distance || voxel.weight != before.weight;
}
}  // namespace detail
}  // namespace surfleet
