// SPDX-License-Identifier: MIT
/// @file  Points worth seeing, and what a camera at a given place would see of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet {
/// A point of the surface, seen or predicted, that is worth a look.
struct SightTarget {
  Point3 position = Point3::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< Side to look at it from; zero if any.
  double worth = 0.0;                                ///< Area it stands for [m²].
  int unknown_before = 0;  ///< How many unknown voxels the line of sight may pass.
};

/// Headings are tried in steps of a turn's sixteenth.
constexpr int kHeadings = 16;
inline double heading_angle(int k) { return wrap_angle(2.0 * kPi * k / kHeadings); }

/// A target in view and the headings (as bits) from which it is.
struct Sighting {
  std::int32_t target = 0;
  std::uint16_t headings = 0;
};

struct TargetSightOptions {
  double max_distance = 0.0;   ///< Farthest useful look [m]; 0 stands for the camera's range.
  double max_incidence = 1.4;  ///< Greatest angle between the normal and the line of sight [rad].
};

/// Finds what is in view from a position, by a grid over the targets and a walk through the map
/// to each candidate. O(targets within range · voxels on the line).
class SightTargets {
 public:
  SightTargets(std::vector<SightTarget> targets, const VoxelStateMap& map,
               const PinholeCamera& camera, const Pose& T_body_camera,
               TargetSightOptions options = {})
      : targets_(std::move(targets)), map_(&map), camera_(&camera), options_(options) {
    if (options_.max_distance <= 0.0) options_.max_distance = camera.max_range;
    for (int k = 0; k < kHeadings; ++k) {
      const Eigen::AngleAxisd turn(heading_angle(k), Eigen::Vector3d::UnitZ());
      T_camera_world_[static_cast<std::size_t>(k)] = (Pose(turn) * T_body_camera).inverse();
    }
    cell_ = options_.max_distance;
    order_.resize(targets_.size());
    keys_.resize(targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) order_[i] = static_cast<std::int32_t>(i);
    for (std::size_t i = 0; i < targets_.size(); ++i) keys_[i] = cell_of(targets_[i].position);
    std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
      const auto ka = pack(keys_[static_cast<std::size_t>(a)]);
      const auto kb = pack(keys_[static_cast<std::size_t>(b)]);
      return ka != kb ? ka < kb : a < b;
    });
    for (const std::int32_t i : order_) packed_.push_back(pack(keys_[static_cast<std::size_t>(i)]));
  }

  std::size_t size() const { return targets_.size(); }
  const SightTarget& operator[](std::size_t i) const { return targets_[i]; }
  std::span<const SightTarget> all() const { return targets_; }

  /// The targets in view from `p`, in increasing order.
  std::vector<Sighting> seen_from(const Point3& p) const {
    std::vector<Sighting> seen;
    auto states = map_->accessor();
    const VoxelIndex c = cell_of(p);
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y) {
        // The three cells of a row are neighbours in the order.
        const auto low =
            std::lower_bound(packed_.begin(), packed_.end(), pack(c + VoxelIndex(-1, y, z)));
        const auto high = std::upper_bound(low, packed_.end(), pack(c + VoxelIndex(1, y, z)));
        for (auto it = low; it != high; ++it) {
          const std::int32_t id = order_[static_cast<std::size_t>(it - packed_.begin())];
          const std::uint16_t headings = headings_for(p, static_cast<std::size_t>(id));
          if (headings != 0 && in_sight(states, p, static_cast<std::size_t>(id)))
            seen.push_back({id, headings});
        }
      }
    std::sort(seen.begin(), seen.end(),
              [](const Sighting& a, const Sighting& b) { return a.target < b.target; });
    return seen;
  }

  /// An upper bound on what any one position can see.
  double most_in_view() const {
    double most = 0.0;
    for (std::size_t i = 0; i < packed_.size(); ++i) {
      if (i > 0 && packed_[i] == packed_[i - 1]) continue;
      const VoxelIndex c = keys_[static_cast<std::size_t>(order_[i])];
      double sum = 0.0;
      // A ball of one cell's radius about a point of cell c touches its 27 neighbours.
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y) {
          const auto low =
              std::lower_bound(packed_.begin(), packed_.end(), pack(c + VoxelIndex(-1, y, z)));
          const auto high = std::upper_bound(low, packed_.end(), pack(c + VoxelIndex(1, y, z)));
          for (auto it = low; it != high; ++it)
            sum += targets_[static_cast<std::size_t>(
                                order_[static_cast<std::size_t>(it - packed_.begin())])]
                       .worth;
        }
      most = std::max(most, sum);
    }
    return most;
  }

 private:
  VoxelIndex cell_of(const Point3& p) const { return (p / cell_).array().floor().cast<int>(); }
  static std::int64_t pack(const VoxelIndex& c) {
    constexpr std::int64_t bias = 1 << 20;
    return ((c.z() + bias) << 42) + ((c.y() + bias) << 21) + (c.x() + bias);
  }
  std::uint16_t headings_for(const Point3& p, std::size_t id) const {
    const SightTarget& t = targets_[id];
    const Eigen::Vector3d d = t.position - p;
    const double distance = d.norm();
    if (distance > options_.max_distance || distance < camera_->min_range) return 0;
    if (!t.normal.isZero() && -d.dot(t.normal) < distance * std::cos(options_.max_incidence))
      return 0;
    std::uint16_t headings = 0;
    for (std::size_t k = 0; k < kHeadings; ++k) {
      const Point3 q = T_camera_world_[k] * d;
      if (q.z() >= camera_->min_range && q.z() <= camera_->max_range &&
          camera_->project(q).has_value())
        headings = static_cast<std::uint16_t>(headings | (1U << k));
    }
    return headings;
  }
  bool in_sight(VoxelStateMap::Accessor& states, const Point3& p, std::size_t id) const {
    const SightTarget& t = targets_[id];
    const VoxelIndex goal = map_->grid().index_of(t.position);
    int unknown = 0;
    return traverse_voxels(p, t.position, map_->voxel_size(), [&](const VoxelIndex& v) {
      if (v == goal) return true;
      const VoxelState s = states(v);
      return s == VoxelState::empty || (s == VoxelState::unknown && ++unknown <= t.unknown_before);
    });
  }

  std::vector<SightTarget> targets_;
  const VoxelStateMap* map_;
  const PinholeCamera* camera_;
  TargetSightOptions options_;
  std::array<Pose, kHeadings> T_camera_world_;
  double cell_ = 1.0;
  std::vector<VoxelIndex> keys_;
  std::vector<std::int32_t> order_;
  std::vector<std::int64_t> packed_;
};

/// For every heading, the worth in view; targets marked in `done` count nothing.
inline std::array<double, kHeadings> worth_by_heading(const SightTargets& targets,
                                                      std::span<const Sighting> seen,
                                                      std::span<const char> done) {
  std::array<double, kHeadings> worth{};
  for (const Sighting& s : seen) {
    const auto id = static_cast<std::size_t>(s.target);
    if (done[id] != 0) continue;
    for (unsigned bits = s.headings; bits != 0; bits &= bits - 1)
      worth[static_cast<std::size_t>(std::countr_zero(bits))] += targets[id].worth;
  }
  return worth;
}
}  // namespace surfleet
