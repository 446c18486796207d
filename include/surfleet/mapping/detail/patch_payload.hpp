// SPDX-License-Identifier: MIT
/// @file
/// @brief The blocks of a map patch as bytes that pack well.
///
/// Streams one after the other, so that alike bytes stand together. Blocks come in `patch_order`,
/// voxels x fastest, those with weight only:
///
/// 1. a block: how many places of the box it is after the one before (varint); flags (uint8): 1,
/// all
///    voxels have weight; 2, all distances are +µ; 4, it has hits.
/// 2. masks of 64 bytes, one bit a voxel, of blocks without flag 1.
/// 3. distances of blocks without flag 2, each a byte: what it exceeds its prediction by, modulo
/// 256.
/// 4. weights, each a byte: zigzag of what it exceeds its prediction by, or 255 if that is more;
/// 5. and for each such the rest (varint).
/// 6. hits of blocks with flag 4: a block's number of them less 1, then how far each key is from
/// the
///    one before (varints); 7. weights less that of the hit before of the same side (zigzag
///    varints);
///    8. what passed (varints); 9. to 14. positions and normals, one coordinate after the other,
///    each a byte: what it exceeds that of the hit before of the same side by, modulo 256.
///
/// View notes follow: views in vain, a place (3 × int32) and a direction (3 × int8) each;
/// places that no path was found to view, each with how often (uint8).
///
/// A value is predicted from the seven voxels before it in x, y and z, of its own block or of those
/// before: as if x, y and z added up (Lorenzo); where some were not seen, from those that were.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/mapping/detail/hit_codec.hpp>
#include <surfleet/mapping/map_patch.hpp>
#include <surfleet/mapping/patch_limits.hpp>

namespace surfleet::detail {
/// Blocks from `lo` to `hi`, both included; none if `hi` is less.
struct BlockBox {
  BlockIndex lo = BlockIndex::Zero();
  BlockIndex hi = BlockIndex::Constant(-1);

  std::int64_t extent(int axis) const { return std::int64_t{hi[axis]} - lo[axis] + 1; }
  bool contains(const BlockIndex& b) const {
    return (b.array() >= lo.array()).all() && (b.array() <= hi.array()).all();
  }
  std::uint64_t place(const BlockIndex& b) const {
    const auto at = [&](int k) { return static_cast<std::uint64_t>(std::int64_t{b[k]} - lo[k]); };
    return (at(2) * static_cast<std::uint64_t>(extent(1)) + at(1)) *
               static_cast<std::uint64_t>(extent(0)) +
           at(0);
  }
  BlockIndex block_at(std::uint64_t place) const {
    const auto nx = static_cast<std::uint64_t>(extent(0)),
               ny = static_cast<std::uint64_t>(extent(1));
    return {lo.x() + static_cast<int>(place % nx), lo.y() + static_cast<int>(place / nx % ny),
            lo.z() + static_cast<int>(place / nx / ny)};
  }
};
inline BlockBox box_of(std::span<const PatchBlock> blocks) {
  if (blocks.empty()) return {};
  BlockBox box{blocks[0].index, blocks[0].index};
  for (const PatchBlock& b : blocks) {
    box.lo = box.lo.cwiseMin(b.index);
    box.hi = box.hi.cwiseMax(b.index);
  }
  return box;
}

/// The values of a block and, one voxel thick, of its neighbours before it in x, y and z.
class PredictionWindow {
 public:
  /// `blocks` in order; those before `at` and what has been set of it count.
  PredictionWindow(std::span<const PatchBlock> blocks, std::size_t at) {
    const BlockIndex& own = blocks[at].index;
    for (int n = 1; n < 8; ++n) {
      const BlockIndex b = own - BlockIndex(n & 1, n >> 1 & 1, n >> 2);
      const auto it = std::lower_bound(
          blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(at), b,
          [](const PatchBlock& block, const BlockIndex& i) { return patch_order(block.index, i); });
      if (it == blocks.begin() + static_cast<std::ptrdiff_t>(at) || it->index != b) continue;
      const auto from = [&](int axis) { return (n >> axis & 1) != 0 ? 7 : 0; };
      for (int z = from(2); z < 8; ++z)
        for (int y = from(1); y < 8; ++y)
          for (int x = from(0); x < 8; ++x) {
            const auto i = static_cast<std::size_t>(x + 8 * (y + 8 * z));
            const std::size_t to =
                place((n & 1) != 0 ? -1 : x, (n >> 1 & 1) != 0 ? -1 : y, (n >> 2) != 0 ? -1 : z);
            weight_[to] = static_cast<std::int32_t>(it->weight[i]);
            distance_[to] = it->distance[i];
          }
    }
  }
  static std::size_t place(int x, int y, int z) {
    return static_cast<std::size_t>(x + 1 + kSide * (y + 1 + kSide * (z + 1)));
  }
  static std::size_t place(std::size_t voxel) {
    const auto v = static_cast<int>(voxel);
    return place(v & 7, v >> 3 & 7, v >> 6);
  }

  bool all_seen_before(std::size_t p) const {
    return weight_[p - kX] != 0 && weight_[p - kY] != 0 && weight_[p - kZ] != 0 &&
           weight_[p - kX - kY] != 0 && weight_[p - kX - kZ] != 0 && weight_[p - kY - kZ] != 0 &&
           weight_[p - kX - kY - kZ] != 0;
  }
  std::int64_t predicted_weight(std::size_t p) const {
    return std::clamp<std::int64_t>(predicted(weight_, p, last_weight_), 1, kPatchMaxWeight);
  }
  int predicted_distance(std::size_t p) const {
    return static_cast<int>(std::clamp<std::int64_t>(predicted(distance_, p, last_distance_),
                                                     -kPatchDistanceSteps, kPatchDistanceSteps));
  }
  void set_weight(std::size_t p, std::uint32_t w) {
    last_weight_ = weight_[p] = static_cast<std::int32_t>(w);
  }
  void set_distance(std::size_t p, std::int8_t d) { last_distance_ = distance_[p] = d; }
  /// For the distances' own pass, in which no weights are known yet: which voxels have one.
  void set_seen(std::size_t p, bool seen) { weight_[p] = seen ? 1 : 0; }

 private:
  static constexpr int kSide = 9;
  static constexpr std::size_t kX = 1, kY = kSide, kZ = kSide * kSide;
  template <typename T>
  std::int64_t predicted(const std::array<T, kSide * kSide * kSide>& v, std::size_t p,
                         T last) const {
    const auto at = [&](std::size_t q) { return static_cast<std::int64_t>(v[q]); };
    if (all_seen_before(p))
      return at(p - kX) + at(p - kY) + at(p - kZ) - at(p - kX - kY) - at(p - kX - kZ) -
             at(p - kY - kZ) + at(p - kX - kY - kZ);
    std::int64_t sum = 0, n = 0;
    for (const std::size_t q : {p - kX, p - kY, p - kZ})
      if (weight_[q] != 0) {
        sum += at(q);
        ++n;
      }
    return n == 0 ? last : divide_rounded(sum, n);
  }

  std::array<std::int32_t, kSide * kSide * kSide> weight_{};
  std::array<std::int8_t, kSide * kSide * kSide> distance_{};
  std::int32_t last_weight_ = 1;
  std::int8_t last_distance_ = kPatchDistanceSteps;
};

enum PatchBlockFlag : std::uint8_t { kAllSeen = 1, kAllFree = 2, kHasHits = 4 };

inline Bytes put_patch_blocks(std::span<const PatchBlock> blocks, const BlockBox& box) {
  ByteWriter shape, masks, distances, weights, rests, keys, hit_weights, passes;
  std::array<ByteWriter, 6> means;
  std::array<PatchHit, 8> last{};  // by side
  std::uint64_t next = 0;
  int seen_count = 0;
  for (std::size_t at = 0; at < blocks.size(); ++at) {
    const PatchBlock& b = blocks[at];
    const std::uint64_t place = box.place(b.index);
    put_varint(shape, place - next);
    next = place + 1;
    std::array<std::uint8_t, TsdfMap::kBlockVoxels / 8> mask{};
    bool all_free = true;
    seen_count = 0;
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      if (b.weight[i] == 0) continue;
      mask[i / 8] = static_cast<std::uint8_t>(mask[i / 8] | 1U << (i % 8));
      all_free = all_free && b.distance[i] == kPatchDistanceSteps;
      ++seen_count;
    }
    const bool all_seen = seen_count == static_cast<int>(b.weight.size());
    shape.put(static_cast<std::uint8_t>((all_seen ? kAllSeen : 0) | (all_free ? kAllFree : 0) |
                                        (b.hits.empty() ? 0 : kHasHits)));
    if (!all_seen) masks.put(mask);
    PredictionWindow window(blocks, at);
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      if (b.weight[i] == 0) continue;
      const std::size_t p = PredictionWindow::place(i);
      if (!all_free)
        distances.put(static_cast<std::uint8_t>(b.distance[i] - window.predicted_distance(p)));
      const std::uint64_t rest = zigzag(std::int64_t{b.weight[i]} - window.predicted_weight(p));
      weights.put(static_cast<std::uint8_t>(std::min<std::uint64_t>(rest, 255)));
      if (rest >= 255) put_varint(rests, rest - 255);
      window.set_distance(p, b.distance[i]);
      window.set_weight(p, b.weight[i]);
    }
    if (b.hits.empty()) continue;
    put_varint(keys, b.hits.size() - 1);
    std::uint64_t key = 0;
    for (const PatchHit& h : b.hits) {
      put_varint(keys, h.key - key);
      key = h.key + std::uint64_t{1};
      PatchHit& before = last[h.key & 7U];
      put_varint(hit_weights, zigzag(std::int64_t{h.weight} - before.weight));
      put_varint(passes, h.passed);
      for (std::size_t k = 0; k < 3; ++k) {
        means[k].put(static_cast<std::uint8_t>(h.position[k] - before.position[k]));
        means[3 + k].put(static_cast<std::uint8_t>(h.normal[k] - before.normal[k]));
      }
      before = h;
    }
  }
  ByteWriter all;
  const auto append = [&](const ByteWriter& stream) {
    all.put_array(std::span<const std::byte>(stream.bytes()));
  };
  for (const ByteWriter* stream :
       {&shape, &masks, &distances, &weights, &rests, &keys, &hit_weights, &passes})
    append(*stream);
  for (const ByteWriter& stream : means) append(stream);
  return all.take();
}

/// The blocks of the bytes. `most_weight`: of a voxel or hit, in units. Throws `Error` that begins
/// with `what` on anything but sound blocks in `box`. The caller has bounded `count`.
inline std::vector<PatchBlock> get_patch_blocks(std::span<const std::byte> bytes, std::size_t count,
                                                const BlockBox& box, std::uint32_t most_weight,
                                                const std::string& what) {
  ByteReader in(bytes, what);
  const auto sound = [&](bool ok, const char* why, PatchFault fault = PatchFault::malformed) {
    if (!ok) throw PatchError(fault, what + ": " + why);
  };
  std::vector<PatchBlock> blocks(count);
  std::vector<std::uint8_t> flags(count);
  std::uint64_t next = 0;
  const std::uint64_t places = count == 0 ? 0 : box.place(box.hi) + 1;
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint64_t skip = get_varint(in, what);
    sound(next < places && skip < places - next,
          "block out of its box; expected an undamaged patch");
    blocks[n].index = box.block_at(next + skip);
    next += skip + 1;
    flags[n] = in.get<std::uint8_t>();
    sound(flags[n] < 8, "block of an unknown kind; expected flags below 8");
  }
  // Seen voxels have weight 1 until their own is read.
  std::size_t seen = 0;
  for (std::size_t n = 0; n < count; ++n) {
    auto& w = blocks[n].weight;
    if ((flags[n] & kAllSeen) != 0) {
      w.fill(1);
      seen += w.size();
      continue;
    }
    const auto mask = in.get<std::array<std::uint8_t, TsdfMap::kBlockVoxels / 8>>();
    std::size_t own = 0;
    for (std::size_t i = 0; i < w.size(); ++i) own += w[i] = mask[i / 8] >> (i % 8) & 1U;
    sound(own < w.size(), "block of another kind than it says; expected an undamaged patch");
    sound(own > 0 || (flags[n] & kHasHits) != 0, "empty block; expected blocks that were seen");
    seen += own;
  }
  for (std::size_t n = 0; n < count; ++n) {
    PatchBlock& b = blocks[n];
    if ((flags[n] & kAllFree) != 0) {
      for (std::size_t i = 0; i < b.weight.size(); ++i)
        if (b.weight[i] != 0) b.distance[i] = kPatchDistanceSteps;
      continue;
    }
    bool free = true;
    PredictionWindow window(blocks, n);
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      if (b.weight[i] == 0) continue;
      const std::size_t p = PredictionWindow::place(i);
      const auto rest = in.get<std::uint8_t>();
      b.distance[i] =
          static_cast<std::int8_t>(static_cast<std::uint8_t>(window.predicted_distance(p) + rest));
      sound(b.distance[i] >= -kPatchDistanceSteps, "distance out of bounds; expected -127 to 127");
      free = free && b.distance[i] == kPatchDistanceSteps;
      window.set_seen(p, true);
      window.set_distance(p, b.distance[i]);
    }
    sound(!free, "block of another kind than it says; expected an undamaged patch");
  }
  const auto first = in.take(seen);
  std::size_t taken = 0;
  for (std::size_t n = 0; n < count; ++n) {
    PatchBlock& b = blocks[n];
    PredictionWindow window(blocks, n);
    for (std::size_t i = 0; i < b.weight.size(); ++i) {
      if (b.weight[i] == 0) continue;
      const std::size_t p = PredictionWindow::place(i);
      std::uint64_t rest = static_cast<std::uint8_t>(first[taken++]);
      if (rest == 255) {
        const std::uint64_t more = get_varint(in, what);
        sound(more <= std::uint64_t{4} * kPatchMaxWeight, "weight out of bounds",
              PatchFault::impossible_weight);
        rest += more;
      }
      const std::int64_t w = window.predicted_weight(p) + unzigzag(rest);
      sound(w >= 1 && w <= std::int64_t{most_weight}, "weight that no such images give",
            PatchFault::impossible_weight);
      b.weight[i] = static_cast<std::uint32_t>(w);
      window.set_weight(p, b.weight[i]);
    }
  }
  const auto each_hit = [&](auto&& read) {
    for (PatchBlock& b : blocks)
      for (PatchHit& h : b.hits) read(h);
  };
  for (std::size_t n = 0; n < count; ++n) {
    if ((flags[n] & kHasHits) == 0) continue;
    constexpr std::uint64_t kKeys = 8 * TsdfMap::kBlockVoxels;
    const std::uint64_t more = get_varint(in, what);
    sound(more < TsdfMap::kBlockVoxels * SurfaceHits::kSides && more < in.remaining(),
          "more hits than a block or the patch can have");
    std::vector<PatchHit>& hits = blocks[n].hits;
    hits.resize(static_cast<std::size_t>(more) + 1);
    std::uint64_t key = 0;
    for (PatchHit& h : hits) {
      const std::uint64_t skip = get_varint(in, what);
      sound(key < kKeys && skip < kKeys - key && ((key + skip) & 7) < SurfaceHits::kSides,
            "hit of a voxel or side that is none");
      h.key = static_cast<std::uint16_t>(key + skip);
      key += skip + 1;
    }
  }
  std::array<std::int64_t, 8> last_weight{};  // by side
  each_hit([&](PatchHit& h) {
    const std::uint64_t rest = get_varint(in, what);
    sound(rest <= std::uint64_t{4} * kPatchMaxWeight, "hit's weight out of bounds",
          PatchFault::impossible_weight);
    std::int64_t& w = last_weight[h.key & 7U];
    w += unzigzag(rest);
    sound(w >= 0 && w <= std::int64_t{most_weight}, "hit's weight that no such images give",
          PatchFault::impossible_weight);
    h.weight = static_cast<std::uint32_t>(w);
  });
  each_hit([&](PatchHit& h) {
    const std::uint64_t w = get_varint(in, what);
    sound(w <= most_weight, "hit's weight that no such images give", PatchFault::impossible_weight);
    h.passed = static_cast<std::uint32_t>(w);
    sound(h.weight != 0 || h.passed != 0, "hit without weight");
  });
  const auto means = [&](auto PatchHit::*values, int most) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<std::int8_t, 8> last{};  // by side
      each_hit([&](PatchHit& h) {
        std::int8_t& v = last[h.key & 7U];
        v = static_cast<std::int8_t>(static_cast<std::uint8_t>(v + in.get<std::uint8_t>()));
        sound(v >= -most && v <= most && (h.weight != 0 || v == 0), "hit out of its voxel");
        (h.*values)[k] = v;
      });
    }
  };
  means(&PatchHit::position, SurfaceHit::kSteps);
  means(&PatchHit::normal, SurfaceHit::kNormal);
  sound(in.remaining() == 0, "bytes after the last hit; expected the end");
  return blocks;
}

inline constexpr std::size_t kViewBytes = 3 * 4 + 3, kFailureBytes = 3 * 4 + 1;

inline Bytes put_view_notes(const ViewNotes& notes) {
  ByteWriter out;
  for (const ViewNotes::View& v : notes.views) {
    for (const int k : v.place) out.put(std::int32_t{k});
    out.put(v.direction);
  }
  for (const ViewNotes::Failure& f : notes.failures) {
    for (const int v : f.place) out.put(std::int32_t{v});
    out.put(f.count);
  }
  return out.take();
}
/// The notes but for their kind. `bytes` are as many as so many views and failures take, which the
/// caller has bounded. Throws `Error` that begins with `what` on notes that no robot makes.
inline void get_view_notes(std::span<const std::byte> bytes, std::size_t views,
                           std::size_t failures, ViewNotes& notes, const std::string& what) {
  ByteReader in(bytes, what);
  const auto sound = [&](bool ok, const char* why) {
    if (!ok) throw Error(what + ": " + why);
  };
  const auto place = [&] {
    VoxelKey p{};
    for (int& v : p) {
      v = in.get<std::int32_t>();
      sound(v >= -(1 << 29) && v < 1 << 29, "view outside the grid");
    }
    return p;
  };
  notes.views.reserve(views);
  for (std::size_t i = 0; i < views; ++i) {
    ViewNotes::View v{place(), in.get<ViewDirection>()};
    sound(is_view_direction(v.direction), "view without a direction");
    sound(i == 0 || notes.views.back() < v, "views out of order; expected each once");
    notes.views.push_back(v);
  }
  notes.failures.reserve(failures);
  for (std::size_t i = 0; i < failures; ++i) {
    ViewNotes::Failure f{place(), in.get<std::uint8_t>()};
    sound(f.count > 0, "path that was sought and not missed");
    sound(i == 0 || notes.failures.back().place < f.place,
          "failures out of order; expected each once");
    notes.failures.push_back(f);
  }
}
}  // namespace surfleet::detail
