// SPDX-License-Identifier: MIT
/// @file
/// @brief The surface of a map as a mesh: by its distances where they can hold it, by its hits
///        where they cannot.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/mesh_clipping.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/geometry/triangle_queries.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/mapping/surface_points.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet {
struct SurfaceMeshOptions {
  double min_weight = 0.3;  ///< W_th: what is known less well is no surface.
  /// A point of the hits is held by the distances if their mesh comes this near to it, with a
  /// normal of the same side [voxels].
  double held_within = 0.5;
  /// A triangle of the distances stands only if points of its side are this near within
  /// `held_within` of whose planes it is, and the nearest of them is of no thin body [voxels].
  double backed_within = 1.5;
  /// A body is thin where its sides are nearer to each other than this: there may be no voxel
  /// centre between them, and what is seen of one tears the distances of the other [voxels].
  double thin_within = 1.0;
  /// How far from a point its patch reaches where there are others around it: over the triangles of
  /// the distances that are left out beside it [voxels].
  double patch_radius = 1.5;
  /// Radius of the neighbourhood that the signed distance of a patch is averaged over [voxels].
  double support = 1.75;
  int threads = 1;  ///< The result is the same for any number.
};

namespace detail {
/// Triangles sorted into voxels by their centroids, for looking up what is near a point.
class TriangleCells {
 public:
  TriangleCells(const TriangleMesh& mesh, double cell)
      : mesh_(&mesh), cells_({.voxel_size = cell}) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      cells_.ensure(cells_.index_of(mesh.centroid(t))).push_back(static_cast<std::int32_t>(t));
  }
  /// Whether a triangle whose normal has a positive part along `normal` comes within `distance`,
  /// less than a cell, of `p`.
  bool near(const Point3& p, const Eigen::Vector3d& normal, double distance) const {
    const VoxelIndex at = cells_.index_of(p);
    bool found = false;
    for_each_index(at - VoxelIndex::Ones(), at + VoxelIndex::Ones(), [&](const VoxelIndex& v) {
      const auto* list = found ? nullptr : cells_.find(v);
      if (list == nullptr) return;
      for (const std::int32_t i : *list) {
        const auto t = static_cast<std::size_t>(i);
        if (mesh_->area_vector(t).dot(normal) <= 0.0) continue;
        const Point3 q =
            closest_on_triangle(p, mesh_->corner(t, 0), mesh_->corner(t, 1), mesh_->corner(t, 2));
        if ((q - p).squaredNorm() > distance * distance) continue;
        found = true;
        return;
      }
    });
    return found;
  }

 private:
  const TriangleMesh* mesh_;
  VoxelGrid<std::vector<std::int32_t>, 4> cells_;
};

/// Marks the points that a point of the other side is within `thin_within` of. O(neighbours).
inline std::vector<std::uint8_t> thin_points(const PointCloud& points, const KdTree& tree,
                                             double voxel_size, const SurfaceMeshOptions& options) {
  constexpr float kOpposite = -0.5F;  // cosine of normals below which sides are two
  std::vector<std::uint8_t> thin(points.size(), 0);
  parallel_for(
      thin.size(), options.threads,
      [&](std::size_t i) {
        const double reach = options.thin_within * voxel_size;
        tree.for_each_within(points.points[i], reach, [&](const Neighbor& near) {
          const auto j = static_cast<std::size_t>(near.index);
          if (points.normals[i].dot(points.normals[j]) < kOpposite) thin[i] = 1;
        });
      },
      256);
  return thin;
}

/// Patches through points that the distances do not hold, one axis direction of normals after the
/// other, so that the two sides of a sheet are two surfaces.
class PatchMesher {
 public:
  PatchMesher(const PointCloud& points, const std::vector<std::uint8_t>& wanted, double voxel_size,
              const SurfaceMeshOptions& options)
      : points_(&points), wanted_(&wanted), size_(voxel_size), options_(options) {}

  /// The patches of points whose normals are nearest to direction `side`, of `2 · axis + sign`.
  TriangleMesh operator()(int side) const {
    const Eigen::Vector3d axis = (side & 1) != 0 ? Eigen::Vector3d(-Eigen::Vector3d::Unit(side / 2))
                                                 : Eigen::Vector3d(Eigen::Vector3d::Unit(side / 2));
    std::vector<Point3> places, targets;
    std::vector<Eigen::Vector3d> normals;
    for (std::size_t i = 0; i < points_->size(); ++i) {
      const Eigen::Vector3d n = points_->normals[i].cast<double>();
      if (n.dot(axis) < kBeside) continue;
      places.push_back(points_->points[i]);
      normals.push_back(n);
      // Those between two directions serve both: there the triangle's own normal decides.
      if ((*wanted_)[i] == 0 || n.dot(axis) < n.cwiseAbs().maxCoeff() - kShared) continue;
      targets.push_back(points_->points[i]);
    }
    if (targets.empty()) return {};
    const TsdfMap field = field_around(targets, places, normals);
    const TriangleMesh all = extract_mesh(field, {.normals = false, .threads = options_.threads});
    const TriangleMesh facing = selected(all, [&](std::size_t t) {
      const Eigen::Vector3d n = all.area_vector(t);
      return n.dot(axis) >= n.cwiseAbs().maxCoeff() * (1.0 - 1e-9);
    });
    const KdTree wanted(targets), around(places);
    const double reach = options_.patch_radius * size_, support = options_.support * size_;
    std::vector<double> inside(facing.vertices.size());
    parallel_for(
        inside.size(), options_.threads,
        [&](std::size_t i) {
          const Point3& v = facing.vertices[i];
          inside[i] = -reach;
          const auto near = wanted.nearest(v, 2.0 * reach);
          if (!near) return;
          inside[i] = reach - near->distance();
          Point3 sum = Point3::Zero();
          double count = 0.0;
          around.for_each_within(v, support, [&](const Neighbor& n) {
            sum += places[static_cast<std::size_t>(n.index)];
            count += 1.0;
          });
          if (count > 0.0)
            inside[i] = std::min(inside[i], kRim * support - (sum / count - v).norm());
        },
        256);
    return clipped(facing, inside);
  }

 private:
  static constexpr double kBeside = 0.3;  ///< Least cosine of normals that belong to a direction.
  /// A patch ends where the mean of the points around is this far away, of the support: that of a
  /// half disc from the middle of its straight side, 4/3π.
  static constexpr double kRim = 0.4244;
  static constexpr double kShared = 0.25;  ///< Within this of the greatest part a normal is shared.

  /// Signed distance at the voxel centres around the targets: the mean of the distances to the
  /// planes of the points around, the nearer the more.
  TsdfMap field_around(const std::vector<Point3>& targets, const std::vector<Point3>& places,
                       const std::vector<Eigen::Vector3d>& normals) const {
    const KdTree tree(places);
    TsdfMap field({.voxel_size = size_});
    TsdfMap::Writer write(field);
    std::vector<VoxelIndex> nodes;
    for (const Point3& p : targets) {
      const VoxelIndex low = field.index_of(p - Eigen::Vector3d::Constant(1.5 * size_));
      const VoxelIndex high = field.index_of(p + Eigen::Vector3d::Constant(1.5 * size_));
      for_each_index(low, high, [&](const VoxelIndex& v) {
        TsdfVoxel& voxel = write.ensure(v);
        if (voxel.weight > 0.0F) return;
        voxel.weight = 1.0F;
        nodes.push_back(v);
      });
    }
    std::vector<float> value(nodes.size());
    const double radius = options_.support * size_;
    parallel_for(
        nodes.size(), options_.threads,
        [&](std::size_t i) {
          const Point3 x = field.center(nodes[i]);
          double sum = 0.0, weights = 0.0;
          tree.for_each_within(x, radius, [&](const Neighbor& n) {
            const auto j = static_cast<std::size_t>(n.index);
            const double fade = 1.0 - n.distance2 / (radius * radius);
            const double w = fade * fade + 1e-6;
            sum += w * normals[j].dot(x - places[j]);
            weights += w;
          });
          value[i] = weights > 0.0 ? static_cast<float>(sum / weights)
                                   : std::numeric_limits<float>::quiet_NaN();
        },
        64);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      TsdfVoxel& voxel = write.ensure(nodes[i]);
      voxel = std::isnan(value[i]) ? TsdfVoxel{} : TsdfVoxel{value[i], 1.0F};
    }
    for (std::uint32_t s = 0; s < field.block_count(); ++s) field.mark_changed(s);
    return field;
  }

  const PointCloud* points_;
  const std::vector<std::uint8_t>* wanted_;
  double size_;
  SurfaceMeshOptions options_;
};
}  // namespace detail

/// The mesh of everything known at `min_weight`, outward normals at the vertices.
///
/// Where the zero of the distances runs along the hits, it is the surface. Triangles of the
/// distances that no hits back are left out, and so are those of thin bodies, whose sides tear each
/// other's distances. Points of the hits that the distances do not hold get patches: the zero of
/// the mean distance to the tangent planes of the points of one side, cut off where the points end,
/// `patch_radius` from the last of them at the most. Both sides of a sheet are there, and a rim
/// ends between them, open. A map without hits gives the mesh of its distances. `points` are those
/// of `extract_points` at the same `min_weight`. O(voxels near the surface + hits · neighbours).
inline TriangleMesh extract_surface(const TsdfMap& map, const PointCloud& points,
                                    const SurfaceMeshOptions& options) {
  TriangleMesh mesh = extract_mesh(
      map, {.min_weight = options.min_weight, .normals = false, .threads = options.threads});
  if (points.size() > 0) {
    const double h = map.voxel_size();
    const KdTree tree(points.points);
    const std::vector<std::uint8_t> thin = detail::thin_points(points, tree, h, options);
    std::vector<std::uint8_t> keep(mesh.triangles.size(), 0);
    parallel_for(
        keep.size(), options.threads,
        [&](std::size_t t) {
          const Eigen::Vector3d n = mesh.area_vector(t);
          const Point3 c = mesh.centroid(t);
          double nearest2 = std::numeric_limits<double>::infinity();
          tree.for_each_within(c, options.backed_within * h, [&](const Neighbor& near) {
            const auto j = static_cast<std::size_t>(near.index);
            const Eigen::Vector3d m = points.normals[j].cast<double>();
            if (near.distance2 >= nearest2 || m.dot(n) <= 0.0 ||
                std::abs(m.dot(c - points.points[j])) > options.held_within * h)
              return;
            nearest2 = near.distance2;
            keep[t] = thin[j] == 0 ? 1 : 0;
          });
        },
        256);
    mesh = selected(mesh, [&](std::size_t t) { return keep[t] != 0; });

    const detail::TriangleCells cells(mesh, h);
    std::vector<std::uint8_t> wanted = thin;  // those that get patches
    parallel_for(
        points.size(), options.threads,
        [&](std::size_t i) {
          if (wanted[i] == 0 && !cells.near(points.points[i], points.normals[i].cast<double>(),
                                            options.held_within * h))
            wanted[i] = 1;
        },
        256);
    const detail::PatchMesher patch(points, wanted, h, options);
    for (int side = 0; side < SurfaceHits::kSides; ++side) append(mesh, patch(side));
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}
/// The same where the points are of no further use.
inline TriangleMesh extract_surface(const TsdfMap& map, const SurfaceMeshOptions& options = {}) {
  return extract_surface(
      map, extract_points(map, {.min_weight = options.min_weight, .threads = options.threads}),
      options);
}
}  // namespace surfleet
