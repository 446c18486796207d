// SPDX-License-Identifier: MIT
/// @file
/// @brief A robot's views in vain and failed path searches, in whole numbers, shared with its
/// patches.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>

namespace surfleet {
/// A unit vector in steps of a 127th.
using ViewDirection = std::array<std::int8_t, 3>;
inline constexpr int kViewDirectionSteps = 127;

/// Voxels of one place share their views: two along each axis.
inline constexpr int kViewPlaceVoxels = 2;
inline VoxelKey view_place(const VoxelIndex& v) { return {v.x() >> 1, v.y() >> 1, v.z() >> 1}; }

inline ViewDirection quantised(const Eigen::Vector3d& unit) {
  ViewDirection q{};
  for (int k = 0; k < 3; ++k)
    q[static_cast<std::size_t>(k)] =
        static_cast<std::int8_t>(std::round(unit[k] * kViewDirectionSteps));
  return q;
}
/// Whether it can be that of a unit vector: rounding takes at most half a step off each coordinate.
inline bool is_view_direction(const ViewDirection& q) {
  constexpr int kLess = kViewDirectionSteps - 1, kMore = kViewDirectionSteps + 1;
  const int square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
  return square >= kLess * kLess && square <= kMore * kMore;
}
inline Eigen::Vector3d unit_vector(const ViewDirection& q) {
  return Eigen::Vector3d(q[0], q[1], q[2]).normalized();
}

/// Since the robot's last patch.
struct ViewNotes {
  /// A view that should have completed what is there and did not; `direction` is to the camera.
  struct View {
    VoxelKey place{};
    ViewDirection direction{};
    auto operator<=>(const View&) const = default;
  };
  /// So many path searches to views of what is there failed.
  struct Failure {
    VoxelKey place{};
    std::uint8_t count = 0;
    auto operator<=>(const Failure&) const = default;
  };
  std::uint32_t kind = 0;   ///< Of robot, as `kind_number` has it: others learn nothing by it.
  std::vector<View> views;  ///< Each once, ascending.
  std::vector<Failure> failures;  ///< Each place once, ascending.

  bool empty() const { return views.empty() && failures.empty(); }
  bool operator==(const ViewNotes&) const = default;
};

/// All views, each once, and the sums of failures, at most 255 of a place. Throws `Error` on notes
/// of different kinds. O(n log n).
inline ViewNotes merged_notes(std::span<const ViewNotes> parts) {
  ViewNotes whole;
  bool first = true;
  std::set<ViewNotes::View> views;
  std::map<VoxelKey, int> failures;
  for (const ViewNotes& notes : parts) {
    if (notes.empty()) continue;
    if (first) whole.kind = notes.kind;
    first = false;
    require(notes.kind == whole.kind, "view notes: expected those of one kind of robot");
    views.insert(notes.views.begin(), notes.views.end());
    for (const ViewNotes::Failure& f : notes.failures) failures[f.place] += f.count;
  }
  whole.views.assign(views.begin(), views.end());
  for (const auto& [place, count] : failures)
    whole.failures.push_back({place, static_cast<std::uint8_t>(std::min(count, 255))});
  return whole;
}
/// The notes when their frame lies at `T_map_frame`; voxels are of `voxel_size` [m]. O(n log n).
inline ViewNotes moved_notes(const ViewNotes& notes, const Pose& T_map_frame, double voxel_size) {
  const double side = kViewPlaceVoxels * voxel_size;
  const auto moved = [&](const VoxelKey& place) {
    const Point3 centre(place[0] + 0.5, place[1] + 0.5, place[2] + 0.5);
    const Point3 at = T_map_frame * Point3(side * centre) / side;
    VoxelKey to{};
    for (int k = 0; k < 3; ++k)
      to[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(at[k]));
    return to;
  };
  ViewNotes out{.kind = notes.kind, .views = {}, .failures = {}};
  for (const ViewNotes::View& v : notes.views)
    out.views.push_back(
        {moved(v.place), quantised(T_map_frame.linear() * unit_vector(v.direction))});
  for (const ViewNotes::Failure& f : notes.failures)
    out.failures.push_back({moved(f.place), f.count});
  return merged_notes(std::span<const ViewNotes>(&out, 1));
}
}  // namespace surfleet
