// SPDX-License-Identifier: MIT
/// @file
/// @brief Surface hits as bytes of a map file.
///
/// A block's hits are their number (uint32), then for each, keys ascending: the key (uint16), and
/// as variable-length integers (seven bits a byte, the lowest first, the high bit set in all but
/// the last) weight, passed, and by zigzag the three sums of positions and the three of normals.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/mapping/surface_hits.hpp>

namespace surfleet::detail {
/// The smallest hit: a key and eight integers of one byte.
inline constexpr std::size_t kHitBytes = 2 + 8;
/// More than any map gathers, and little enough to add without overflow.
inline constexpr std::int64_t kMostHitWeight = std::int64_t{1} << 50;

inline void put_varint(ByteWriter& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.put(static_cast<std::uint8_t>(value | 0x80));
  out.put(static_cast<std::uint8_t>(value));
}
inline std::uint64_t get_varint(ByteReader& in, const std::string& what) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 63; shift += 7) {
    const auto byte = in.get<std::uint8_t>();
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80) == 0) return value;
  }
  throw Error(what + ": number before byte " + std::to_string(in.position()) +
              " is too long; expected at most nine bytes");
}
inline std::uint64_t zigzag(std::int64_t v) {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
inline std::int64_t unzigzag(std::uint64_t u) {
  return static_cast<std::int64_t>(u >> 1) ^ -static_cast<std::int64_t>(u & 1);
}

inline void put_hits(ByteWriter& out, const SurfaceHits& hits) {
  out.put(static_cast<std::uint32_t>(hits.size()));
  for (const SurfaceHit& h : hits.hits()) {
    out.put(h.key);
    put_varint(out, static_cast<std::uint64_t>(h.weight));
    put_varint(out, static_cast<std::uint64_t>(h.passed));
    for (const std::int64_t v : h.position) put_varint(out, zigzag(v));
    for (const std::int64_t v : h.normal) put_varint(out, zigzag(v));
  }
}
/// Throws `Error` on sums that no rays give.
inline SurfaceHits get_hits(ByteReader& in, const std::string& what, std::size_t voxels) {
  const auto count = in.get<std::uint32_t>();
  require(count <= in.remaining() / kHitBytes,
          what + ": " + std::to_string(count) + " hits before byte " +
              std::to_string(in.position()) + " do not fit; expected a complete file");
  SurfaceHits hits;
  int last = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    SurfaceHit h;
    h.key = in.get<std::uint16_t>();
    h.weight = static_cast<std::int64_t>(get_varint(in, what));
    h.passed = static_cast<std::int64_t>(get_varint(in, what));
    for (std::int64_t& v : h.position) v = unzigzag(get_varint(in, what));
    for (std::int64_t& v : h.normal) v = unzigzag(get_varint(in, what));
    bool sound = h.key > last && h.voxel() < voxels && h.side() < SurfaceHits::kSides &&
                 h.weight >= 0 && h.weight <= kMostHitWeight && h.passed >= 0 &&
                 h.passed <= kMostHitWeight;
    const auto bounded = [&](std::int64_t v, std::int64_t steps) {
      return v >= -steps * h.weight && v <= steps * h.weight;
    };
    for (std::size_t k = 0; sound && k < 3; ++k)
      sound =
          bounded(h.position[k], SurfaceHit::kSteps) && bounded(h.normal[k], SurfaceHit::kNormal);
    require(sound, what + ": hit before byte " + std::to_string(in.position()) +
                       " is one that no rays give; expected an undamaged file");
    last = h.key;
    hits.ensure(h.key) = h;
  }
  return hits;
}
}  // namespace surfleet::detail
