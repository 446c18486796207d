// SPDX-License-Identifier: MIT
/// @file
/// @brief Where rays ended in the voxels of a block, side by side: what a distance cannot hold.
///
/// One distance a voxel cannot tell of a sheet that is seen from both sides, nor of a bar thinner
/// than itself: what one image writes as behind the surface, another writes as free. Hits can. For
/// each voxel and each of the six axis directions that the surface's normal may be nearest to, a
/// `SurfaceHit` sums the points at which rays ended there, their normals, and the rays that passed
/// through the place afterwards or before. The two sides of a sheet never share a sum, and the
/// plane through the mean point is a side's own distance: n · (c − p) for a voxel centre c.
///
/// All sums are integers, so that they can be added in any order and taken away again exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// The number of the axis direction a normal is nearest to: 2 · axis, plus 1 if it is negative.
inline int side_of_normal(const Eigen::Vector3d& n) {
  int axis = 0;
  n.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (n[axis] < 0.0 ? 1 : 0);
}

/// What was seen of the surface in one voxel from one side.
///
/// Weights are those of TSDF fusion: an image in which the voxel's whole face is seen from range z
/// adds about 1 / z², a part of the face its share of that.
struct SurfaceHit {
  static constexpr double kWeightUnit = 1.0 / (1 << 20);  ///< Of `weight` and `passed`.
  /// Of a voxel's face, what surface has to fill to be known in full: of what `is_solid` asks for,
  /// so much will do, as bars and rims fill no more.
  static constexpr double kFaceShare = 0.25;
  static constexpr int kSteps = 64;   ///< Steps of a position from the centre to a face.
  static constexpr int kNormal = 64;  ///< Length of a unit normal in a sum.

  std::uint16_t key = 0;                   ///< 8 · offset of the voxel in its block + side.
  std::int64_t weight = 0;                 ///< Of the rays that ended here.
  std::int64_t passed = 0;                 ///< Of the views that saw through the place.
  std::array<std::int64_t, 3> position{};  ///< Σ weight · (point − voxel centre) in steps.
  std::array<std::int64_t, 3> normal{};    ///< Σ weight · outward normal.

  std::size_t voxel() const { return key >> 3; }
  int side() const { return key & 7; }
  double weight_value() const { return static_cast<double>(weight) * kWeightUnit; }
  /// Whether there is surface that is known at weight `known` (W_th): rays ended here often enough,
  /// and no more of them have passed through.
  bool is_solid(double known) const {
    return weight > 0 && weight >= passed && weight_value() >= kFaceShare * known;
  }
  /// Mean point, from the voxel's centre, for voxels of size `h` [m].
  Eigen::Vector3d mean_offset(double h) const {
    return Eigen::Vector3d(static_cast<double>(position[0]), static_cast<double>(position[1]),
                           static_cast<double>(position[2])) *
           (0.5 * h / kSteps / static_cast<double>(std::max<std::int64_t>(weight, 1)));
  }
  /// Mean outward normal, unit; the side's axis if the normals cancel.
  Eigen::Vector3d mean_normal() const {
    const Eigen::Vector3d n(static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                            static_cast<double>(normal[2]));
    const double length = n.norm();
    if (length > 0.0) return n / length;
    return (side() & 1) != 0 ? Eigen::Vector3d(-Eigen::Vector3d::Unit(side() / 2))
                             : Eigen::Vector3d(Eigen::Vector3d::Unit(side() / 2));
  }

  bool operator==(const SurfaceHit&) const = default;
  bool is_zero() const { return *this == SurfaceHit{.key = key}; }
  /// Adds rays that ended here, unless there is `most` weight of them already; whether it did.
  bool take(const SurfaceHit& rays, double most) {
    if (weight_value() >= most) return false;
    add(rays, 1);
    return true;
  }
  bool may_pass() const { return passed <= 2 * weight; }
  /// Notes `gain` of views through the place, as long as they may still change what is said of it.
  bool pass(std::int64_t gain) {
    if (!may_pass()) return false;
    passed += gain;
    return true;
  }
  /// Adds `times` times the other's sums.
  SurfaceHit& add(const SurfaceHit& o, std::int64_t times) {
    weight += times * o.weight;
    passed += times * o.passed;
    for (std::size_t i = 0; i < 3; ++i) {
      position[i] += times * o.position[i];
      normal[i] += times * o.normal[i];
    }
    return *this;
  }
};

/// The hits of a block, in the order of their keys: equal contents are equal byte by byte, however
/// they came about. Finding one is O(log n), making one O(n). An empty layer costs three pointers.
class SurfaceHits {
 public:
  static constexpr std::size_t kVoxels = 4096;  ///< Voxels a block can have.
  static constexpr int kSides = 6;

  static std::uint16_t key_of(std::size_t offset, int side) {
    return static_cast<std::uint16_t>(offset * 8 + static_cast<std::size_t>(side));
  }

  bool empty() const { return hits_.empty(); }
  std::size_t size() const { return hits_.size(); }
  std::span<const SurfaceHit> hits() const { return hits_; }
  std::span<SurfaceHit> hits() { return hits_; }
  /// The hits of one voxel, at most one a side.
  std::span<const SurfaceHit> of_voxel(std::size_t offset) const {
    const auto first = lower_bound(key_of(offset, 0));
    auto last = first;
    while (last != hits_.end() && last->voxel() == offset) ++last;
    return {first, last};
  }
  const SurfaceHit* find(std::uint16_t key) const {
    const auto it = lower_bound(key);
    return it != hits_.end() && it->key == key ? &*it : nullptr;
  }
  SurfaceHit& ensure(std::uint16_t key) {
    const auto it = hits_.begin() + (lower_bound(key) - hits_.begin());
    if (it != hits_.end() && it->key == key) return *it;
    return *hits_.insert(it, SurfaceHit{.key = key});
  }

  /// The same for ascending keys: `at`, 0 at first, is where the last one was found. O(hits) for
  /// all of a block's.
  SurfaceHit& ensure_after(std::uint16_t key, std::size_t& at) {
    while (at < hits_.size() && hits_[at].key < key) ++at;
    if (at == hits_.size() || hits_[at].key != key)
      hits_.insert(hits_.begin() + static_cast<std::ptrdiff_t>(at), SurfaceHit{.key = key});
    return hits_[at];
  }

  /// Adds or takes away sums; what becomes nothing is dropped, so that taking away what was added
  /// leaves what was there.
  void add(const SurfaceHits& other) { fold(other, 1); }
  void subtract(const SurfaceHits& other) { fold(other, -1); }
  void clear() { hits_.clear(); }

  std::size_t memory_bytes() const { return hits_.capacity() * sizeof(SurfaceHit); }
  bool operator==(const SurfaceHits&) const = default;

 private:
  std::vector<SurfaceHit>::const_iterator lower_bound(std::uint16_t key) const {
    return std::lower_bound(hits_.begin(), hits_.end(), key,
                            [](const SurfaceHit& h, std::uint16_t k) { return h.key < k; });
  }
  void fold(const SurfaceHits& other, std::int64_t times) {
    std::vector<SurfaceHit> joined;
    joined.reserve(hits_.size() + other.hits_.size());
    auto a = hits_.begin();
    auto b = other.hits_.begin();
    while (a != hits_.end() || b != other.hits_.end()) {
      SurfaceHit h;
      if (b == other.hits_.end() || (a != hits_.end() && a->key < b->key)) {
        h = *a++;
      } else if (a == hits_.end() || b->key < a->key) {
        h.key = b->key;
        h.add(*b++, times);
      } else {
        h = *a++;
        h.add(*b++, times);
      }
      if (!h.is_zero()) joined.push_back(h);
    }
    hits_ = std::move(joined);
  }

  std::vector<SurfaceHit> hits_;
};
}  // namespace surfleet
