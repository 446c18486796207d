// SPDX-License-Identifier: MIT
/// @file
/// @brief Feeds bytes to the decoder of map patches; what it accepts must survive a round trip.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include <surfleet/adapters/zstd_codec.hpp>
#include <surfleet/mapping/patch_codec.hpp>

namespace {
using namespace surfleet;
using Packer = ZstdPacker;

/// The hash that a sound header of these bytes would hold, and the checksum.
void mend(Bytes& bytes) {
  constexpr std::size_t kHash = 20, kFacts = 28, kSizes = detail::kPatchHeaderBytes - 8;
  if (bytes.size() < detail::kPatchHeaderBytes + 4) return;
  const auto view = std::span<const std::byte>(bytes);
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + kSizes, sizeof(size));
  const auto rest =
      view.subspan(detail::kPatchHeaderBytes, bytes.size() - detail::kPatchHeaderBytes - 4);
  try {
    Bytes blocks(rest.begin(), rest.end());
    if (bytes[5] != std::byte{0} && size <= 1 << 22) blocks = Packer{}.unpack(rest, size, "blocks");
    const std::uint64_t hash =
        detail::hash_of(blocks, detail::hash_of(view.subspan(kFacts, kSizes - kFacts), 0));
    std::memcpy(bytes.data() + kHash, &hash, sizeof(hash));
  } catch (const Error&) {
  }
  const std::uint32_t sum = crc32(std::span<const std::byte>(bytes).first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof(sum));
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  // As it is, and with hash and checksum put right, so that mutations reach the parser.
  for (const bool mended : {false, true}) {
    Bytes bytes(input.begin(), input.end());
    if (mended) mend(bytes);
    try {
      const MapPatch patch = decode_patch(bytes, {}, Packer{});
      for (const PatchBlock& b : patch.blocks)
        if (b.empty()) std::abort();
      const EncodedPatch once = encode_patch(patch);
      const MapPatch again = decode_patch(once.bytes);
      if (again.blocks != patch.blocks || !(again.notes == patch.notes) ||
          encode_patch(again).bytes != once.bytes)
        std::abort();
    } catch (const Error&) {
    }
  }
  return 0;
}
