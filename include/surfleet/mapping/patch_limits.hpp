// SPDX-License-Identifier: MIT
/// @file
/// @brief How large a map patch may be: what its images can show, whoever it comes from.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/mapping/map_patch.hpp>

namespace surfleet {
/// What a patch may be, whoever it comes from. `patch_limits` has those of a sensor.
struct PatchLimits {
  std::optional<double> voxel_size{};    ///< Expected, if said [m].
  std::optional<double> truncation{};    ///< Expected, if said [m].
  std::uint32_t images = 4096;           ///< Most.
  double image_weight = 100.0;           ///< Most that one image adds to a voxel.
  double reach = 300.0;                  ///< Farthest that a patch extends from its anchor [m].
  Box3 places{};                         ///< Where images are taken [m]; empty: anywhere.
  std::uint32_t blocks = 1 << 14;        ///< Most; each takes three kilobytes of memory …
  std::uint32_t image_blocks = 1 << 14;  ///< … and most that one image shows.
  std::uint32_t hits = 1 << 20;          ///< Most places where rays ended …
  std::uint32_t image_hits = 1 << 20;    ///< … and most that one image shows.
  std::uint32_t notes = 1 << 14;         ///< Most views in vain, and most places without a path.

  std::uint64_t most_blocks(std::uint32_t of_images) const {
    return std::min<std::uint64_t>(blocks, std::uint64_t{of_images} * image_blocks);
  }
  std::uint64_t most_hits(std::uint32_t of_images) const {
    return std::min<std::uint64_t>(hits, std::uint64_t{of_images} * image_hits);
  }
};

/// Why the bytes of a patch are not read.
enum class PatchFault : std::uint8_t {
  malformed,         ///< Cut short, damaged, of another version, or with a content that none has.
  checksum,          ///< Damaged.
  bomb,              ///< Larger than its box, its images or any patch can be.
  out_of_reach,      ///< Of what its images cannot have shown.
  impossible_weight  ///< Of weights that no such images give.
};
class PatchError : public Error {
 public:
  PatchError(PatchFault fault, const std::string& text) : Error(text), fault_(fault) {}
  PatchFault fault() const { return fault_; }

 private:
  PatchFault fault_;
};

/// How far from itself a sensor says anything of a map that is truncated there [m].
inline double farthest_seen(const SensorModel& sensor, double truncation) {
  if (const auto* lidar = std::get_if<LidarModel>(&sensor)) return lidar->max_range + truncation;
  const auto& c = std::get<PinholeCamera>(sensor);
  double stretch = 1.0;  // a camera's range is a depth
  for (const double u : {-0.5, c.width - 0.5})
    for (const double v : {-0.5, c.height - 0.5}) stretch = std::max(stretch, c.ray(u, v).norm());
  return (c.max_range + truncation) * stretch;
}

/// The limits of patches of such a sensor: of 16 MB at most, however they are packed. What one
/// image shows is within a ball of `farthest_seen`, and the blocks that meet a ball lie in one that
/// is larger by their diagonal.
inline PatchLimits patch_limits(const SensorModel& sensor, double voxel_size, double truncation) {
  PatchLimits limits{
      .voxel_size = voxel_size, .truncation = truncation, .blocks = 1 << 12, .hits = 1 << 16};
  const double side = TsdfMap::kBlockSide * voxel_size, diagonal = std::sqrt(3.0) * side;
  const double seen = farthest_seen(sensor, truncation);
  const double ball = 4.0 / 3.0 * kPi * std::pow((seen + diagonal) / side, 3);
  limits.image_blocks = static_cast<std::uint32_t>(
      std::min(std::ceil(ball), double{std::numeric_limits<std::uint32_t>::max()}));
  limits.reach = std::max(limits.reach, 2.0 * (seen + diagonal));
  if (const auto* c = std::get_if<PinholeCamera>(&sensor))
    limits.image_hits =
        static_cast<std::uint32_t>(c->width) * static_cast<std::uint32_t>(c->height);
  return limits;
}

/// The patch as patches that are within the limits and make the same map: blocks in parts, each
/// said to be of all the images. Notes of what is out of reach are left out. The parts' numbers
/// follow on the patch's own; there is at least one. O(patch).
inline std::vector<MapPatch> parts_within(MapPatch patch, const PatchLimits& limits) {
  const auto in_reach = [&](const VoxelKey& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = kViewPlaceVoxels * patch.voxel_size * p[k];
      if (!(std::abs(at - patch.anchor.translation()[static_cast<int>(k)]) <= limits.reach))
        return false;
    }
    return true;
  };
  const auto cut = [&](auto& notes) {
    std::erase_if(notes, [&](const auto& n) { return !in_reach(n.place); });
    if (notes.size() > limits.notes) notes.resize(limits.notes);
  };
  cut(patch.notes.views);
  cut(patch.notes.failures);
  std::vector<PatchBlock> blocks = std::exchange(patch.blocks, {});
  MapPatch next = patch;
  next.notes = {.kind = patch.notes.kind, .views = {}, .failures = {}};
  std::vector<MapPatch> parts{std::move(patch)};
  std::uint64_t hits = 0;
  for (PatchBlock& b : blocks) {
    if (!parts.back().blocks.empty() &&
        (parts.back().blocks.size() >= limits.most_blocks(next.images) ||
         hits + b.hits.size() > limits.most_hits(next.images))) {
      ++next.id.key.number;
      parts.push_back(next);
      hits = 0;
    }
    hits += b.hits.size();
    parts.back().blocks.push_back(std::move(b));
  }
  return parts;
}
}  // namespace surfleet
