// SPDX-License-Identifier: MIT
/// @file
/// @brief The surface of a map as oriented points, one for each voxel and side where rays ended.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct SurfacePointOptions {
  double min_weight = 0.3;  ///< W_th: hits that are not known at this weight give no point.
  double support = 1.5;     ///< Radius of the neighbourhood a point is smoothed over [voxels].
  double same_side = 0.5;   ///< Least cosine between normals of one piece of surface.
  int threads = 1;          ///< The result is the same for any number.
};

namespace detail {
/// Every solid hit as a point: mean place, mean normal, weight, and whether it is known.
struct HitPoints {
  std::vector<Point3> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<double> weights;
  std::vector<std::size_t> known;  ///< Those known at the weight asked for.
};
inline HitPoints hit_points(const TsdfMap& map, double known_weight) {
  HitPoints all;
  const double h = map.voxel_size();
  map.for_each_block([&](const TsdfMap::Block& block) {
    for (const SurfaceHit& hit : block.layer.hits()) {
      if (!hit.is_solid(0.0)) continue;
      if (hit.is_solid(known_weight)) all.known.push_back(all.points.size());
      all.points.push_back(map.center(TsdfMap::index_in(block, hit.voxel())) + hit.mean_offset(h));
      all.normals.push_back(hit.mean_normal());
      all.weights.push_back(hit.weight_value());
    }
  });
  return all;
}
}  // namespace detail

/// The points of all hits known at `min_weight`, each moved along the normal onto the
/// weighted plane of the hits of its own side around it (moving least squares of degree 0 in the
/// normals and 1 in the places), so that the noise of single rays does not show as layers.
/// Normals are outward. In the order of the map's blocks; O(hits · neighbours).
inline PointCloud extract_points(const TsdfMap& map, const SurfacePointOptions& options = {}) {
  const detail::HitPoints hits = detail::hit_points(map, options.min_weight);
  const double radius = options.support * map.voxel_size();
  const KdTree tree(hits.points);
  PointCloud cloud;
  cloud.points.resize(hits.known.size());
  cloud.normals.resize(hits.known.size());
  parallel_for(
      hits.known.size(), options.threads,
      [&](std::size_t k) {
        const std::size_t i = hits.known[k];
        Point3 place = hits.points[i];
        Eigen::Vector3d normal = hits.normals[i];
        // Once for the normal, and again with that normal to choose the neighbours by.
        for (int round = 0; round < 2; ++round) {
          double sum = 0.0;
          Eigen::Vector3d center = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::Zero();
          tree.for_each_within(place, radius, [&](const Neighbor& n) {
            const auto j = static_cast<std::size_t>(n.index);
            if (hits.normals[j].dot(normal) < options.same_side) return;
            const double fade = 1.0 - n.distance2 / (radius * radius);
            const double w = hits.weights[j] * fade * fade;
            sum += w;
            center += w * (hits.points[j] - place);
            direction += w * hits.normals[j];
          });
          if (!(sum > 0.0) || !(direction.norm() > 1e-9 * sum)) break;
          normal = direction.normalized();
          place += normal * normal.dot(center / sum);
        }
        cloud.points[k] = place;
        cloud.normals[k] = normal.cast<float>();
      },
      64);
  return cloud;
}
}  // namespace surfleet
