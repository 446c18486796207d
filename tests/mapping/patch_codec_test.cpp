// SPDX-License-Identifier: MIT
#include <surfleet/mapping/patch_codec.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"
#include "patch_scenes.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
/// Drops runs of zeros: not much of a packer, but another.
struct RunPacker {
  static constexpr std::uint8_t packing() { return 7; }
  Bytes pack(std::span<const std::byte> bytes) const {
    Bytes out;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      out.push_back(bytes[i]);
      if (bytes[i] != std::byte{0}) continue;
      std::size_t run = 1;
      while (run < 255 && i + run < bytes.size() && bytes[i + run] == std::byte{0}) ++run;
      out.push_back(static_cast<std::byte>(run));
      i += run - 1;
    }
    return out;
  }
  Bytes unpack(std::span<const std::byte> bytes, std::size_t size, const std::string& what) const {
    Bytes out;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      std::size_t run = 1;
      if (bytes[i] == std::byte{0}) {
        require(++i < bytes.size(), what + ": run");
        run = static_cast<std::size_t>(bytes[i]);
        require(run <= size - out.size(), what + ": run");
        out.insert(out.end(), run, std::byte{0});
      } else {
        out.push_back(bytes[i]);
      }
    }
    require(out.size() == size, what + ": size");
    return out;
  }
};
static_assert(BytePacker<RunPacker> && !BytePacker<int>);
/// Tells what it was asked to make room for.
struct WatchedPacker : RunPacker {
  static inline std::size_t asked = 0;
  Bytes unpack(std::span<const std::byte> bytes, std::size_t size, const std::string& what) const {
    asked += size;
    return RunPacker::unpack(bytes, size, what);
  }
};

template <typename T>
Bytes with(Bytes bytes, std::size_t at, const T& value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
  const std::uint32_t sum = crc32(std::span<const std::byte>(bytes).first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof(sum));
  return bytes;
}
constexpr std::size_t kImagesAt = 28, kVoxelAt = 32, kAnchorAt = 48, kBoxAt = 144, kBlocksAt = 168,
                      kViewsAt = 176, kFailuresAt = 180, kSizeAt = 184, kPackedAt = 188;
template <typename P>
bool refused(const Bytes& bytes, const PatchLimits& limits, const P& packer) {
  try {
    static_cast<void>(decode_patch(bytes, limits, packer));
  } catch (const Error&) {
    return true;
  }
  return false;
}
/// Whether it is refused for that reason, before room is made for its content.
bool faulty(PatchFault fault, const Bytes& bytes, const PatchLimits& limits) {
  WatchedPacker::asked = 0;
  try {
    static_cast<void>(decode_patch(bytes, limits, WatchedPacker{}));
  } catch (const PatchError& e) {
    return e.fault() == fault && (fault == PatchFault::impossible_weight || !WatchedPacker::asked);
  }
  return false;
}
template <BytePacker P>
void patch_codec_laws(const P& packer) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const MapPatch patch = random_patch(seed, static_cast<int>(seed % 13));
    const EncodedPatch once = encode_patch(patch, packer);
    const MapPatch back = decode_patch(once.bytes, {}, packer);
    CHECK(same_content(patch, back));
    CHECK(encode_patch(back, packer).bytes == once.bytes);
    CHECK(back.id == once.id && once.id.hash == encode_patch(patch).id.hash);
    CHECK(once.bytes.size() >= detail::kPatchHeaderBytes + 4);
  }
  // Cut short, lengthened, or with any byte changed, it is no patch.
  const Bytes good = encode_patch(random_patch(3, 3), packer).bytes;
  for (std::size_t n = 0; n < good.size(); n += 7)
    CHECK(refused(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)), {}, packer));
  Bytes longer = good;
  longer.push_back(std::byte{0});
  CHECK(refused(longer, {}, packer) && refused(with(longer, 0, good[0]), {}, packer));
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    const std::size_t at = random.below(good.size() - 4);
    const std::byte b = good[at] ^ static_cast<std::byte>(1 + random.below(255));
    Bytes bad = good;
    bad[at] = b;
    CHECK(refused(bad, {}, packer));
    // With its checksum put right, what is no name is still told by the content's hash.
    if (at >= 20 && at < detail::kPatchHeaderBytes) CHECK(refused(with(good, at, b), {}, packer));
    if (at >= detail::kPatchHeaderBytes && packer.packing() == 0)
      CHECK(refused(with(good, at, b), {}, packer));
  }
}
/// A plain patch with another value, its hash and checksum put right.
Bytes lying(Bytes bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
  const auto view = std::span<const std::byte>(bytes);
  constexpr std::size_t kHead = detail::kPatchHeaderBytes;
  const std::uint64_t hash =
      detail::hash_of(view.subspan(kHead, bytes.size() - 4 - kHead),
                      detail::hash_of(view.subspan(kImagesAt, kSizeAt - kImagesAt), 0));
  return with(std::move(bytes), 20, hash);
}
/// As a liar would: the hash is right as well.
Bytes forged(MapPatch patch) { return encode_patch(patch).bytes; }
}  // namespace

TEST(patches_survive_the_wire_and_nothing_else_does) {
  patch_codec_laws(PlainPacker{});
  patch_codec_laws(RunPacker{});
  patch_codec_laws(AnyPacker{});
  patch_codec_laws(AnyPacker(RunPacker{}));
}

TEST(patches_beyond_the_limits_are_refused) {
  const MapPatch patch = random_patch(11, 6);
  const Bytes good = forged(patch);
  CHECK(!refused(good, {}, PlainPacker{}));
  CHECK(!refused(good, {.voxel_size = 0.3, .truncation = 0.9}, PlainPacker{}));
  CHECK(refused(good, {.voxel_size = 0.2}, PlainPacker{}));
  CHECK(refused(good, {.truncation = 0.6}, PlainPacker{}));
  CHECK(refused(good, {.images = 4}, PlainPacker{}));
  CHECK(refused(good, {.image_weight = 0.01}, PlainPacker{}));
  CHECK(refused(good, {.reach = 2.0}, PlainPacker{}));
  CHECK(refused(good, {.blocks = 2}, PlainPacker{}));
  const Bytes packed = encode_patch(patch, RunPacker{}).bytes;
  CHECK(refused(packed, {}, PlainPacker{}));  // packed in a way it does not know
  CHECK(!refused(good, {}, RunPacker{}));     // plain is always understood
  MapPatch none = patch;
  none.images = 0;
  CHECK(refused(forged(none), {}, PlainPacker{}));
  none.blocks.clear();
  CHECK(!refused(forged(none), {}, PlainPacker{}));
  MapPatch odd = patch;
  odd.anchor.translation().x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(forged(odd), {}, PlainPacker{}));
  odd = patch;
  odd.anchor.translation().x() = 1e6;
  CHECK(refused(forged(odd), {}, PlainPacker{}));
  odd = patch;
  odd.blocks.push_back(odd.blocks.front());
  CHECK_THROWS(Error, encode_patch(odd));
  odd.blocks.back().index = {0, 0, 1 << 25};
  CHECK_THROWS(Error, encode_patch(odd));
  odd = patch;
  odd.blocks[0].hits = {{.key = 7, .weight = 1}};
  CHECK(refused(forged(odd), {}, PlainPacker{}));
  odd.blocks[0].hits = {{.key = 4097, .weight = 1}};
  CHECK(refused(forged(odd), {}, PlainPacker{}));
  odd.blocks[0].hits = {{.key = 8}};
  CHECK(refused(forged(odd), {}, PlainPacker{}));
  odd.blocks[0].hits = {{.key = 8, .weight = 1, .position = {65, 0, 0}}};
  CHECK(refused(forged(odd), {}, PlainPacker{}));
}

/// One voxel a block, as many as that in a box of `side` blocks a side.
MapPatch wide_patch(std::uint64_t blocks, std::uint32_t images, int side) {
  MapPatch patch;
  patch.images = images;
  for (std::uint64_t n = 0; n < blocks; ++n) {
    const int i = static_cast<int>(n);
    PatchBlock b;
    b.index =
        BlockIndex(i % side, i / side % side, i / side / side) - BlockIndex::Constant(side / 2);
    b.weight[n % 512] = 1;
    patch.blocks.push_back(b);
  }
  return patch;
}
TEST(patches_are_as_large_as_their_images_can_show_and_no_larger) {
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 80, 60, 0.2, 3.0);
  const LidarModel lidar{.azimuths = 90, .elevations = 31, .max_range = 3.0};
  DepthImage far(camera.width, camera.height);
  std::fill(far.depth.begin(), far.depth.end(), 50.0F);
  LidarScan all_around;
  for (int a = 0; a < lidar.azimuths; ++a)
    for (int e = 0; e < lidar.elevations; ++e) all_around.points.push_back(50.0 * lidar.beam(a, e));
  // Of free space there is most to show.
  for (const double voxel : {0.05, 0.1, 0.3})
    for (const bool scans : {false, true}) {
      const SensorModel sensor = scans ? SensorModel(lidar) : SensorModel(camera);
      const PatchLimits limits = patch_limits(sensor, voxel, 3.0 * voxel);
      PatchRecorder recorder({.voxel_size = voxel, .images = 4},
                             TsdfIntegrator({.truncation = 3.0 * voxel}));
      while (!recorder.due()) {
        Pose pose = Pose::Identity();
        pose.linear() = Eigen::AngleAxisd(1.5 * recorder.images() + 0.3,
                                          Eigen::Vector3d(0.2, 1.0, 0.4).normalized())
                            .toRotationMatrix();
        if (scans)
          recorder.integrate(all_around, lidar, pose);
        else
          recorder.integrate(far, camera, pose);
        CHECK(recorder.open().block_count() <= limits.most_blocks(recorder.images()));
      }
      for (const MapPatch& p : recorder.close({}, limits))
        CHECK(!refused(encode_patch(p).bytes, limits, PlainPacker{}));
    }
  const PatchLimits fine = patch_limits(lidar, 0.01, 0.03);
  CHECK(fine.most_blocks(1) == fine.blocks && fine.most_hits(1) == fine.hits);
  CHECK(detail::kPatchHeaderBytes + 4 + fine.blocks * detail::kMostPatchBlock +
            fine.hits * detail::kMostPatchHit +
            fine.notes * (detail::kViewBytes + detail::kFailureBytes) <
        std::size_t{16} << 20);
  // A block more than images can give is a bomb.
  const PatchLimits limits = patch_limits(
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 80, 60, 0.1, 1.0), 0.3, 0.9);
  for (const std::uint32_t images : {1U, 2U, 3U}) {
    const std::uint64_t most = limits.most_blocks(images);
    CHECK(most == images * limits.image_blocks && most > 50 && most < 1000);
    CHECK(!refused(encode_patch(wide_patch(most, images, 10), WatchedPacker{}).bytes, limits,
                   WatchedPacker{}));
    const MapPatch more = wide_patch(most + 1, images, 10);
    CHECK(faulty(PatchFault::bomb, encode_patch(more, WatchedPacker{}).bytes, limits));
  }
  // Nor does a content that declares hundreds of megabytes get any, whatever else is as it may be.
  const Bytes good = encode_patch(wide_patch(300, 3, 10), WatchedPacker{}).bytes;
  CHECK(!refused(good, limits, WatchedPacker{}));
  for (const std::uint32_t size : {900'000'000U, 100'000'000U, 20'000'000U})
    CHECK(faulty(PatchFault::bomb, with(good, kSizeAt, size), limits));
  CHECK(faulty(PatchFault::bomb, with(good, kBlocksAt, 16384U), limits));
  CHECK(faulty(PatchFault::bomb, with(good, kImagesAt, 5000U), limits));
  // Whatever images it is said to be of, and whatever one's own sensor is, there is an end.
  const Bytes claims = with(with(good, kImagesAt, 4096U), kSizeAt, 0x7FFFFFFFU);
  CHECK(faulty(PatchFault::bomb, claims, limits) && faulty(PatchFault::bomb, claims, {}));
}
TEST(patches_of_more_than_one_may_hold_are_parted) {
  MapPatch whole = random_patch(11, 40);
  whole.notes.failures.push_back({{1 << 20, 0, 0}, 1});  // none of these images
  const std::size_t notes = whole.notes.failures.size();
  PatchLimits limits{.blocks = 7};
  std::vector<MapPatch> parts = parts_within(whole, limits);
  CHECK(parts.size() == (whole.blocks.size() + 6) / 7 && parts.size() > 2);
  std::vector<PatchBlock> blocks;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CHECK(parts[i].id.key.number == whole.id.key.number + i && parts[i].images == whole.images);
    CHECK(parts[i].notes.empty() == (i > 0));
    CHECK(!refused(encode_patch(parts[i]).bytes, limits, PlainPacker{}));
    blocks.insert(blocks.end(), parts[i].blocks.begin(), parts[i].blocks.end());
  }
  CHECK(blocks == whole.blocks && parts[0].notes.failures.size() == notes - 1);
  limits = {.hits = 60};
  for (const MapPatch& part : parts_within(whole, limits)) {
    std::size_t hits = 0;
    for (const PatchBlock& b : part.blocks) hits += b.hits.size();
    CHECK(hits <= 60 || part.blocks.size() == 1);
  }
  CHECK(parts_within({}, {}).size() == 1);
  // A recorder's numbers go on after the parts', and it is due before it has to part.
  PatchRecorder recorder = sheet_recorder(1);
  const std::vector<DepthImage> images = sheet_images(2);
  recorder.integrate(images[0], sheet_camera(), sheet_pose(0));
  const auto fewest = static_cast<std::uint32_t>(recorder.open().block_count() / 3);
  parts = recorder.close({}, {.blocks = fewest});
  CHECK(parts.size() >= 3 && recorder.number() == parts.size() && recorder.images() == 0);
  PatchRecorder small({.voxel_size = kSheetVoxel, .images = 100, .blocks = fewest},
                      TsdfIntegrator({.truncation = 3.0 * kSheetVoxel}));
  CHECK(!small.due());
  small.integrate(images[1], sheet_camera(), sheet_pose(1));
  CHECK(small.due());
}
TEST(patches_are_refused_by_reason) {
  const MapPatch patch = random_patch(11, 6);
  const Bytes good = encode_patch(patch, WatchedPacker{}).bytes;
  CHECK(!refused(good, {}, WatchedPacker{}));
  Bytes damaged = good;
  damaged[60] ^= std::byte{1};
  CHECK(faulty(PatchFault::checksum, damaged, {}));
  CHECK(faulty(PatchFault::malformed, Bytes(good.begin(), good.begin() + 50), {}));
  CHECK(faulty(PatchFault::malformed, with(good, 4, std::uint8_t{9}), {}));
  CHECK(faulty(PatchFault::malformed, with(good, kVoxelAt, 0.0), {}));
  CHECK(faulty(PatchFault::bomb, good, {.images = 4}));
  CHECK(faulty(PatchFault::bomb, good, {.blocks = 2}));
  CHECK(faulty(PatchFault::out_of_reach, good, {.reach = 2.0}));
  CHECK(faulty(PatchFault::impossible_weight, good, {.image_weight = 0.01}));
  const Box3 here(Point3(-1, -1, 0), Point3(1, 1, 2)), there(Point3(1, -1, 0), Point3(2, 1, 2));
  CHECK(!refused(good, {.places = here}, WatchedPacker{}));
  CHECK(faulty(PatchFault::out_of_reach, good, {.places = there}));
}

TEST(notes_that_no_robot_makes_are_refused) {
  const MapPatch patch = random_patch(11, 2);
  CHECK(patch.notes.views.size() > 1 && patch.notes.failures.size() > 1);
  CHECK(!refused(forged(patch), {.notes = 3}, PlainPacker{}));
  CHECK(refused(forged(patch), {.notes = 2}, PlainPacker{}));
  for (const bool views : {false, true}) {
    MapPatch half = patch;
    if (views)
      half.notes.failures.clear();
    else
      half.notes.views.clear();
    CHECK(refused(forged(half), {.notes = 2}, PlainPacker{}));
  }
  const auto refuses = [&](auto&& spoil) {
    MapPatch odd = patch;
    spoil(odd.notes);
    return refused(forged(odd), {}, PlainPacker{});
  };
  CHECK(!refuses([](ViewNotes&) {}));
  CHECK(!refuses([](ViewNotes& n) { n = {}; }));
  CHECK(refuses([](ViewNotes& n) { n.views[0].direction = {0, 0, 0}; }));
  CHECK(refuses([](ViewNotes& n) { n.views[0].direction = {127, 127, 0}; }));
  CHECK(refuses([](ViewNotes& n) { n.views[1] = n.views[0]; }));
  CHECK(refuses([](ViewNotes& n) { std::swap(n.views[0], n.views[1]); }));
  CHECK(refuses([](ViewNotes& n) { n.views[0].place[2] = -(1 << 29) - 1; }));
  CHECK(refuses([](ViewNotes& n) { n.views.back().place[0] = 100000; }));  // out of reach
  CHECK(refuses([](ViewNotes& n) { n.failures[0].count = 0; }));
  CHECK(refuses([](ViewNotes& n) { n.failures[1].place = n.failures[0].place; }));
  CHECK(refuses([](ViewNotes& n) { std::swap(n.failures[0], n.failures[1]); }));
  CHECK(refuses([](ViewNotes& n) { n.failures.back().place[0] = 100000; }));
  for (const std::size_t at : {kViewsAt, kFailuresAt}) {
    const Bytes good = forged(patch);
    std::uint32_t there = 0;
    std::memcpy(&there, good.data() + at, sizeof(there));
    CHECK(!refused(lying(good, at, there), {}, PlainPacker{}));
    for (const std::uint32_t many : {there - 1, there + 1, 1000U, 16384U})
      CHECK(refused(lying(good, at, many), {}, PlainPacker{}));
    CHECK(refused(lying(good, at, 0xFFFFFFFFU), {.notes = 0xFFFFFFFFU}, PlainPacker{}));
  }
  // Views in vain need no images: a robot at rest may still have some to tell.
  MapPatch bare = patch;
  bare.blocks.clear();
  bare.images = 0;
  CHECK(!refused(forged(bare), {}, PlainPacker{}));
  // One version, not two.
  CHECK(refused(with(forged(patch), 4, std::uint8_t{1}), {}, PlainPacker{}));
}

TEST(sizes_that_lie_are_refused_before_memory_is_taken) {
  const Bytes good = forged(random_patch(11, 6));
  for (const std::uint32_t huge : {0x7FFFFFFFU, 0xFFFFFFFFU, 1U << 20, 100000U}) {
    CHECK(refused(with(good, kBlocksAt, huge), {}, PlainPacker{}));
    CHECK(refused(with(good, kSizeAt, huge), {}, PlainPacker{}));
    CHECK(refused(with(good, kPackedAt, huge), {}, PlainPacker{}));
    CHECK(refused(with(good, kSizeAt, huge), {}, RunPacker{}));
    CHECK(refused(with(good, kViewsAt, huge), {.notes = 0xFFFFFFFFU}, PlainPacker{}));
    CHECK(refused(with(good, kFailuresAt, huge), {.notes = 0xFFFFFFFFU}, PlainPacker{}));
  }
  for (const std::int32_t far : {std::numeric_limits<std::int32_t>::min(),
                                 std::numeric_limits<std::int32_t>::max(), 1 << 26}) {
    CHECK(refused(with(good, kBoxAt, far), {.reach = 1e30}, PlainPacker{}));
    CHECK(refused(with(good, kBoxAt + 12, far), {.reach = 1e30}, PlainPacker{}));
  }
  CHECK(refused(with(good, kVoxelAt, 0.0), {}, PlainPacker{}));
  CHECK(refused(with(good, kVoxelAt, std::numeric_limits<double>::infinity()), {}, PlainPacker{}));
  CHECK(refused(with(good, kAnchorAt + 24, 2.0), {}, PlainPacker{}));
  CHECK(refused(with(good, kImagesAt, 0xFFFFFFFFU), {}, PlainPacker{}));
  // Blocks that begin as they should and then lie: every byte, any value, its hash put right.
  Random random(2);
  for (int trial = 0; trial < 3000; ++trial) {
    const MapPatch patch = random_patch(20 + static_cast<std::uint64_t>(trial % 7), 3);
    const detail::BlockBox box = detail::box_of(patch.blocks);
    Bytes raw = detail::put_patch_blocks(patch.blocks, box);
    for (std::uint64_t n = 1 + random.below(3); n-- > 0;)
      raw[random.below(raw.size())] = static_cast<std::byte>(random.below(256));
    if (random.below(4) == 0) raw.resize(random.below(raw.size()));
    try {
      const auto blocks = detail::get_patch_blocks(raw, patch.blocks.size(), box, 1 << 20, "patch");
      for (const PatchBlock& b : blocks) CHECK(!b.empty() && box.contains(b.index));
      CHECK(detail::get_patch_blocks(detail::put_patch_blocks(blocks, box), blocks.size(), box,
                                     1 << 20, "patch") == blocks);
    } catch (const Error&) {
    }
  }
}

TEST(seen_patches_are_small) {
  const std::vector<MapPatch> patches = sheet_patches(2);
  for (const MapPatch& patch : patches) {
    const EncodedPatch plain = encode_patch(patch);
    CHECK(static_cast<double>(plain.bytes.size()) < 1.6 * static_cast<double>(patch.seen()));
    CHECK(same_content(decode_patch(plain.bytes, {.voxel_size = kSheetVoxel}), patch));
  }
  CHECK(patches[0].id.key.number == 0 && patches[1].id.key.number == 1);
}
