// SPDX-License-Identifier: MIT
/// @file  Clearance and collisions against a true mesh, by FCL.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Distances from points, and collisions of bodies, with a triangle mesh in a tree of oriented
/// boxes and swept spheres. The judge of a simulated mission: it knows nothing of the robots' map.
///
/// Degenerate triangles are fine; triangles with a coordinate that is not finite are left out.
/// Thread-safe. O(log triangles) a query for meshes of some shape.
class MeshJudge {
 public:
  explicit MeshJudge(const TriangleMesh& mesh) : model_(std::make_shared<Model>()) {
    const auto finite = [&](std::size_t t) {
      return mesh.corner(t, 0).allFinite() && mesh.corner(t, 1).allFinite() &&
             mesh.corner(t, 2).allFinite();
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles_ += finite(t) ? 1 : 0;
    if (triangles_ == 0) return;
    model_->beginModel(static_cast<int>(triangles_), static_cast<int>(3 * triangles_));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (finite(t)) model_->addTriangle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    model_->endModel();
  }

  /// Distance from `p` to the surface [m]; infinite for a mesh without triangles.
  double distance(const Point3& p) const {
    if (triangles_ == 0) return std::numeric_limits<double>::infinity();
    // A ball of no size: FCL has an exact routine for balls and triangles.
    constexpr double kRadius = 1e-6;
    const fcl::Sphered ball(kRadius);
    Pose at = Pose::Identity();
    at.translate(p);
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    fcl::distance(model_.get(), Pose::Identity(), &ball, at, request, result);
    return std::max(0.0, result.min_distance) + kRadius;
  }
  /// Whether a ball-shaped body at `p` touches the surface.
  bool collides(const Point3& p, double radius) const { return distance(p) < radius; }
  /// Whether any FCL geometry at the pose `T_world_body` touches the surface.
  bool collides(const fcl::CollisionGeometryd& body, const Pose& T_world_body) const {
    if (triangles_ == 0) return false;
    fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(model_.get(), Pose::Identity(), &body, T_world_body, request, result) > 0;
  }
  std::size_t triangle_count() const { return triangles_; }

 private:
  using Model = fcl::BVHModel<fcl::OBBRSSd>;
  std::shared_ptr<Model> model_;
  std::size_t triangles_ = 0;
};
}  // namespace surfleet
