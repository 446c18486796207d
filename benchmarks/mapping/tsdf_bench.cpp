// SPDX-License-Identifier: MIT
// requires: octomap
/// @file
/// @brief TSDF integration with free space in a room, beside OctoMap's ray insertion. One iteration
/// folds ten frames into a fresh map; `per_frame` is what counts.
///
/// `Tsdf_Accuracy` is of errors alone: 50 and 95 % of the distances from samples of the extracted
/// mesh to the exact surface, by what they are samples of, with exact and with noisy depth.
#include <benchmark/benchmark.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/mapping/occupancy_integrator.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/simulation/stereo_noise.hpp>

#include "room_scene.hpp"

namespace {
using namespace surfleet;

struct Frames {
  PinholeCamera camera;  // 640 × 480, f = 525 px, 5 m
  std::vector<Pose> T_world_camera, T_world_lidar;
  std::vector<DepthImage> images;
  std::vector<std::vector<Point3>> scans;
};
const Frames& frames() {
  static const Frames f = [] {
    Frames made;
    made.T_world_lidar = room_scene::body_poses();
    for (const Pose& body : made.T_world_lidar) {
      made.T_world_camera.push_back(body * forward_camera_mount());
      made.images.push_back(room_scene::depth_image(made.camera, made.T_world_camera.back()));
      made.scans.push_back(room_scene::lidar_scan(body));
    }
    return made;
  }();
  return f;
}

/// How the measurements err: not at all, by Gaussian noise of 5 mm on every pixel's depth or
/// point's range, or as a stereo pair does (depth images).
enum Errors : std::int64_t { kExact = 0, kGaussian = 1, kStereo = 2 };
constexpr double kDeviation = 0.005;  // [m]

DepthImage spoiled(DepthImage image, const PinholeCamera& camera, std::int64_t errors,
                   const Random& random) {
  if (errors == kStereo) StereoNoise{}(camera, image, random, 1);
  if (errors != kGaussian) return image;
  Random stream = random;
  for (float& d : image.depth)
    if (DepthImage::is_measurement(d)) d += static_cast<float>(kDeviation * stream.normal());
  return image;
}
std::vector<Point3> spoiled(std::vector<Point3> scan, std::int64_t errors, const Random& random) {
  Random stream = random;
  if (errors == kGaussian)
    for (Point3& p : scan) p += kDeviation * stream.normal() * p.normalized();
  return scan;
}

void report(benchmark::State& state, std::size_t frame_count) {
  state.counters["per_frame"] = benchmark::Counter(
      static_cast<double>(frame_count),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Arguments: voxel size [cm], threads, 0 for depth images or 1 for LiDAR points.
template <typename Update>
void integrate(benchmark::State& state) {
  const Frames& f = frames();
  const double voxel = 0.01 * static_cast<double>(state.range(0));
  TsdfIntegrator<InverseSquareWeight, Update> run{
      {.truncation = 4.0 * voxel, .threads = static_cast<int>(state.range(1))}};
  std::unique_ptr<TsdfMap> map;
  for (auto _ : state) {
    state.PauseTiming();
    map = std::make_unique<TsdfMap>(VoxelGridOptions{voxel});
    state.ResumeTiming();
    for (std::size_t i = 0; i < f.images.size(); ++i) {
      if (state.range(2) == 0)
        run(f.images[i], f.camera, f.T_world_camera[i], *map);
      else
        run(std::span<const Point3>(f.scans[i]), 0.1, 8.0, f.T_world_lidar[i], *map);
    }
  }
  report(state, f.images.size());
  state.counters["MB"] = static_cast<double>(map->memory_bytes()) * 1e-6;
}

/// Arguments: voxel size [cm], 0 for depth images or 1 for LiDAR points, `Errors`.
void accuracy(benchmark::State& state) {
  const Frames& f = frames();
  const double voxel = 0.01 * static_cast<double>(state.range(0));
  TsdfMap map(VoxelGridOptions{voxel});
  for (auto _ : state) {
    TsdfIntegrator<InverseSquareWeight, ProjectiveUpdate> run({.truncation = 4.0 * voxel});
    map = TsdfMap(VoxelGridOptions{voxel});
    for (std::size_t i = 0; i < f.images.size(); ++i) {
      const Random random = Random(1).fork(i);
      if (state.range(1) == 0)
        run(spoiled(f.images[i], f.camera, state.range(2), random), f.camera, f.T_world_camera[i],
            map);
      else
        run(spoiled(f.scans[i], state.range(2), random), 0.1, 8.0, f.T_world_lidar[i], map);
    }
  }
  constexpr std::array<std::pair<room_scene::Part, const char*>, 4> kParts{
      {{room_scene::Part::plane, "plane"},
       {room_scene::Part::sphere, "sphere"},
       {room_scene::Part::edge, "edge"},
       {room_scene::Part::corner, "corner"}}};
  std::array<std::vector<double>, kParts.size()> errors;
  for (const Point3& p : sample_surface(extract_mesh(map), {.density = 1000.0}).cloud.points)
    errors[static_cast<std::size_t>(room_scene::part_at(p, voxel))].push_back(
        room_scene::distance(p));
  for (const auto& [part, name] : kParts) {
    const std::vector<double>& e = errors[static_cast<std::size_t>(part)];
    if (e.empty()) continue;
    state.counters[std::string(name) + "_p50_mm"] = 1e3 * percentile(e, 0.5);
    state.counters[std::string(name) + "_p95_mm"] = 1e3 * percentile(e, 0.95);
  }
}

/// What both occupancy maps are given: points in range, in world axes and in single precision.
struct Reading {
  Eigen::Vector3f origin;
  std::vector<Eigen::Vector3f> points;

  LidarScan scan() const {
    LidarScan scan;
    for (const Eigen::Vector3f& p : points)
      scan.points.emplace_back(p.cast<double>() - origin.cast<double>());
    return scan;
  }
};
std::vector<Reading> readings(bool lidar) {
  const Frames& f = frames();
  std::vector<Reading> all;
  for (std::size_t i = 0; i < 2; ++i) {  // a frame takes OctoMap long enough
    const Pose& T = lidar ? f.T_world_lidar[i] : f.T_world_camera[i];
    Reading& r = all.emplace_back(T.translation().cast<float>());
    const auto add = [&](const Point3& p) { r.points.emplace_back((T * p).cast<float>()); };
    if (lidar) {
      for (const Point3& p : f.scans[i])
        if (p.norm() <= 8.0) add(p);
      continue;
    }
    for (int v = 0; v < f.camera.height; ++v)
      for (int u = 0; u < f.camera.width; ++u)
        if (const float d = f.images[i](u, v); DepthImage::is_measurement(d) && d <= 5.0F)
          add(f.camera.ray(u, v) * static_cast<double>(d));
  }
  return all;
}
OccupancyMap occupancy_of(const std::vector<Reading>& all, double voxel) {
  OccupancyMap map({.voxel_size = voxel});
  OccupancyIntegrator run;
  for (const Reading& r : all)
    run(r.scan(), {.min_range = 0.0, .max_range = 1e3},
        Pose(Eigen::Translation3d(r.origin.cast<double>())), map);
  return map;
}
void occupancy(benchmark::State& state) {
  const std::vector<Reading> all = readings(state.range(2) != 0);
  const double voxel = 0.01 * static_cast<double>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(occupancy_of(all, voxel).block_count());
  report(state, all.size());
}

/// `differs` is the share of its voxels that `occupancy` has otherwise: OctoMap leaves out the last
/// voxel that a ray passes if the ray ends on a face.
void octomap_insert(benchmark::State& state) {
  const std::vector<Reading> all = readings(state.range(2) != 0);
  const double voxel = 0.01 * static_cast<double>(state.range(0));
  const auto single = [](const Eigen::Vector3f& p) {
    return octomap::point3d(p.x(), p.y(), p.z());
  };
  std::vector<octomap::Pointcloud> clouds(all.size());
  for (std::size_t i = 0; i < clouds.size(); ++i)
    for (const Eigen::Vector3f& p : all[i].points) clouds[i].push_back(single(p));
  octomap::OcTree tree(voxel);
  for (auto _ : state) {
    tree.clear();
    for (std::size_t i = 0; i < clouds.size(); ++i)
      tree.insertPointCloud(clouds[i], single(all[i].origin), -1.0, false, false);
    benchmark::DoNotOptimize(tree.size());
  }
  report(state, clouds.size());
  const OccupancyMap ours = occupancy_of(all, voxel);
  tree.expand();
  std::size_t leaves = 0, differ = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf, ++leaves) {
    const octomap::point3d c = leaf.getCoordinate();
    const OccupancyVoxel* v = ours.find(ours.index_of(Point3(
        static_cast<double>(c.x()), static_cast<double>(c.y()), static_cast<double>(c.z()))));
    differ +=
        v != nullptr && v->observed && std::abs(v->log_odds - leaf->getLogOdds()) < 1e-4F ? 0 : 1;
  }
  state.counters["differs"] = static_cast<double>(differ) / static_cast<double>(leaves);
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"cm", "threads", "lidar"})->Unit(benchmark::kMillisecond)->UseRealTime();
  for (const int lidar : {0, 1})
    for (const int cm : {10, 5})
      for (const int threads : {1, 2}) b->Args({cm, threads, lidar});
}
void rival_sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"cm", "threads", "lidar"})->Unit(benchmark::kMillisecond)->UseRealTime();
  for (const int lidar : {0, 1})
    for (const int cm : {10, 5}) b->Args({cm, 1, lidar})->Iterations(1);
}

BENCHMARK(integrate<ProjectiveUpdate>)->Name("Tsdf_Projective")->Apply(sizes);
BENCHMARK(integrate<RayTraversalUpdate>)
    ->Name("Tsdf_RayTraversal")
    ->ArgNames({"cm", "threads", "lidar"})
    ->Args({10, 1, 0})
    ->Args({10, 1, 1})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(accuracy)
    ->Name("Tsdf_Accuracy")
    ->ArgNames({"cm", "lidar", "noise"})
    ->ArgsProduct({{10, 5}, {0}, {kExact, kGaussian, kStereo}})
    ->ArgsProduct({{10, 5}, {1}, {kExact, kGaussian}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(occupancy)->Name("Occupancy_Integrate")->Apply(rival_sizes);
BENCHMARK(octomap_insert)->Name("OctoMap_InsertPointCloud")->Apply(rival_sizes);
}  // namespace

BENCHMARK_MAIN();
