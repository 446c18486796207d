// SPDX-License-Identifier: MIT
/// @file
/// @brief Clearance and collisions against a true mesh, by FCL.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <surfleet/core/error.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Distances from points, and collisions of bodies, with a triangle mesh in a tree of oriented
/// boxes and swept spheres. The judge of a simulated mission: it knows nothing of the robots' map.
///
/// FCL's routine for balls and triangles divides by the square of a triangle's area: it says 0 for
/// three points on a line, from anywhere, and goes wrong beside them. Triangles less high than
/// `kSliver` times their longest edge are therefore held as that edge, a capsule of `kRadius`,
/// which FCL measures in closed form. Triangles with a coordinate that is not finite are left out.
/// All is held about the mesh's centre, so that a place far from the origin costs no digits.
///
/// Distances hold to 1e-8 of the distance and of the mesh's size plus 5e-6 of the longest edge of
/// a sliver. Thread-safe. O(log triangles) a query for meshes of some shape.
class MeshJudge {
 public:
  /// Where the error of FCL's routine meets that of an edge in a triangle's place.
  static constexpr double kSliver = 3e-6;
  static constexpr double kRadius = 1e-6;  ///< Of what has no extent itself [m].

  explicit MeshJudge(const TriangleMesh& mesh)
      : flat_(std::make_shared<Model>()), thin_(std::make_shared<Thin>()) {
    std::vector<std::array<Point3, 3>> flat;
    std::vector<std::array<Point3, 2>> thin;
    Box3 box;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::array<Point3, 3> c{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
      if (!(c[0].allFinite() && c[1].allFinite() && c[2].allFinite())) continue;
      for (const Point3& p : c) box.extend(p);
      std::size_t longest = 0;
      for (std::size_t k = 1; k < 3; ++k)
        if ((c[(k + 1) % 3] - c[k]).squaredNorm() >
            (c[(longest + 1) % 3] - c[longest]).squaredNorm())
          longest = k;
      const Point3 &a = c[longest], &b = c[(longest + 1) % 3];
      const double area2 = (b - a).cross(c[(longest + 2) % 3] - a).norm();
      if (area2 > kSliver * (b - a).squaredNorm())
        flat.push_back(c);
      else
        thin.push_back({a, b});
    }
    triangles_ = flat.size() + thin.size();
    if (triangles_ == 0) return;
    center_ = box.center();
    if (!flat.empty()) {
      flat_->beginModel(static_cast<int>(flat.size()), static_cast<int>(3 * flat.size()));
      for (const auto& c : flat) flat_->addTriangle(c[0] - center_, c[1] - center_, c[2] - center_);
      flat_->endModel();
    }
    for (const auto& [a, b] : thin) thin_->add(a - center_, b - center_);
    thin_->tree.setup();
  }

  /// Distance from `p` to the surface [m]; infinite for a mesh without triangles.
  double distance(const Point3& p) const {
    double least = std::numeric_limits<double>::infinity();
    if (triangles_ == 0) return least;
    // A ball of no size: FCL has a routine of its own for balls and triangles.
    const auto ball = std::make_shared<fcl::Sphered>(kRadius);
    Pose at = Pose::Identity();
    at.translate(p - center_);
    if (flat_->num_tris > 0) {
      const fcl::DistanceRequestd request;
      fcl::DistanceResultd result;
      fcl::distance(flat_.get(), Pose::Identity(), ball.get(), at, request, result);
      least = std::max(0.0, result.min_distance) + kRadius;
    }
    if (!thin_->objects.empty()) {
      fcl::CollisionObjectd body(ball, at);
      double found = least;
      thin_->tree.distance(&body, &found, nearer);
      least = std::min(least, found);
    }
    return least;
  }
  /// Whether a ball-shaped body at `p` touches the surface.
  bool collides(const Point3& p, double radius) const { return distance(p) < radius; }
  /// Whether any FCL geometry at the pose `T_world_body` touches the surface.
  bool collides(const fcl::CollisionGeometryd& body, const Pose& T_world_body) const {
    if (triangles_ == 0) return false;
    Pose at = T_world_body;
    at.translation() -= center_;
    const fcl::CollisionRequestd request;
    if (flat_->num_tris > 0) {
      fcl::CollisionResultd result;
      if (fcl::collide(flat_.get(), Pose::Identity(), &body, at, request, result) > 0) return true;
    }
    return !thin_->objects.empty() && thin_->collides(body, at);
  }
  /// Distance from any FCL geometry at the pose `T_world_body` to the surface [m], 0 where they
  /// touch; infinite for a mesh without triangles. O(log triangles + slivers).
  double distance(const fcl::CollisionGeometryd& body, const Pose& T_world_body) const {
    double least = std::numeric_limits<double>::infinity();
    if (triangles_ == 0) return least;
    if (collides(body, T_world_body)) return 0.0;
    Pose at = T_world_body;
    at.translation() -= center_;
    if (flat_->num_tris > 0) {
      const fcl::DistanceRequestd request;
      fcl::DistanceResultd result;
      fcl::distance(flat_.get(), Pose::Identity(), &body, at, request, result);
      least = std::max(0.0, result.min_distance);
    }
    for (const auto& edge : thin_->objects) {
      const fcl::DistanceRequestd request;
      fcl::DistanceResultd result;
      fcl::distance(edge->collisionGeometry().get(), edge->getTransform(), &body, at, request,
                    result);
      least = std::min(least, std::max(0.0, result.min_distance) + kRadius);
    }
    return least;
  }
  /// Those that are held: all with finite corners.
  std::size_t triangle_count() const { return triangles_; }
  /// Those of them that are held as edges.
  std::size_t sliver_count() const { return thin_->objects.size(); }

 private:
  using Model = fcl::BVHModel<fcl::OBBRSSd>;
  /// Edges in place of triangles without area.
  struct Thin {
    void add(const Point3& a, const Point3& b) {
      const Eigen::Vector3d along = b - a;
      const double length = along.norm();
      Pose at = Pose::Identity();
      at.translate(0.5 * (a + b));
      if (length > 0.0)
        at.rotate(rotation_between(Eigen::Vector3d::UnitZ(), along / length).toRotationMatrix());
      objects.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Capsuled>(kRadius, length), at));
      tree.registerObject(objects.back().get());
    }
    /// By the tree if the body has its local box, else one by one.
    bool collides(const fcl::CollisionGeometryd& body, const Pose& at) const {
      if (!(body.aabb_radius > 0.0))
        return std::any_of(objects.begin(), objects.end(),
                           [&](const auto& edge) { return touch(*edge, body, at); });
      Pose middle = Pose::Identity();
      middle.translate(at * body.aabb_center);
      const fcl::CollisionObjectd around(std::make_shared<fcl::Sphered>(body.aabb_radius), middle);
      Touch query{&body, &at, &around};
      // The manager's interface forgot a const.
      tree.collide(const_cast<fcl::CollisionObjectd*>(&around), &query, touches);
      return query.hit;
    }
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
    fcl::DynamicAABBTreeCollisionManagerd tree;
  };

  /// Lowers `*data` and `bound` to the distance from a ball of `kRadius` to an edge's middle.
  static bool nearer(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data,
                     double& bound) {
    const fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    fcl::distance(a, b, request, result);
    auto& least = *static_cast<double*>(data);
    least = std::min(least, std::max(0.0, result.min_distance) + 2.0 * kRadius);
    bound = least;
    return false;
  }
  static bool touch(const fcl::CollisionObjectd& edge, const fcl::CollisionGeometryd& body,
                    const Pose& at) {
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(edge.collisionGeometry().get(), edge.getTransform(), &body, at, request,
                        result) > 0;
  }
  struct Touch {
    const fcl::CollisionGeometryd* body;
    const Pose* at;
    const fcl::CollisionObjectd* around;  // what the tree is asked with
    bool hit = false;
  };
  static bool touches(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    auto& query = *static_cast<Touch*>(data);
    query.hit = touch(a == query.around ? *b : *a, *query.body, *query.at);
    return query.hit;
  }

  std::shared_ptr<Model> flat_;
  std::shared_ptr<Thin> thin_;
  Point3 center_ = Point3::Zero();
  std::size_t triangles_ = 0;
};
}  // namespace surfleet
