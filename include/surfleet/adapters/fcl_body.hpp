// SPDX-License-Identifier: MIT
/// @file
/// @brief Any FCL shape as a robot's collision body.
#pragma once

#include <memory>
#include <utility>

#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include <surfleet/core/error.hpp>
#include <surfleet/motion/collision_body.hpp>

namespace surfleet {
/// A convex FCL geometry (sphere, ellipsoid, box, capsule, convex hull, …) carried by the robot.
///
/// The geometry's own frame is the body's: x forward, z up, origin at the configuration's position.
/// A mesh (`BVHModel`) works as well, as a surface: a ball wholly inside it does not touch it.
class FclBody {
 public:
  using Geometry = fcl::CollisionGeometryd;

  /// `inscribed_radius`: of a ball about the origin inside the geometry; 0 is always true and
  /// merely slower. Throws `Error` without a geometry.
  explicit FclBody(std::shared_ptr<Geometry> geometry, double inscribed_radius = 0.0)
      : geometry_(std::move(geometry)), inscribed_(inscribed_radius) {
    require(geometry_ != nullptr && inscribed_radius >= 0.0,
            "FCL body: expected a geometry and an inscribed radius of 0 or more");
    geometry_->computeLocalAABB();
    bounding_ = geometry_->aabb_center.norm() + geometry_->aabb_radius;
  }

  const std::shared_ptr<Geometry>& geometry() const { return geometry_; }
  double inscribed_radius() const { return inscribed_; }
  double bounding_radius() const { return bounding_; }
  bool touches(const Configuration& q, const Sphere& ball) const {
    const fcl::Sphered sphere(ball.radius);
    Pose at = Pose::Identity();
    at.translate(ball.center);
    fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(geometry_.get(), q.pose(), &sphere, at, request, result) > 0;
  }

 private:
  std::shared_ptr<Geometry> geometry_;
  double inscribed_ = 0.0, bounding_ = 0.0;
};
static_assert(CollisionBody<FclBody>);
}  // namespace surfleet
