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
    tabulate_headings(T_body_camera);
    min_cosine_ = std::cos(options_.max_incidence);
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

 private:
  VoxelIndex cell_of(const Point3& p) const { return (p / cell_).array().floor().cast<int>(); }
  static std::int64_t pack(const VoxelIndex& c) {
    constexpr std::int64_t bias = 1 << 20;
    return ((c.z() + bias) << 42) + ((c.y() + bias) << 21) + (c.x() + bias);
  }
  /// The headings that have a direction in the image, by its azimuth and elevation.
  void tabulate_headings(const Pose& T_body_camera) {
    nearest_ =
        camera_->min_range *
        Eigen::Vector3d(std::max(camera_->cx, camera_->width - 1 - camera_->cx) / camera_->fx,
                        std::max(camera_->cy, camera_->height - 1 - camera_->cy) / camera_->fy, 1.0)
            .norm();
    std::array<Eigen::Matrix3d, kHeadings> R_camera_world;
    for (int k = 0; k < kHeadings; ++k)
      R_camera_world[static_cast<std::size_t>(k)] =
          (Eigen::AngleAxisd(heading_angle(k), Eigen::Vector3d::UnitZ()).toRotationMatrix() *
           T_body_camera.linear())
              .transpose();
    for (int e = 0; e < kElevations; ++e)
      for (int a = 0; a < kAzimuths; ++a) {
        const double sine = (e + 0.5) * 2.0 / kElevations - 1.0;
        const double cosine = std::sqrt(1.0 - sine * sine);
        const double azimuth = (a + 0.5) * 2.0 * kPi / kAzimuths - kPi;
        const Eigen::Vector3d d(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
        unsigned headings = 0;
        for (unsigned k = 0; k < kHeadings; ++k)
          if (camera_->project(R_camera_world[k] * d)) headings |= 1U << k;
        headings_[static_cast<std::size_t>(e * kAzimuths + a)] =
            static_cast<std::uint16_t>(headings);
      }
  }
  std::uint16_t headings_for(const Point3& p, std::size_t id) const {
    const SightTarget& t = targets_[id];
    const Eigen::Vector3d d = t.position - p;
    const double squared = d.squaredNorm();
    if (squared > options_.max_distance * options_.max_distance || squared < nearest_ * nearest_)
      return 0;
    const double distance = std::sqrt(squared);
    if (!t.normal.isZero() && -d.dot(t.normal) < distance * min_cosine_) return 0;
    const int e =
        std::min(kElevations - 1, static_cast<int>((d.z() / distance + 1.0) * (0.5 * kElevations)));
    const int a = std::min(kAzimuths - 1, static_cast<int>((std::atan2(d.y(), d.x()) + kPi) *
                                                           (kAzimuths / (2.0 * kPi))));
    return headings_[static_cast<std::size_t>(e * kAzimuths + a)];
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
  // Directions in cells of 2.8 degrees of azimuth and equal steps of the elevation's sine.
  static constexpr int kAzimuths = 128, kElevations = 64;
  std::array<std::uint16_t, kAzimuths * kElevations> headings_{};
  double nearest_ = 0.0, min_cosine_ = 0.0;
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
