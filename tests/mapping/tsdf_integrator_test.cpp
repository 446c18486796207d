// SPDX-License-Identifier: MIT
#include <surfleet/mapping/tsdf_integrator.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
PinholeCamera small_camera() {
  return PinholeCamera::from_fov(radians(80), radians(60), 160, 107, 0.2, 4.0);
}
Pose pose_at(const Point3& position, double yaw, double pitch = 0.0) {
  return Configuration{position, yaw}.pose() * forward_camera_mount(pitch);
}

/// Depths of a wall x = 2.53 (and of a floor z = −1 where it comes first).
double wall_range(const Point3& from, const Eigen::Vector3d& d) {
  double range = std::numeric_limits<double>::infinity();
  if (d.x() > 0) range = std::min(range, (2.53 - from.x()) / d.x());
  if (d.z() < 0) range = std::min(range, (-1.0 - from.z()) / d.z());
  return range;
}
DepthImage wall_image(const PinholeCamera& camera, const Pose& T) {
  DepthImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const double depth = wall_range(T.translation(), T.linear() * camera.ray(u, v));
      image(u, v) = static_cast<float>(depth);
    }
  return image;
}
std::vector<Point3> wall_scan(const Pose& T) {
  std::vector<Point3> points;
  for (int r = 0; r < 90; ++r)
    for (int c = 0; c < 360; ++c) {
      const double e = radians(-44.5 + r), a = radians(c);
      const Eigen::Vector3d d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      const double range = wall_range(T.translation(), T.linear() * d);
      if (std::isfinite(range)) points.push_back(range * d);
    }
  return points;
}

bool identical(const TsdfMap& a, const TsdfMap& b) {
  if (a.block_count() != b.block_count() || a.changed_since(0) != b.changed_since(0)) return false;
  for (std::uint32_t s = 0; s < a.block_count(); ++s)
    if (a.block(s).index != b.block(s).index ||
        std::memcmp(a.block(s).voxels.data(), b.block(s).voxels.data(),
                    sizeof(a.block(s).voxels)) != 0)
      return false;
  return true;
}

/// Laws of any update: what it writes is truncated, weighted once an image, and in touched blocks.
template <UpdatePolicy Update>
void update_laws(bool scan) {
  const PinholeCamera camera = small_camera();
  const Pose T = pose_at({0.1, -0.2, 0.3}, 0.1, 0.2);
  const double mu = 0.3;
  const auto integrate = [&](TsdfMap& map, int threads, double max_weight = 1000.0) {
    TsdfIntegrator<InverseSquareWeight, Update> run{
        {.truncation = mu, .max_weight = max_weight, .threads = threads}};
    if (scan) {
      const Pose T_world_lidar = T * forward_camera_mount().inverse(Eigen::Isometry);
      const auto points = wall_scan(T_world_lidar);
      return run(std::span<const Point3>(points), 0.1, 4.0, T_world_lidar, map);
    }
    return run(wall_image(camera, T), camera, T, map);
  };
  TsdfMap map({.voxel_size = 0.1});
  const std::size_t changed = integrate(map, 1);
  CHECK(changed > 0 && changed == map.block_count());
  CHECK(map.changed_since(0).size() == changed);
  std::size_t seen = 0;
  map.for_each_block([&](const TsdfMap::Block& b) {
    std::size_t in_block = 0;
    for (std::size_t i = 0; i < b.voxels.size(); ++i) {
      const TsdfVoxel& v = b.voxels[i];
      if (v.weight == 0.0F) continue;
      ++in_block;
      const double range = (map.center(TsdfMap::index_in(b, i)) - T.translation()).norm();
      CHECK_NEAR(v.weight * std::max(range, 0.1) * std::max(range, 0.1), 1.0, 1e-3);
      CHECK(std::abs(v.distance) <= static_cast<float>(mu));
    }
    CHECK(in_block > 0);
    seen += in_block;
  });
  CHECK(seen > 2000);

  // The wall straight ahead: near it the distance is the distance to the plane.
  for (double x = 2.25; x < 2.8; x += 0.1) {
    const TsdfVoxel* v = map.find(map.index_of({x, -0.1, 0.1}));
    CHECK(v != nullptr && v->weight > 0.0F);
    const double truth = 2.53 - map.center(map.index_of({x, -0.1, 0.1})).x();
    if (v != nullptr && std::abs(truth) < 0.25) CHECK_NEAR(v->distance, truth, 0.03);
  }
  const TsdfVoxel* free = map.find(map.index_of({1.0, -0.1, 0.1}));
  CHECK(free != nullptr && free->weight > 0.0F && free->distance == static_cast<float>(mu));
  CHECK(map.find(map.index_of({3.3, -0.1, 0.1})) == nullptr ||
        map.find(map.index_of({3.3, -0.1, 0.1}))->weight == 0.0F);

  // Any number of threads, twice over, gives the same bits.
  TsdfMap two({.voxel_size = 0.1}), three({.voxel_size = 0.1});
  integrate(two, 2);
  integrate(three, 3);
  CHECK(identical(map, two) && identical(map, three));
  integrate(map, 1);
  integrate(two, 2);
  CHECK(identical(map, two));

  // Once the weights are full and the distances settled, nothing changes any more.
  TsdfMap full({.voxel_size = 0.1});
  integrate(full, 1, 1e-3);
  std::size_t last = 1;
  for (int i = 0; i < 100 && last > 0; ++i) last = integrate(full, 1, 1e-3);
  CHECK(last == 0);
}

/// Weights a caller brings: the bare minimum.
struct ArchetypeWeight {
  float operator()(double sdf, double) const { return sdf < -0.1 ? 0.0F : 0.5F; }
};
static_assert(WeightPolicy<ArchetypeWeight> && !SquaredRangeWeightPolicy<ArchetypeWeight>);
static_assert(!WeightPolicy<int> && !UpdatePolicy<ArchetypeWeight>);
}  // namespace

TEST(projective_update_of_images_keeps_the_laws) { update_laws<ProjectiveUpdate>(false); }
TEST(projective_update_of_scans_keeps_the_laws) { update_laws<ProjectiveUpdate>(true); }
TEST(ray_traversal_of_images_keeps_the_laws) { update_laws<RayTraversalUpdate>(false); }
TEST(ray_traversal_of_scans_keeps_the_laws) { update_laws<RayTraversalUpdate>(true); }

TEST(projective_update_equals_brute_force_over_every_voxel) {
  // Random blobs of depth, invalid pixels and far readings, against one voxel at a time.
  Random random(5);
  PinholeCamera camera = PinholeCamera::from_fov(radians(70), radians(50), 64, 48, 0.3, 3.0);
  for (int round = 0; round < 3; ++round) {
    DepthImage image(camera.width, camera.height);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const int tile = (u / 16) * 7 + (v / 12) * 3 + round;
        image(u, v) = tile % 5 == 0 ? 5.0F : 0.7F + 0.35F * static_cast<float>(tile % 7);
        if (random.below(round % 2 == 0 ? 400 : 20) == 0) {
          const float bad[] = {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::infinity(), 0.2F};
          image(u, v) = bad[random.below(5)];
        }
      }
    const Pose T = pose_at({random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)},
                           random.uniform(-3, 3), random.uniform(-1, 1));
    const double mu = 0.25, h = 0.1;
    TsdfMap map({.voxel_size = h});
    TsdfIntegrator<ConstantWeight> integrate{{.truncation = mu}};
    integrate(image, camera, T, map);
    const VoxelIndex c = map.index_of(T.translation());
    std::size_t compared = 0, wrong = 0;
    for (int z = -33; z <= 33; ++z)
      for (int y = -33; y <= 33; ++y)
        for (int x = -33; x <= 33; ++x) {
          const VoxelIndex index = c + VoxelIndex(x, y, z);
          const TsdfVoxel* voxel = map.find(index);
          const bool written = voxel != nullptr && voxel->weight > 0.0F;
          const Point3 p = T.inverse(Eigen::Isometry) * map.center(index);
          const auto px = camera.project(p);
          if (!px || p.z() < 2e-3) {
            wrong += written && p.z() < -1e-3 ? 1U : 0U;
            continue;
          }
          // Leave out what rounding decides: pixel borders and the ends of the band.
          const double fu = px->x() + 0.5 - std::floor(px->x() + 0.5);
          const double fv = px->y() + 0.5 - std::floor(px->y() + 0.5);
          if (std::min({fu, 1 - fu, fv, 1 - fv}) < 1e-3) continue;
          const float d = image(static_cast<int>(std::floor(px->x() + 0.5)),
                                static_cast<int>(std::floor(px->y() + 0.5)));
          const double depth = static_cast<double>(d);
          const bool valid = DepthImage::is_measurement(d) && depth >= camera.min_range;
          const double sdf = (depth - p.z()) * p.norm() / p.z();
          if (std::abs(std::abs(sdf) - mu) < 1e-3 || std::abs(sdf) < 1e-3 ||
              std::abs(p.z() - camera.max_range) < 1e-3)
            continue;
          const bool expected =
              valid && (depth <= camera.max_range ? sdf > -mu && (sdf < mu || p.z() <= 3.0)
                                                  : sdf > 0 && p.z() <= camera.max_range);
          wrong += written != expected ? 1U : 0U;
          if (!written || !expected) continue;
          ++compared;
          // Nearer than along the ray, by the surface's slant, and on the same side.
          const double most = std::min(std::abs(sdf) + 0.02, mu + 1e-6);
          const bool right = sdf >= 6.0 * mu ? voxel->distance == static_cast<float>(mu)
                                             : std::abs(voxel->distance) <= most &&
                                                   (voxel->distance > 0) == (sdf > 0);
          wrong += right ? 0U : 1U;
        }
    CHECK(compared > 1000 && wrong == 0);
  }
}

TEST(planes_are_exact_far_from_the_origin_too) {
  for (const Point3& offset : {Point3(0, 0, 0), Point3(-20000, 50000, 300)}) {
    TsdfMap map({.voxel_size = 0.1});
    TsdfIntegrator<> integrate{{.truncation = 0.4}};
    const PinholeCamera camera = small_camera();
    for (const double yaw : {-0.5, 0.0, 0.4}) {
      const Pose T = pose_at({0, 0, 0}, yaw);
      Pose moved = T;
      moved.pretranslate(offset);
      integrate(wall_image(camera, T), camera, moved, map);
    }
    std::vector<double> errors;
    map.for_each_block([&](const TsdfMap::Block& b) {
      for (std::size_t i = 0; i < b.voxels.size(); ++i) {
        const Point3 p = map.center(TsdfMap::index_in(b, i)) - offset;
        if (b.voxels[i].weight > 0.0F && std::abs(p.x() - 2.53) < 0.15 && p.z() > -0.7)
          errors.push_back(std::abs(static_cast<double>(b.voxels[i].distance) - (2.53 - p.x())));
      }
    });
    CHECK(errors.size() > 500);
    std::sort(errors.begin(), errors.end());
    if (!errors.empty()) CHECK(errors[errors.size() * 98 / 100] < 1e-3);
  }
}

TEST(carving_can_be_switched_off) {
  const PinholeCamera camera = small_camera();
  const Pose T = pose_at({0, 0, 0}, 0.0);
  DepthImage image = wall_image(camera, T);
  TsdfMap band({.voxel_size = 0.1}), all({.voxel_size = 0.1});
  TsdfIntegrator<> integrate{{.truncation = 0.3, .carve_free_space = false}};
  integrate(image, camera, T, band);
  integrate.options.carve_free_space = true;
  integrate(image, camera, T, all);
  CHECK(band.block_count() < all.block_count());
  band.for_each_block([&](const TsdfMap::Block& b) {
    for (const TsdfVoxel& v : b.voxels) CHECK(v.weight == 0.0F || v.distance < 0.3F);
  });
  // Far readings: carve to the range, or say nothing.
  std::fill(image.depth.begin(), image.depth.end(), 50.0F);
  TsdfMap far({.voxel_size = 0.1}), none({.voxel_size = 0.1});
  integrate(image, camera, T, far);
  integrate.options.carve_beyond_range = false;
  CHECK(integrate(image, camera, T, none) == 0 && none.empty());
  CHECK(far.find(far.index_of({3.85, 0.05, 0.05}))->distance == 0.3F);
  CHECK(far.find(far.index_of({4.15, 0.05, 0.05})) == nullptr ||
        far.find(far.index_of({4.15, 0.05, 0.05}))->weight == 0.0F);
}

TEST(images_without_measurements_make_nothing) {
  const PinholeCamera camera = small_camera();
  for (const float d : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::infinity(), 0.1F}) {
    TsdfMap map;
    TsdfIntegrator<> projective;
    TsdfIntegrator<InverseSquareWeight, RayTraversalUpdate> traversal;
    const DepthImage image(camera.width, camera.height, d);
    CHECK(projective(image, camera, Pose::Identity(), map) == 0);
    CHECK(traversal(image, camera, Pose::Identity(), map) == 0);
    CHECK(map.empty());
  }
  TsdfMap map;
  TsdfIntegrator<> integrate;
  const std::vector<Point3> bad{Point3(0, 0, 0), Point3::Constant(std::nan("")),
                                Point3(1e300, 0, 0), Point3(0.01, 0, 0),
                                Point3(std::numeric_limits<double>::infinity(), 0, 0)};
  CHECK(integrate(std::span<const Point3>(bad), 0.1, 5.0, Pose::Identity(), map) == 0);
  CHECK(integrate(PointCloud{}, 0.1, 5.0, Pose::Identity(), map) == 0);
  CHECK(map.empty());
}

TEST(any_weight_and_any_scan_will_do) {
  TsdfMap map({.voxel_size = 0.1});
  TsdfIntegrator<ArchetypeWeight> integrate{{.truncation = 0.3}};
  const PinholeCamera camera = small_camera();
  const Pose T = pose_at({0, 0, 0}, 0.0);
  integrate(wall_image(camera, T), camera, T, map);
  bool behind = false;
  map.for_each_block([&](const TsdfMap::Block& b) {
    for (const TsdfVoxel& v : b.voxels) {
      CHECK(v.weight == 0.0F || v.weight == 0.5F);
      behind = behind || (v.weight > 0.0F && v.distance < -0.2F);
    }
  });
  CHECK(!behind);
  // One point, ten points in a line.
  for (const int n : {1, 10}) {
    std::vector<Point3> points;
    for (int i = 0; i < n; ++i) points.emplace_back(2.0, 0.01 * i, 0.0);
    TsdfMap few({.voxel_size = 0.1});
    TsdfIntegrator<> one;
    CHECK(one(std::span<const Point3>(points), 0.1, 5.0, Pose::Identity(), few) > 0);
    TsdfIntegrator<InverseSquareWeight, RayTraversalUpdate> ray;
    CHECK(ray(std::span<const Point3>(points), 0.1, 5.0, Pose::Identity(), few) > 0);
  }
}

// The faces of the cube around a scanner meet on its diagonals, where voxels lie as often as not.
TEST(every_voxel_before_a_scan_is_observed_once) {
  constexpr int kPoints = 30000;
  constexpr double kRadius = 3.0;
  std::vector<Point3> sphere;  // Fibonacci's
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kPoints, r = std::sqrt(1.0 - z * z);
    const double angle = i * kPi * (3.0 - std::sqrt(5.0));
    sphere.push_back(kRadius * Point3(r * std::cos(angle), r * std::sin(angle), z));
  }
  for (const double shift : {0.0, 0.05, 0.031}) {
    TsdfMap map({.voxel_size = 0.1});
    TsdfIntegrator<ConstantWeight> integrate{{.truncation = 0.3}};
    Pose T = Pose::Identity();
    T.translation().setConstant(shift);
    integrate(std::span<const Point3>(sphere), 0.1, 10.0, T, map);
    const int n = static_cast<int>((kRadius - 0.5) / 0.1);
    int wrong = 0;
    for_each_index(VoxelIndex::Constant(-n), VoxelIndex::Constant(n), [&](const VoxelIndex& v) {
      const double r = (map.center(v) - T.translation()).norm();
      if (r < 0.3 || r > kRadius - 0.6) return;
      const TsdfVoxel* voxel = map.find(v);
      wrong += voxel == nullptr || voxel->weight != 1.0F ? 1 : 0;
    });
    CHECK(wrong == 0);
  }
}

TEST(bad_settings_are_refused_before_the_map_is_touched) {
  CHECK_THROWS(Error, TsdfIntegrator<>{{.truncation = 0.0}});
  CHECK_THROWS(Error, TsdfIntegrator<>{{.truncation = std::nan("")}});
  CHECK_THROWS(Error, TsdfIntegrator<>{{.max_weight = -1.0}});
  TsdfIntegrator<> integrate;
  TsdfMap map;
  PinholeCamera camera = small_camera();
  CHECK_THROWS(Error, integrate(DepthImage(3, 3, 1.0F), camera, Pose::Identity(), map));
  const DepthImage image(camera.width, camera.height, 1.0F);
  Pose bad = Pose::Identity();
  bad.translation().x() = std::nan("");
  CHECK_THROWS(Error, integrate(image, camera, bad, map));
  bad.translation().x() = 1e15;
  CHECK_THROWS(Error, integrate(image, camera, bad, map));
  camera.max_range = -1.0;
  CHECK_THROWS(Error, integrate(image, camera, Pose::Identity(), map));
  CHECK_THROWS(Error,
               integrate(PointCloud{{Point3(1, 0, 0)}, {}, {}}, 2.0, 1.0, Pose::Identity(), map));
  CHECK(map.empty());
}
