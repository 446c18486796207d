// SPDX-License-Identifier: MIT
/// @file  Points worth seeing, and what a camera at a given place would see of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/ray_caster.hpp>
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
/// The step nearest to a yaw angle.
inline int nearest_heading(double yaw) {
  const int k = static_cast<int>(std::lround(yaw / (2.0 * kPi) * kHeadings)) % kHeadings;
  return k < 0 ? k + kHeadings : k;
}

/// A target in view and the headings (as bits) from which it is.
struct Sighting {
  std::int32_t target = 0;
  std::uint16_t headings = 0;
};

/// The headings at which a mounted camera has a direction in its image, looked up in an octahedral
/// map of directions with cells of about a degree. 32 KiB.
class HeadingTable {
 public:
  HeadingTable(const PinholeCamera& camera, const Pose& T_body_camera) {
    std::array<Eigen::Matrix3d, kHeadings> R_camera_world;
    for (int k = 0; k < kHeadings; ++k)
      R_camera_world[static_cast<std::size_t>(k)] =
          (Eigen::AngleAxisd(heading_angle(k), Eigen::Vector3d::UnitZ()).toRotationMatrix() *
           T_body_camera.linear())
              .transpose();
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) {
        const Eigen::Vector3d d =
            unfold((u + 0.5) * 2.0 / kSide - 1.0, (v + 0.5) * 2.0 / kSide - 1.0);
        unsigned bits = 0;
        for (unsigned k = 0; k < kHeadings; ++k)
          if (camera.project(R_camera_world[k] * d)) bits |= 1U << k;
        headings_[static_cast<std::size_t>(v * kSide + u)] = static_cast<std::uint16_t>(bits);
      }
    nearest_ = camera.min_range *
               Eigen::Vector3d(std::max(camera.cx, camera.width - 1 - camera.cx) / camera.fx,
                               std::max(camera.cy, camera.height - 1 - camera.cy) / camera.fy, 1.0)
                   .norm();
    range_ = camera.max_range;
  }

  /// The headings, as bits, for a direction in the world of any length but zero.
  std::uint16_t operator()(const Eigen::Vector3d& d) const {
    const double scale = 1.0 / (std::abs(d.x()) + std::abs(d.y()) + std::abs(d.z()));
    double u = d.x() * scale, v = d.y() * scale;
    if (d.z() < 0.0) {
      const double folded = (1.0 - std::abs(v)) * (u < 0.0 ? -1.0 : 1.0);
      v = (1.0 - std::abs(u)) * (v < 0.0 ? -1.0 : 1.0);
      u = folded;
    }
    const int i = std::min(kSide - 1, static_cast<int>((u + 1.0) * (0.5 * kSide)));
    const int j = std::min(kSide - 1, static_cast<int>((v + 1.0) * (0.5 * kSide)));
    return headings_[static_cast<std::size_t>(j * kSide + i)];
  }
  /// From this distance on, the nearest depth is kept all over the image [m].
  double nearest() const { return nearest_; }
  /// The camera's farthest depth [m].
  double range() const { return range_; }

 private:
  static constexpr int kSide = 128;
  static Eigen::Vector3d unfold(double u, double v) {
    Eigen::Vector3d d(u, v, 1.0 - std::abs(u) - std::abs(v));
    if (d.z() < 0.0) {
      d.x() = (1.0 - std::abs(v)) * (u < 0.0 ? -1.0 : 1.0);
      d.y() = (1.0 - std::abs(u)) * (v < 0.0 ? -1.0 : 1.0);
    }
    return d;
  }

  std::array<std::uint16_t, kSide * kSide> headings_{};
  double nearest_ = 0.0, range_ = 0.0;
};

/// What ends a line of sight: `sees(p, target)` is true if the target shows from `p`. Copied for
/// every place that is asked about, so it may remember where it looked last.
template <typename S>
concept TargetSight = std::copy_constructible<S> &&
    requires(S& sees, const Point3& p, const SightTarget& target) {
  { sees(p, target) } -> std::convertible_to<bool>;
};

/// Sight through a map: occupied voxels end it, and more unknown ones than the target allows.
/// O(voxels on the line).
class MapSight {
 public:
  explicit MapSight(const VoxelStateMap& map) : map_(&map), states_(map) {}
  bool operator()(const Point3& p, const SightTarget& t) {
    const VoxelIndex goal = map_->grid().index_of(t.position);
    int unknown = 0;
    return traverse_voxels(p, t.position, map_->voxel_size(), [&](const VoxelIndex& v) {
      if (v == goal) return true;
      const VoxelState s = states_(v);
      return s == VoxelState::empty || (s == VoxelState::unknown && ++unknown <= t.unknown_before);
    });
  }

 private:
  const VoxelStateMap* map_;
  VoxelStateMap::Accessor states_;
};

/// Sight past triangles that are known. A ray cast each.
template <RayCaster Caster>
class MeshSight {
 public:
  explicit MeshSight(const Caster& caster) : caster_(&caster) {}
  bool operator()(const Point3& p, const SightTarget& t) {
    const Eigen::Vector3d d = t.position - p;
    const double distance = d.norm();
    return !caster_->cast(p, d / distance, distance - kSkin);
  }

 private:
  static constexpr double kSkin = 1e-3;  ///< The target's own surface does not hide it [m].
  const Caster* caster_;
};

struct TargetSightOptions {
  double max_distance = 0.0;   ///< Farthest useful look [m]; 0 stands for the camera's range.
  double max_incidence = 1.4;  ///< Greatest angle between the normal and the line of sight [rad].
};

/// Finds what is in view from a position, by cells over the targets and a line of sight to each
/// candidate.
template <TargetSight Sight = MapSight>
class SightTargets {
 public:
  /// The table must outlive this object. O(targets · log targets).
  SightTargets(std::vector<SightTarget> targets, Sight sight, const HeadingTable& headings,
               TargetSightOptions options = {})
      : targets_(std::move(targets)),
        sight_(std::move(sight)),
        headings_(&headings),
        cell_(options.max_distance > 0.0 ? options.max_distance : headings.range()),
        min_cosine_(std::cos(options.max_incidence)) {
    std::vector<std::pair<std::int64_t, std::int32_t>> order;
    order.reserve(targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i)
      order.emplace_back(pack(cell_of(targets_[i].position)), static_cast<std::int32_t>(i));
    std::sort(order.begin(), order.end());
    for (const auto& [key, id] : order) {
      const SightTarget& t = targets_[static_cast<std::size_t>(id)];
      keys_.push_back(key);
      entries_.push_back({t.position, t.normal, id, t.normal.isZero()});
    }
  }

  std::size_t size() const { return targets_.size(); }
  const SightTarget& operator[](std::size_t i) const { return targets_[i]; }
  std::span<const SightTarget> all() const { return targets_; }
  /// Farthest look that counts [m].
  double reach() const { return cell_; }

  /// The targets that would be in view from `p` if nothing were in the way. O(targets within two
  /// ranges).
  std::vector<Sighting> in_view(const Point3& p) const {
    std::vector<Sighting> view;
    const VoxelIndex c = cell_of(p);
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y) {
        // The three cells of a row are neighbours in the order.
        const auto low =
            std::lower_bound(keys_.begin(), keys_.end(), pack(c + VoxelIndex(-1, y, z)));
        const auto high = std::upper_bound(low, keys_.end(), pack(c + VoxelIndex(1, y, z)));
        const auto end = entries_.begin() + (high - keys_.begin());
        for (auto e = entries_.begin() + (low - keys_.begin()); e != end; ++e)
          if (const std::uint16_t bits = headings_for(p, *e)) view.push_back({e->id, bits});
      }
    return view;
  }
  /// Keeps what is really in sight of it. A line of sight each.
  void keep_in_sight(const Point3& p, std::vector<Sighting>& view) const {
    Sight sees = sight_;
    std::erase_if(view, [&](const Sighting& s) {
      return !sees(p, targets_[static_cast<std::size_t>(s.target)]);
    });
  }
  /// Both: the targets in view from `p`, those of a cell beside each other.
  std::vector<Sighting> seen_from(const Point3& p) const {
    std::vector<Sighting> seen = in_view(p);
    keep_in_sight(p, seen);
    return seen;
  }

 private:
  struct Entry {
    Point3 position;
    Eigen::Vector3d normal;
    std::int32_t id;
    bool any_side;
  };
  VoxelIndex cell_of(const Point3& p) const { return (p / cell_).array().floor().cast<int>(); }
  static std::int64_t pack(const VoxelIndex& c) {
    constexpr std::int64_t bias = 1 << 20;
    return ((c.z() + bias) << 42) + ((c.y() + bias) << 21) + (c.x() + bias);
  }
  std::uint16_t headings_for(const Point3& p, const Entry& t) const {
    const Eigen::Vector3d d = t.position - p;
    const double squared = d.squaredNorm();
    if (squared > cell_ * cell_ || squared < headings_->nearest() * headings_->nearest()) return 0;
    if (!t.any_side && -d.dot(t.normal) < std::sqrt(squared) * min_cosine_) return 0;
    return (*headings_)(d);
  }

  std::vector<SightTarget> targets_;
  Sight sight_;
  const HeadingTable* headings_;
  double cell_, min_cosine_;
  std::vector<std::int64_t> keys_;  // by cell
  std::vector<Entry> entries_;      // in the same order
};

/// Marks in `done` the targets in view at a heading; `fn(id)` is told of those not marked before.
template <typename Fn>
void mark_in_view(std::span<const Sighting> seen, int heading, std::vector<char>& done, Fn&& fn) {
  for (const Sighting& s : seen) {
    const auto id = static_cast<std::size_t>(s.target);
    if ((s.headings >> heading & 1U) == 0U || done[id] != 0) continue;
    done[id] = 1;
    fn(id);
  }
}

/// For every heading, the worth in view; targets marked in `done` count nothing.
template <typename Sight>
std::array<double, kHeadings> worth_by_heading(const SightTargets<Sight>& targets,
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
