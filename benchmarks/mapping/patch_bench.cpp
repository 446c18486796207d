// SPDX-License-Identifier: MIT
// requires: zstd
/// @file
/// @brief A map patch closed, encoded, decoded and fused: five depth images of the benchmark room,
/// 90 x 60 degrees up to 8 m, at voxels of 30 and of 10 cm.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include <surfleet/adapters/zstd_codec.hpp>
#include <surfleet/mapping/patch_fusion.hpp>
#include <surfleet/mapping/patch_recorder.hpp>

#include "room_scene.hpp"

namespace {
using namespace surfleet;

PatchRecorder recorded(double voxel) {
  const PinholeCamera camera =
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 192, 111, 0.3, 8.0);
  PatchRecorder recorder({.voxel_size = voxel},
                         TsdfIntegrator({.truncation = 3.0 * voxel}, drop_off_by_voxels(voxel)));
  while (!recorder.due()) {
    const double shot = recorder.images();
    Configuration at{Point3(-3.5 + 0.15 * shot, -1.0, 1.4), 0.3 + 0.1 * shot};
    const Pose T = at.pose() * forward_camera_mount();
    DepthImage image(camera.width, camera.height);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d ray = camera.ray(u, v);
        const double range = room_scene::cast(T.translation(), (T.linear() * ray).normalized());
        image(u, v) = static_cast<float>(range / ray.norm());
      }
    recorder.integrate(image, camera, T);
  }
  return recorder;
}
double voxel_of(const benchmark::State& state) {
  return 0.01 * static_cast<double>(state.range(0));
}

void close_patch(benchmark::State& state) {
  const auto recorder = recorded(voxel_of(state));
  for (auto _ : state)
    benchmark::DoNotOptimize(make_patch(recorder.open(), 3.0 * voxel_of(state)).blocks.data());
}
template <typename Packer>
void encode(benchmark::State& state) {
  const MapPatch patch = recorded(voxel_of(state)).close();
  std::size_t bytes = 0;
  for (auto _ : state) bytes = encode_patch(patch, Packer{}).bytes.size();
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["voxels"] = static_cast<double>(patch.seen());
  state.counters["bytes_per_voxel"] =
      static_cast<double>(bytes) / static_cast<double>(patch.seen());
}
template <typename Packer>
void decode(benchmark::State& state) {
  const Bytes bytes = encode_patch(recorded(voxel_of(state)).close(), Packer{}).bytes;
  for (auto _ : state) benchmark::DoNotOptimize(decode_patch(bytes, {}, Packer{}).blocks.data());
}
void fuse(benchmark::State& state) {
  const MapPatch patch = recorded(voxel_of(state)).close();
  PatchFusion fusion({.voxel_size = patch.voxel_size, .truncation = patch.truncation});
  for (auto _ : state) {  // one more and one less
    fusion.add(patch);
    fusion.remove(patch);
  }
}
void resample(benchmark::State& state) {
  const MapPatch patch = recorded(voxel_of(state)).close();
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (auto _ : state) benchmark::DoNotOptimize(moved_patch(patch, T).blocks.data());
}
void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(30)->Arg(10)->Unit(benchmark::kMillisecond);
}
BENCHMARK(close_patch)->Name("Patch_Close")->Apply(sizes);
BENCHMARK(encode<PlainPacker>)->Name("Patch_EncodePlain")->Apply(sizes);
BENCHMARK(encode<ZstdPacker>)->Name("Patch_EncodeZstd")->Apply(sizes);
BENCHMARK(decode<PlainPacker>)->Name("Patch_DecodePlain")->Apply(sizes);
BENCHMARK(decode<ZstdPacker>)->Name("Patch_DecodeZstd")->Apply(sizes);
BENCHMARK(fuse)->Name("Patch_AddAndRemove")->Apply(sizes);
BENCHMARK(resample)->Name("Patch_Move")->Apply(sizes);
}  // namespace

BENCHMARK_MAIN();
