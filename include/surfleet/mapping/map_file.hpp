// SPDX-License-Identifier: MIT
/// @file
/// @brief TSDF maps as files and messages, and the fusion of one map into another.
///
/// Format, little-endian, no padding:
///
/// | bytes | content |
/// | --- | --- |
/// | 8 | magic `SFLTTSDF` |
/// | 4 | version, 2 (uint32); 1 is read, too |
/// | 4 | voxels along a block's edge, 8 (uint32) |
/// | 8 | voxel size [m] (float64) |
/// | 8 | number of blocks (uint64) |
/// | a block | 3 × int32 block index; uint8 kind; payload; from version 2 on its surface hits |
/// | 4 | CRC-32 of everything before (uint32) |
///
/// Payload by kind, voxels x fastest, each as distance [m] and weight (float32): 0, all 512 voxels;
/// 1, a mask of 64 bytes with one bit a voxel, then the voxels whose bit is set (the others were
/// never seen); 2, one distance that all 512 voxels share, then their 512 weights. Hits are as
/// `detail/hit_codec.hpp` says. Blocks come in the order in which the map made them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/mapping/detail/hit_codec.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct MapFileOptions {
  bool compact = true;      ///< Leave out unseen voxels and repeated distances.
  bool skip_unseen = true;  ///< Leave out blocks in which nothing was seen.
};

namespace detail {
inline constexpr std::array<char, 8> kMapMagic{'S', 'F', 'L', 'T', 'T', 'S', 'D', 'F'};
inline constexpr std::uint32_t kMapVersion = 2;
enum class MapBlockKind : std::uint8_t { full = 0, masked = 1, level = 2 };
/// The smallest block of a file: index, kind, an empty mask.
inline constexpr std::size_t kMapBlockBytes = 12 + 1 + TsdfMap::kBlockVoxels / 8;

inline void put_map_block(ByteWriter& out, const TsdfMap::Block& block, bool compact) {
  for (int i = 0; i < 3; ++i) out.put(static_cast<std::int32_t>(block.index[i]));
  std::array<std::uint8_t, TsdfMap::kBlockVoxels / 8> mask{};
  std::size_t seen = 0;
  bool level = true;
  for (std::size_t i = 0; i < block.voxels.size(); ++i) {
    const TsdfVoxel& v = block.voxels[i];
    level = level && v.distance == block.voxels[0].distance;
    // A voxel without weight has no distance that matters.
    if (v.weight == 0.0F) continue;
    mask[i / 8] = static_cast<std::uint8_t>(mask[i / 8] | 1U << (i % 8));
    ++seen;
  }
  const std::size_t full_bytes = block.voxels.size() * sizeof(TsdfVoxel);
  const std::size_t level_bytes = (block.voxels.size() + 1) * sizeof(float);
  const std::size_t masked_bytes = mask.size() + seen * sizeof(TsdfVoxel);
  if (compact && masked_bytes < std::min(full_bytes, level ? level_bytes : full_bytes)) {
    out.put(MapBlockKind::masked);
    out.put(mask);
    for (const TsdfVoxel& v : block.voxels)
      if (v.weight != 0.0F) out.put(v);
  } else if (compact && level) {
    out.put(MapBlockKind::level);
    out.put(block.voxels[0].distance);
    for (const TsdfVoxel& v : block.voxels) out.put(v.weight);
  } else {
    out.put(MapBlockKind::full);
    out.put_array(std::span<const TsdfVoxel>(block.voxels));
  }
  put_hits(out, block.layer);
}

inline void get_map_block(ByteReader& in, const std::string& what,
                          std::span<TsdfVoxel, TsdfMap::kBlockVoxels> voxels) {
  const auto kind = in.get<std::uint8_t>();
  if (kind == static_cast<std::uint8_t>(MapBlockKind::full)) {
    for (TsdfVoxel& v : voxels) v = in.get<TsdfVoxel>();
  } else if (kind == static_cast<std::uint8_t>(MapBlockKind::masked)) {
    const auto mask = in.get<std::array<std::uint8_t, TsdfMap::kBlockVoxels / 8>>();
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if ((mask[i / 8] >> (i % 8) & 1U) != 0U) voxels[i] = in.get<TsdfVoxel>();
  } else if (kind == static_cast<std::uint8_t>(MapBlockKind::level)) {
    const auto distance = in.get<float>();
    for (TsdfVoxel& v : voxels) v = {distance, in.get<float>()};
  } else {
    throw Error(what + ": block of kind " + std::to_string(kind) + " at byte " +
                std::to_string(in.position() - 1) + "; expected 0, 1 or 2");
  }
  for (const TsdfVoxel& v : voxels)
    if (!(std::isfinite(v.distance) && std::isfinite(v.weight) && v.weight >= 0.0F))
      throw Error(what + ": voxel before byte " + std::to_string(in.position()) +
                  " is not finite or has a negative weight; expected a finite one");
}
}  // namespace detail

/// The map as bytes of the format above. O(map).
inline Bytes encode_map(const TsdfMap& map, MapFileOptions options = {}) {
  ByteWriter out;
  std::vector<const TsdfMap::Block*> blocks;
  map.for_each_block([&](const TsdfMap::Block& b) {
    const bool seen =
        !b.layer.empty() || std::any_of(b.voxels.begin(), b.voxels.end(),
                                        [](const TsdfVoxel& v) { return v.weight != 0.0F; });
    if (seen || !options.skip_unseen) blocks.push_back(&b);
  });
  out.put(detail::kMapMagic);
  out.put(detail::kMapVersion);
  out.put(static_cast<std::uint32_t>(TsdfMap::kBlockSide));
  out.put(map.voxel_size());
  out.put(static_cast<std::uint64_t>(blocks.size()));
  for (const TsdfMap::Block* b : blocks) detail::put_map_block(out, *b, options.compact);
  out.put(crc32(out.bytes()));
  return out.take();
}

/// The map of the bytes; every block is marked as changed. Throws `Error` that begins with `what`
/// on anything but a whole, sound map; allocates no more than some sixty times the bytes.
inline TsdfMap decode_map(std::span<const std::byte> bytes, const std::string& what = "map") {
  ByteReader in(bytes, what);
  require(in.get<std::array<char, 8>>() == detail::kMapMagic,
          what + ": not a map file; expected it to begin with SFLTTSDF");
  const auto version = in.get<std::uint32_t>();
  require(version >= 1 && version <= detail::kMapVersion,
          what + ": map format version " + std::to_string(version) + "; expected 1 to " +
              std::to_string(detail::kMapVersion));
  const auto side = in.get<std::uint32_t>();
  require(side == TsdfMap::kBlockSide, what + ": blocks of " + std::to_string(side) +
                                           " voxels a side; expected " +
                                           std::to_string(TsdfMap::kBlockSide));
  require(bytes.size() >= in.position() + 4, what + ": ends early; expected a complete file");
  const auto body = bytes.first(bytes.size() - 4);
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + body.size(), sizeof(stored));
  require(stored == crc32(body), what + ": checksum does not match; expected an undamaged file");

  const auto voxel_size = in.get<double>();
  require(voxel_size > 0.0 && std::isfinite(voxel_size),
          what + ": voxel size " + std::to_string(voxel_size) + " m; expected a positive length");
  const auto count = in.get<std::uint64_t>();
  require(count <= in.remaining() / detail::kMapBlockBytes,
          what + ": " + std::to_string(count) + " blocks do not fit the file's " +
              std::to_string(bytes.size()) + " bytes; expected a complete file");
  TsdfMap map({.voxel_size = voxel_size});
  for (std::uint64_t i = 0; i < count; ++i) {
    BlockIndex index;
    for (int a = 0; a < 3; ++a) index[a] = in.get<std::int32_t>();
    constexpr std::int64_t kLimit = (std::int64_t{1} << 30) / TsdfMap::kBlockSide;
    require(index.cast<std::int64_t>().minCoeff() >= -kLimit &&
                index.cast<std::int64_t>().maxCoeff() < kLimit,
            what + ": block " + std::to_string(i) +
                " lies outside the grid; expected coordinates below 2^30 voxels");
    require(map.find_slot(index) == TsdfMap::kNone,
            what + ": block " + std::to_string(i) + " occurs twice; expected each block once");
    const std::uint32_t slot = map.ensure_slot(index);
    detail::get_map_block(in, what, map.block(slot).voxels);
    if (version >= 2) map.block(slot).layer = detail::get_hits(in, what, TsdfMap::kBlockVoxels);
    map.mark_changed(slot);
  }
  require(in.remaining() == 4, what + ": bytes after the last block; expected the end of the file");
  return map;
}

/// Writes the map whole or not at all; throws `Error` if it cannot.
inline void save_map(const TsdfMap& map, const std::filesystem::path& path,
                     MapFileOptions options = {}) {
  write_file(path, encode_map(map, options));
}
/// Throws `Error` with the path in it on anything but a whole, sound map file.
inline TsdfMap load_map(const std::filesystem::path& path) {
  return decode_map(read_file(path), path.string());
}

/// Folds `patch` into `map`, voxel by voxel, as if `map` had taken the patch's observations too:
/// distances are averaged by weight, weights added up to `max_weight`, hits added, exactly and in
/// any order. Marks what changed and
/// returns the number of changed blocks. Throws `Error` unless the voxel sizes agree.
inline std::size_t merge_maps(TsdfMap& map, const TsdfMap& patch, double max_weight = 1000.0) {
  require(map.voxel_size() == patch.voxel_size(),
          "merging maps of voxel sizes " + std::to_string(map.voxel_size()) + " and " +
              std::to_string(patch.voxel_size()) + " m: expected equal ones");
  const auto limit = static_cast<float>(max_weight);
  std::size_t changed = 0;
  patch.for_each_block([&](const TsdfMap::Block& source) {
    std::uint32_t slot = map.find_slot(source.index);
    bool differs = false;
    for (std::size_t i = 0; i < source.voxels.size(); ++i) {
      const TsdfVoxel& from = source.voxels[i];
      if (!(from.weight > 0.0F)) continue;
      if (slot == TsdfMap::kNone) slot = map.ensure_slot(source.index);
      TsdfVoxel& to = map.block(slot).voxels[i];
      const float weight = std::min(to.weight + from.weight, limit);
      const float distance =
          to.distance + (from.distance - to.distance) * (from.weight / (to.weight + from.weight));
      differs = differs || weight != to.weight || distance != to.distance;
      to = {distance, weight};
    }
    if (!source.layer.empty()) {
      if (slot == TsdfMap::kNone) slot = map.ensure_slot(source.index);
      map.block(slot).layer.add(source.layer);
      differs = true;
    }
    if (!differs) return;
    map.mark_changed(slot);
    ++changed;
  });
  return changed;
}
}  // namespace surfleet
