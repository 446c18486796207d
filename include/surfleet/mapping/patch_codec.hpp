// SPDX-License-Identifier: MIT
/// @file
/// @brief Map patches as messages: bytes, plain or packed, that are trusted in nothing.
///
/// Format, little-endian, no padding:
///
/// | bytes | content |
/// | --- | --- |
/// | 4 | magic `SFPT` |
/// | 1, 1 | version, 2; packing: 0 plain, 1 zstd (uint8) |
/// | 2 | voxels along a block's edge, 8 (uint16) |
/// | 12, 8 | robot, incarnation, number (uint32); content hash (uint64) |
/// | 4 | images (uint32) |
/// | 8, 8 | voxel size, truncation [m] (float64) |
/// | 24, 72 | anchor: position [m], rotation by rows (float64) |
/// | 24 | first and last block index of the box (6 × int32) |
/// | 4 | blocks (uint32) |
/// | 4, 4, 4 | kind of robot; its views in vain; places it found no path to view (uint32) |
/// | 4, 4 | bytes of what follows unpacked; bytes that follow (uint32) |
/// | … | the blocks, then the notes, as `detail/patch_payload.hpp` says, packed |
/// | 4 | CRC-32 of everything before (uint32) |
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/detail/patch_payload.hpp>
#include <surfleet/mapping/patch_limits.hpp>

namespace surfleet {
/// What makes bytes fewer.
///
/// - `packing()`: its number in the header.
/// - `pack(bytes)`.
/// - `unpack(bytes, size, what)`: the `size` bytes that were packed; throws `Error` that begins
///   with `what` on anything else, and allocates no more than that.
///
/// Models: `PlainPacker`, `ZstdPacker` (`adapters/zstd_codec.hpp`), `AnyPacker`, any of them.
template <typename P>
concept BytePacker = requires(const P& p, std::span<const std::byte> b, const std::string& what) {
  { p.packing() } -> std::same_as<std::uint8_t>;
  { p.pack(b) } -> std::same_as<Bytes>;
  { p.unpack(b, std::size_t{}, what) } -> std::same_as<Bytes>;
};

/// Leaves bytes as they are.
struct PlainPacker {
  static constexpr std::uint8_t packing() { return 0; }
  Bytes pack(std::span<const std::byte> bytes) const { return {bytes.begin(), bytes.end()}; }
  Bytes unpack(std::span<const std::byte> bytes, std::size_t size, const std::string& what) const {
    require(bytes.size() == size, what + ": " + std::to_string(bytes.size()) +
                                      " bytes of blocks; expected " + std::to_string(size));
    return {bytes.begin(), bytes.end()};
  }
};
static_assert(BytePacker<PlainPacker>);

/// A packer chosen at run time; by default a plain one.
class AnyPacker {
 public:
  template <BytePacker P = PlainPacker>
  requires(!std::same_as<P, AnyPacker>) AnyPacker(P p = {})
      : packing_(p.packing()), pack_(pack_by(p)), unpack_(unpack_by(p)) {}

  std::uint8_t packing() const { return packing_; }
  Bytes pack(std::span<const std::byte> bytes) const { return pack_(bytes); }
  Bytes unpack(std::span<const std::byte> bytes, std::size_t size, const std::string& what) const {
    return unpack_(bytes, size, what);
  }

 private:
  using Pack = std::function<Bytes(std::span<const std::byte>)>;
  using Unpack = std::function<Bytes(std::span<const std::byte>, std::size_t, const std::string&)>;
  template <BytePacker P>
  static Pack pack_by(P p) {
    return [p](std::span<const std::byte> bytes) { return p.pack(bytes); };
  }
  template <BytePacker P>
  static Unpack unpack_by(P p) {
    return [p](std::span<const std::byte> bytes, std::size_t size, const std::string& what) {
      return p.unpack(bytes, size, what);
    };
  }
  std::uint8_t packing_;
  Pack pack_;
  Unpack unpack_;
};
static_assert(BytePacker<AnyPacker>);

namespace detail {
inline constexpr std::array<char, 4> kPatchMagic{'S', 'F', 'P', 'T'};
inline constexpr std::uint8_t kPatchVersion = 2;
inline constexpr std::size_t kPatchHeaderBytes = 4 + 2 + 2 + 20 + 4 + 16 + 96 + 24 + 4 + 12 + 8;
/// Fewest and most bytes of a block before it is packed, without its hits: place, flags and a mask;
/// and with all voxels. Most of a hit, and most hits of a block.
inline constexpr std::size_t kLeastPatchBlock = 2 + TsdfMap::kBlockVoxels / 8;
inline constexpr std::size_t kMostPatchBlock = 10 + 65 + TsdfMap::kBlockVoxels * (2 + 5) + 2;
inline constexpr std::size_t kMostPatchHit = 3 + 5 + 5 + 6;
inline constexpr std::size_t kMostBlockHits = TsdfMap::kBlockVoxels * SurfaceHits::kSides;
/// So that places in a box fit 63 bits.
inline constexpr std::int64_t kMostPatchExtent = std::int64_t{1} << 20;

inline std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t seed) {
  std::uint64_t h = mix64(seed ^ bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    h = mix64(h ^ word);
  }
  return h;
}
/// What of the header is content: not the name, nor how it is packed.
inline Bytes patch_facts(const MapPatch& patch, const BlockBox& box) {
  ByteWriter out;
  out.put(patch.images);
  out.put(patch.voxel_size);
  out.put(patch.truncation);
  for (int k = 0; k < 3; ++k) out.put(double{patch.anchor.translation()[k]});
  for (int k = 0; k < 9; ++k) out.put(double{patch.anchor.linear()(k / 3, k % 3)});
  for (int k = 0; k < 3; ++k) out.put(std::int32_t{box.lo[k]});
  for (int k = 0; k < 3; ++k) out.put(std::int32_t{box.hi[k]});
  out.put(static_cast<std::uint32_t>(patch.blocks.size()));
  out.put(patch.notes.kind);
  out.put(static_cast<std::uint32_t>(patch.notes.views.size()));
  out.put(static_cast<std::uint32_t>(patch.notes.failures.size()));
  return out.take();
}
}  // namespace detail

/// A patch's name in full, and its bytes, which are never changed.
struct EncodedPatch {
  PatchId id;
  Bytes bytes;
};

/// The patch as bytes of the format above, with the hash of its content: the same for every packer.
/// Throws `Error` on a patch that no decoder would take: blocks out of order, of the grid or too
/// far apart.
template <BytePacker Packer = PlainPacker>
EncodedPatch encode_patch(const MapPatch& patch, const Packer& packer = {}) {
  const detail::BlockBox box = detail::box_of(patch.blocks);
  for (int k = 0; k < 3; ++k)
    require(box.extent(k) <= detail::kMostPatchExtent, "patch: blocks too far apart");
  for (std::size_t i = 1; i < patch.blocks.size(); ++i)
    require(patch_order(patch.blocks[i - 1].index, patch.blocks[i].index),
            "patch: blocks out of order; expected each once, by z, y and x");
  const Bytes facts = detail::patch_facts(patch, box);
  Bytes payload = detail::put_patch_blocks(patch.blocks, box);
  const Bytes notes = detail::put_view_notes(patch.notes);
  payload.insert(payload.end(), notes.begin(), notes.end());
  const Bytes packed = packer.pack(payload);
  PatchId id = patch.id;
  id.hash = detail::hash_of(payload, detail::hash_of(facts, 0));
  ByteWriter out;
  out.put(detail::kPatchMagic);
  out.put(detail::kPatchVersion);
  out.put(packer.packing());
  out.put(static_cast<std::uint16_t>(TsdfMap::kBlockSide));
  out.put(id.key.robot);
  out.put(id.key.incarnation);
  out.put(id.key.number);
  out.put(id.hash);
  out.put_array(std::span<const std::byte>(facts));
  out.put(static_cast<std::uint32_t>(payload.size()));
  out.put(static_cast<std::uint32_t>(packed.size()));
  out.put_array(std::span<const std::byte>(packed));
  out.put(crc32(out.bytes()));
  return {id, out.take()};
}

/// The patch of the bytes, plain or packed as `Packer` packs. Throws `PatchError`, or `Error`, that
/// begins with `what` on anything but a whole, sound patch of this version within the limits,
/// before it allocates more than these allow the images that it is said to be of.
template <BytePacker Packer = PlainPacker>
MapPatch decode_patch(std::span<const std::byte> bytes, const PatchLimits& limits = {},
                      const Packer& packer = {}, const std::string& what = "patch") {
  const auto sound = [&](bool ok, const char* why, PatchFault fault = PatchFault::malformed) {
    if (!ok) throw PatchError(fault, what + ": " + why);
  };
  ByteReader in(bytes, what);
  sound(bytes.size() >= detail::kPatchHeaderBytes + 4, "ends early; expected a whole header");
  sound(in.get<std::array<char, 4>>() == detail::kPatchMagic, "expected it to begin with SFPT");
  sound(in.get<std::uint8_t>() == detail::kPatchVersion, "of another version; expected 2");
  const auto packing = in.get<std::uint8_t>();
  sound(packing == PlainPacker::packing() || packing == packer.packing(),
        "packed in a way that is not known here");
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + bytes.size() - 4, sizeof(stored));
  sound(stored == crc32(bytes.first(bytes.size() - 4)), "checksum does not match",
        PatchFault::checksum);
  sound(in.get<std::uint16_t>() == TsdfMap::kBlockSide, "blocks of another size; expected 8");

  MapPatch patch;
  patch.id.key.robot = in.get<std::uint32_t>();
  patch.id.key.incarnation = in.get<std::uint32_t>();
  patch.id.key.number = in.get<std::uint32_t>();
  patch.id.hash = in.get<std::uint64_t>();
  const std::size_t facts_at = in.position();
  patch.images = in.get<std::uint32_t>();
  sound(patch.images <= limits.images, "made of too many images", PatchFault::bomb);
  patch.voxel_size = in.get<double>();
  patch.truncation = in.get<double>();
  sound(patch.voxel_size > 0.0 && std::isfinite(patch.voxel_size) &&
            patch.voxel_size == limits.voxel_size.value_or(patch.voxel_size),
        "of another voxel size");
  sound(patch.truncation > 0.0 && std::isfinite(patch.truncation) &&
            patch.truncation == limits.truncation.value_or(patch.truncation),
        "of another truncation");
  for (int k = 0; k < 3; ++k) patch.anchor.translation()[k] = in.get<double>();
  Eigen::Matrix3d rotation;
  for (int k = 0; k < 9; ++k) rotation(k / 3, k % 3) = in.get<double>();
  sound(patch.anchor.translation().allFinite() && rotation.allFinite() &&
            (rotation.transpose() * rotation).isIdentity(1e-6) && rotation.determinant() > 0.0,
        "anchor: expected a finite position and a rotation");
  patch.anchor.linear() = rotation;
  sound(limits.places.isEmpty() || patch.images == 0 ||
            limits.places.contains(patch.anchor.translation()),
        "images of where no robot can be", PatchFault::out_of_reach);

  detail::BlockBox box;
  for (int k = 0; k < 3; ++k) box.lo[k] = in.get<std::int32_t>();
  for (int k = 0; k < 3; ++k) box.hi[k] = in.get<std::int32_t>();
  const std::size_t count = in.get<std::uint32_t>();
  patch.notes.kind = in.get<std::uint32_t>();
  const std::size_t views = in.get<std::uint32_t>(), failures = in.get<std::uint32_t>();
  const std::size_t facts_end = in.position();
  const std::size_t size = in.get<std::uint32_t>(), packed = in.get<std::uint32_t>();
  double places = count == 0 ? 0.0 : 1.0;
  const double side = TsdfMap::kBlockSide * patch.voxel_size;
  for (int k = 0; k < 3 && count > 0; ++k) {
    constexpr int kLimit = (1 << 30) / TsdfMap::kBlockSide;
    sound(box.lo[k] >= -kLimit && box.hi[k] < kLimit, "box outside the grid");
    sound(box.extent(k) > 0 && box.extent(k) <= detail::kMostPatchExtent,
          "box: expected a first block before the last");
    const double at = patch.anchor.translation()[k];
    sound(box.lo[k] * side >= at - limits.reach && (box.hi[k] + 1.0) * side <= at + limits.reach,
          "blocks out of reach of its images", PatchFault::out_of_reach);
    places *= static_cast<double>(box.extent(k));
  }
  sound(count <= limits.most_blocks(patch.images) && static_cast<double>(count) <= places,
        "more blocks than its box, its images or a patch can have", PatchFault::bomb);
  sound(views <= limits.notes && failures <= limits.notes, "more views in vain than it may have",
        PatchFault::bomb);
  const std::size_t notes_size = views * detail::kViewBytes + failures * detail::kFailureBytes;
  const std::size_t hits =
      std::min<std::uint64_t>(count * detail::kMostBlockHits, limits.most_hits(patch.images));
  sound(size >= count * detail::kLeastPatchBlock + notes_size &&
            size <= count * detail::kMostPatchBlock + hits * detail::kMostPatchHit + notes_size,
        "blocks of a size that they cannot have", PatchFault::bomb);
  sound(packed + 4 == in.remaining(), "of another length than it says");
  const auto rest = in.take(packed);
  const Bytes payload = packing == PlainPacker::packing() ? PlainPacker{}.unpack(rest, size, what)
                                                          : packer.unpack(rest, size, what);
  sound(detail::hash_of(payload, detail::hash_of(bytes.subspan(facts_at, facts_end - facts_at),
                                                 0)) == patch.id.hash,
        "content is not what its hash says");
  const double most = patch.images * limits.image_weight / kPatchWeightUnit;
  const auto view = std::span<const std::byte>(payload);
  patch.blocks = detail::get_patch_blocks(
      view.first(size - notes_size), count, box,
      most < kPatchMaxWeight ? static_cast<std::uint32_t>(most) : kPatchMaxWeight, what);
  detail::get_view_notes(view.last(notes_size), views, failures, patch.notes, what);
  const double place = kViewPlaceVoxels * patch.voxel_size;
  const auto near = [&](const VoxelKey& p) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(place * p[k] - patch.anchor.translation()[static_cast<int>(k)]) <=
            limits.reach))
        return false;
    return true;
  };
  for (const ViewNotes::View& v : patch.notes.views)
    sound(near(v.place), "views out of reach of its images", PatchFault::out_of_reach);
  for (const ViewNotes::Failure& f : patch.notes.failures)
    sound(near(f.place), "views out of reach of its images", PatchFault::out_of_reach);
  return patch;
}
}  // namespace surfleet
