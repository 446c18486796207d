// SPDX-License-Identifier: MIT
/// @file
/// @brief Occupancy of voxels from depth images and scans [002 ch. 2 §3.2].
///
///     OccupancyMap map{{.voxel_size = 0.1}};
///     OccupancyIntegrator integrate;
///     integrate(scan, lidar, T_world_lidar, map);
///     VoxelStateMap states(map);  // for free space, views and incomplete surface
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/mapping/occupancy_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet {
/// The inverse sensor model, and bounds by which what was learned can be unlearned; probabilities
/// of being occupied, as Hornung et al. 2013 have them.
struct OccupancyOptions {
  double hit = 0.7;        ///< Of a voxel that a ray ends in; more than 0.5.
  double miss = 0.4;       ///< Of one that rays pass alone; less than 0.5.
  double lowest = 0.1192;  ///< No voxel is less likely occupied.
  double highest = 0.971;  ///< Nor more.
};

/// Folds readings into a map of log odds. A reading tells of every voxel once: a hit where any ray
/// ends, else a miss where any passes, whatever their order and number. Rays beyond the sensor's
/// range pass up to it; measurements below its least range, and none, tell nothing.
/// O(voxels on all rays).
class OccupancyIntegrator {
 public:
  /// Throws `Error` unless the probabilities are on their sides of 0.5, within (0, 1).
  explicit OccupancyIntegrator(const OccupancyOptions& o = {})
      : hit_(log_odds(o.hit)),
        miss_(log_odds(o.miss)),
        lowest_(log_odds(o.lowest)),
        highest_(log_odds(o.highest)) {
    require(hit_ > 0.0F && highest_ > 0.0F && std::isfinite(hit_) && std::isfinite(highest_),
            "occupancy: expected hits and the highest probability in (0.5, 1)");
    require(miss_ < 0.0F && lowest_ < 0.0F && std::isfinite(miss_) && std::isfinite(lowest_),
            "occupancy: expected misses and the lowest probability in (0, 0.5)");
  }

  /// Returns the number of blocks that changed. Throws `Error` for a ray out of the grid.
  std::size_t operator()(const DepthImage& image, const PinholeCamera& camera,
                         const Pose& T_world_camera, OccupancyMap& map) {
    const auto width = static_cast<std::size_t>(image.width);
    begin(map);
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
      const auto depth = static_cast<double>(image.depth[i]);
      if (!DepthImage::is_measurement(image.depth[i]) || depth < camera.min_range) continue;
      const Eigen::Vector3d ray =
          camera.ray(static_cast<double>(i % width), static_cast<double>(i / width));
      trace(T_world_camera, std::min(depth, camera.max_range) * ray, depth <= camera.max_range);
    }
    return end(map);
  }
  std::size_t operator()(const LidarScan& scan, const LidarModel& lidar, const Pose& T_world_lidar,
                         OccupancyMap& map) {
    begin(map);
    for (const Point3& p : scan.points) {
      const double range = p.norm();
      if (!(std::isfinite(range) && range >= lidar.min_range)) continue;
      const bool hit = range <= lidar.max_range;
      trace(T_world_lidar, hit ? p : Point3(p * (lidar.max_range / range)), hit);
    }
    return end(map);
  }

 private:
  enum Mark : std::uint8_t { kPassed = 1, kHit = 2 };
  using Marks = VoxelGrid<std::uint8_t, OccupancyMap::kBlockSide>;

  static float log_odds(double probability) {
    return static_cast<float>(std::log(probability / (1.0 - probability)));
  }
  void begin(const OccupancyMap& map) { marks_ = Marks({.voxel_size = map.voxel_size()}); }
  /// `p` in the sensor's frame; the voxel that holds it is not passed.
  void trace(const Pose& T_world_sensor, const Point3& p, bool hit) {
    const Point3 from = T_world_sensor.translation(), to = T_world_sensor * p;
    static_cast<void>(marks_.index_of(from));  // Within the grid, or refused.
    const VoxelIndex last = marks_.index_of(to);
    Marks::Writer write(marks_);
    traverse_voxels(from, to, marks_.voxel_size(), [&](const VoxelIndex& v) {
      if (v == last) return false;
      std::uint8_t& mark = write.ensure(v);
      mark = static_cast<std::uint8_t>(mark | kPassed);
      return true;
    });
    if (hit) write.ensure(last) = kHit | kPassed;
  }
  std::size_t end(OccupancyMap& map) const {
    std::size_t changed = 0;
    marks_.for_each_block([&](const Marks::Block& marks) {
      const std::uint32_t slot = map.ensure_slot(marks.index);
      OccupancyMap::Block& block = map.block(slot);
      bool any = false;
      for (std::size_t i = 0; i < marks.voxels.size(); ++i) {
        if (marks.voxels[i] == 0) continue;
        OccupancyVoxel& v = block.voxels[i];
        const float before = v.log_odds;
        const float by = (marks.voxels[i] & kHit) != 0 ? hit_ : miss_;
        v.log_odds = std::clamp(v.log_odds + by, lowest_, highest_);
        any = any || !v.observed || v.log_odds != before;
        v.observed = true;
      }
      if (!any) return;
      map.mark_changed(slot);
      ++changed;
    });
    return changed;
  }

  float hit_, miss_, lowest_, highest_;
  Marks marks_{{.voxel_size = 1.0}};  // of the reading under way
};
}  // namespace surfleet
