// SPDX-License-Identifier: MIT
#include <surfleet/adapters/zstd_codec.hpp>

#include <array>

#include <surfleet/core/random.hpp>

#include "../mapping/patch_scenes.hpp"
#include "check.hpp"

using namespace surfleet;
using namespace surfleet::test;

TEST(patches_packed_by_zstd_are_smaller_and_the_same) {
  for (const int level : {1, 3, 12}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const MapPatch patch = random_patch(seed, static_cast<int>(seed));
      const EncodedPatch packed = encode_patch(patch, ZstdPacker{level});
      CHECK(packed.id == encode_patch(patch).id);
      CHECK(same_content(decode_patch(packed.bytes, {}, ZstdPacker{}), patch));
      CHECK_THROWS(Error, decode_patch(packed.bytes));
    }
    const MapPatch seen = sheet_patches(1).front();
    const EncodedPatch packed = encode_patch(seen, ZstdPacker{level});
    CHECK(static_cast<double>(packed.bytes.size()) < 0.7 * static_cast<double>(seen.seen()));
    CHECK(same_content(decode_patch(packed.bytes, {}, ZstdPacker{}), seen));
    CHECK(same_content(decode_patch(encode_patch(seen).bytes, {}, ZstdPacker{}), seen));
  }
}

TEST(zstd_frames_that_lie_are_refused) {
  const ZstdPacker zstd;
  Bytes raw(100000, std::byte{7});
  const Bytes frame = zstd.pack(raw);
  CHECK(frame.size() < 100 && zstd.unpack(frame, raw.size(), "frame") == raw);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, raw.size() - 1, raw.size() + 1})
    CHECK_THROWS(Error, zstd.unpack(frame, size, "frame"));
  CHECK_THROWS(Error, zstd.unpack({}, 0, "frame"));
  Bytes two = frame;
  two.insert(two.end(), frame.begin(), frame.end());
  CHECK_THROWS(Error, zstd.unpack(two, raw.size(), "frame"));
  for (std::size_t n = 0; n < frame.size(); ++n)
    CHECK_THROWS(Error, zstd.unpack(std::span(frame).first(n), raw.size(), "frame"));
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    Bytes bad = frame;
    bad[random.below(bad.size())] = static_cast<std::byte>(random.below(256));
    try {
      CHECK(zstd.unpack(bad, raw.size(), "frame").size() == raw.size());
    } catch (const Error&) {
    }
  }
}
