// SPDX-License-Identifier: MIT
#include <surfleet/mapping/map_file.hpp>

#include <cstring>
#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
TsdfMap sample_map(std::uint64_t seed, int blocks = 12) {
  Random random(seed);
  TsdfMap map({.voxel_size = 0.3});
  for (int b = 0; b < blocks; ++b) {
    const std::uint32_t slot = map.ensure_slot({static_cast<int>(random.below(2000)) - 1000,
                                                static_cast<int>(random.below(4)) - 2,
                                                static_cast<int>(random.below(4)) - 2});
    const std::uint64_t kind = random.below(3);
    for (TsdfVoxel& v : map.block(slot).voxels) {
      if (kind == 0 && random.below(5) != 0) continue;
      v.distance = kind == 1 ? 0.9F : static_cast<float>(random.uniform(-0.9, 0.9));
      v.weight = static_cast<float>(random.uniform(0.01, 10.0));
    }
    map.mark_changed(slot);
  }
  return map;
}

bool equal(const TsdfMap& a, const TsdfMap& b) {
  if (a.voxel_size() != b.voxel_size() || a.block_count() != b.block_count()) return false;
  for (std::uint32_t s = 0; s < a.block_count(); ++s) {
    if (a.block(s).index != b.block(s).index) return false;
    for (std::size_t i = 0; i < TsdfMap::kBlockVoxels; ++i) {
      const TsdfVoxel &u = a.block(s).voxels[i], &v = b.block(s).voxels[i];
      if (u.distance != v.distance || u.weight != v.weight) return false;
    }
  }
  return true;
}

void mend(Bytes& bytes) {
  const std::uint32_t sum = crc32(std::span<const std::byte>(bytes).first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof(sum));
}
template <typename T>
void poke(Bytes& bytes, std::size_t at, const T& value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
  mend(bytes);
}
constexpr std::size_t kCountAt = 24, kFirstBlock = 32;
}  // namespace

TEST(round_trip_keeps_every_voxel) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TsdfMap map = sample_map(seed);
    CHECK(equal(map, decode_map(encode_map(map))));
    CHECK(equal(map, decode_map(encode_map(map, {.compact = false}))));
    CHECK(encode_map(map).size() <= encode_map(map, {.compact = false}).size());
    const TsdfMap back = decode_map(encode_map(map));
    CHECK(back.changed_since(0).size() == back.block_count());
  }
  const TsdfMap empty({.voxel_size = 1e-3});
  CHECK(equal(empty, decode_map(encode_map(empty))));
}

TEST(blocks_without_weight_are_left_out_on_request) {
  TsdfMap map;
  map.ensure({0, 0, 0});
  CHECK(decode_map(encode_map(map)).block_count() == 0);
  CHECK(decode_map(encode_map(map, {.skip_unseen = false})).block_count() == 1);
}

TEST(files_of_version_1_are_read) {
  // One block, level, without anything behind its weights but the checksum.
  ByteWriter out;
  out.put_text("SFLTTSDF");
  out.put(std::uint32_t{1});
  out.put(std::uint32_t{8});
  out.put(0.2);
  out.put(std::uint64_t{1});
  for (const std::int32_t i : {4, -5, 6}) out.put(i);
  out.put(std::uint8_t{2});
  out.put(0.25F);
  for (int i = 0; i < 512; ++i) out.put(static_cast<float>(i));
  out.put(crc32(out.bytes()));
  const TsdfMap map = decode_map(out.bytes());
  CHECK(map.block_count() == 1 && map.block(0).index == BlockIndex(4, -5, 6));
  CHECK(map.block(0).layer.empty());
  CHECK(map.block(0).voxels[37].distance == 0.25F && map.block(0).voxels[37].weight == 37.0F);
}

TEST(hits_that_no_rays_give_are_refused) {
  const auto with = [](const SurfaceHit& hit) {
    TsdfMap map({.voxel_size = 0.1});
    const std::uint32_t slot = map.ensure_slot({0, 0, 0});
    map.block(slot).layer.ensure(hit.key) = hit;
    return encode_map(map);
  };
  const SurfaceHit good{.key = SurfaceHits::key_of(511, 5),
                        .weight = 1000,
                        .passed = 3,
                        .position = {64000, -64000, 5},
                        .normal = {-1, 64000, 0}};
  const TsdfMap back = decode_map(with(good));
  CHECK(back.block(0).layer.size() == 1 && back.block(0).layer.hits()[0] == good);
  for (int bad = 0; bad < 6; ++bad) {
    SurfaceHit h = good;
    if (bad == 0) h.key = SurfaceHits::key_of(512, 0);
    if (bad == 1) h.key = SurfaceHits::key_of(3, 6);
    if (bad == 2) h.weight = std::int64_t{1} << 51;
    if (bad == 3) h.position[1] = 64001;
    if (bad == 4) h.normal[2] = -64001;
    if (bad == 5) h.passed = -1;
    CHECK_THROWS(Error, decode_map(with(h)));
  }
  // A number of hits that the file cannot hold.
  Bytes bytes = with(good);
  const std::size_t count_at = bytes.size() - 4 - 17 - 4;  // checksum, hit, count
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + count_at, 4);
  CHECK(count == 1);
  poke(bytes, count_at, std::uint32_t{0xFFFFFFFF});
  CHECK_THROWS(Error, decode_map(bytes));
}

TEST(files_are_saved_and_loaded) {
  const auto path = std::filesystem::temp_directory_path() / "surfleet_map_file_test.map";
  const TsdfMap map = sample_map(5);
  save_map(map, path);
  CHECK(equal(map, load_map(path)));
  std::filesystem::remove(path);
  CHECK_THROWS(Error, load_map(path));
  CHECK_THROWS(Error, save_map(map, path / "no" / "such" / "folder.map"));
}

TEST(every_truncation_and_every_flipped_byte_is_refused) {
  const Bytes good = encode_map(sample_map(1, 3));
  for (std::size_t n = 0; n < good.size(); n += n < 200 ? 1 : 97)
    CHECK_THROWS(Error, decode_map(std::span<const std::byte>(good).first(n)));
  Random random(2);
  for (std::size_t i = 0; i < good.size(); i += i < 200 ? 1 : 53) {
    Bytes bad = good;
    bad[i] ^= static_cast<std::byte>(1 + random.below(255));
    CHECK_THROWS(Error, decode_map(bad));
  }
}

TEST(sound_checksums_over_unsound_content_are_refused) {
  TsdfMap map({.voxel_size = 0.1});
  for (int b = 0; b < 2; ++b) {
    const std::uint32_t slot = map.ensure_slot({b, 0, 0});
    for (TsdfVoxel& v : map.block(slot).voxels) v = {0.1F * static_cast<float>(b), 1.0F};
    map.block(slot).voxels[3].distance = 0.05F;
  }
  const Bytes good = encode_map(map);
  CHECK(equal(map, decode_map(good)));
  const auto refused = [&](std::size_t at, const auto& value) {
    Bytes bad = good;
    poke(bad, at, value);
    CHECK_THROWS(Error, decode_map(bad));
  };
  refused(8, std::uint32_t{0});  // version
  refused(8, std::uint32_t{3});
  refused(12, std::uint32_t{16});  // block side
  refused(16, -0.1);               // voxel size
  refused(16, std::numeric_limits<double>::quiet_NaN());
  refused(kCountAt, std::uint64_t{1} << 60);  // a giant map
  refused(kCountAt, std::uint64_t{3});
  refused(kCountAt, std::uint64_t{1});                             // bytes left over
  refused(kFirstBlock, std::int32_t{1});                           // a block twice
  refused(kFirstBlock, std::numeric_limits<std::int32_t>::max());  // outside the grid
  refused(kFirstBlock, std::numeric_limits<std::int32_t>::min());
  refused(kFirstBlock + 12, std::uint8_t{9});                         // kind
  refused(kFirstBlock + 13, std::numeric_limits<float>::infinity());  // distance
  refused(kFirstBlock + 17, -1.0F);                                   // weight
}

TEST(random_mutations_never_do_worse_than_throw) {
  const Bytes good = encode_map(sample_map(4, 2));
  Random random(9);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes = good;
    for (std::uint64_t k = 1 + random.below(4); k > 0; --k)
      bytes[random.below(round % 2 == 0 ? 64 : bytes.size())] =
          static_cast<std::byte>(random.below(256));
    mend(bytes);
    try {
      const TsdfMap map = decode_map(bytes);
      CHECK(encode_map(decode_map(encode_map(map))) == encode_map(map));
    } catch (const Error&) {
    }
  }
}

TEST(merging_adds_observations) {
  TsdfMap a({.voxel_size = 0.5}), b({.voxel_size = 0.5});
  a.ensure({0, 0, 0}) = {0.2F, 1.0F};
  b.ensure({0, 0, 0}) = {-0.1F, 2.0F};
  b.ensure({-1, 0, 0}) = {0.3F, 600.0F};
  b.ensure({100, 0, 0});
  CHECK(merge_maps(a, b) == 2);
  CHECK_NEAR(a.find({0, 0, 0})->distance, 0.0, 1e-6);
  CHECK_NEAR(a.find({0, 0, 0})->weight, 3.0, 1e-6);
  CHECK(a.block_count() == 2 && a.changed_since(0).size() == 2);
  merge_maps(a, b);
  CHECK(a.find({-1, 0, 0})->weight == 1000.0F);
  CHECK_THROWS(Error, merge_maps(a, TsdfMap{{.voxel_size = 0.4}}));
}
