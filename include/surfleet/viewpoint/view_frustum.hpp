// SPDX-License-Identifier: MIT
/// @file
/// @brief What a camera on a robot with four degrees of freedom, and a gimbal's pitch, has in its
/// field of view.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// The truncated pyramid between a camera's nearest and farthest depth, carried by a body.
class ViewFrustum {
 public:
  explicit ViewFrustum(const PinholeCamera& camera,
                       const Pose& T_body_camera = forward_camera_mount())
      : camera_(camera), T_body_camera_(T_body_camera) {
    require_range(camera.min_range, camera.max_range, "camera");
    const double left = (camera.cx + 0.5) / camera.fx;
    const double right = (camera.width - 0.5 - camera.cx) / camera.fx;
    const double top = (camera.cy + 0.5) / camera.fy;
    const double bottom = (camera.height - 0.5 - camera.cy) / camera.fy;
    const std::array<Eigen::Vector4d, 6> in_camera = {Eigen::Vector4d(1, 0, left, 0),
                                                      Eigen::Vector4d(-1, 0, right, 0),
                                                      Eigen::Vector4d(0, 1, top, 0),
                                                      Eigen::Vector4d(0, -1, bottom, 0),
                                                      Eigen::Vector4d(0, 0, 1, -camera.min_range),
                                                      Eigen::Vector4d(0, 0, -1, camera.max_range)};
    const Eigen::Matrix3d R = T_body_camera.linear();
    for (std::size_t i = 0; i < 6; ++i) {
      normals_[i] = R * in_camera[i].head<3>();
      offsets_[i] = in_camera[i].w() - normals_[i].dot(T_body_camera.translation());
    }
    const double near = camera.min_range, far = camera.max_range;
    std::size_t n = 0;
    for (const double z : {near, far})
      for (const double x : {-left, right})
        for (const double y : {-top, bottom})
          corners_[n++] = T_body_camera * Point3(x * z, y * z, z);
  }

  const PinholeCamera& camera() const { return camera_; }
  const Pose& T_body_camera() const { return T_body_camera_; }
  /// The optical axis in the body frame, unit.
  Eigen::Vector3d axis() const { return T_body_camera_.linear().col(2); }

  /// Whether a point of the body frame projects into the image at a depth that is measured.
  bool contains(const Point3& p_body) const {
    for (std::size_t i = 0; i < 6; ++i)
      if (normals_[i].dot(p_body) + offsets_[i] < 0.0) return false;
    return true;
  }
  /// The same for a point of the world and a body at `q`.
  bool contains(const Configuration& q, const Point3& p_world) const {
    return at(q).contains(p_world);
  }

  /// The frustum of a body that stays at one configuration.
  class Placed {
   public:
    Placed(const ViewFrustum& frustum, const Configuration& q)
        : frustum_(&frustum),
          position_(q.position),
          cos_(std::cos(q.yaw)),
          sin_(std::sin(q.yaw)),
          tilted_(q.pitch != 0.0),
          cos_pitch_(tilted_ ? std::cos(q.pitch) : 1.0),
          sin_pitch_(tilted_ ? std::sin(q.pitch) : 0.0) {}

    /// Between the world and the frame in which the frustum stands: the body's, carried along with
    /// the camera where a gimbal tilts that.
    Point3 to_body(const Point3& p_world) const {
      const Eigen::Vector3d d = p_world - position_;
      const Point3 p(cos_ * d.x() + sin_ * d.y(), cos_ * d.y() - sin_ * d.x(), d.z());
      return tilted_ ? tilted(p, -sin_pitch_) : p;
    }
    Point3 to_world(const Point3& p_body) const {
      const Point3 p = tilted_ ? tilted(p_body, sin_pitch_) : p_body;
      return position_ + Point3(cos_ * p.x() - sin_ * p.y(), sin_ * p.x() + cos_ * p.y(), p.z());
    }
    bool contains(const Point3& p_world) const { return frustum_->contains(to_body(p_world)); }
    /// False only if no point of the ball is inside.
    bool may_contain(const Point3& center_world, double radius) const {
      const Point3 p = to_body(center_world);
      for (std::size_t i = 0; i < 6; ++i)
        if (frustum_->normals_[i].dot(p) + frustum_->offsets_[i] <
            -radius * frustum_->normals_[i].norm())
          return false;
      return true;
    }
    /// The camera's centre in the world.
    Point3 eye() const { return to_world(frustum_->T_body_camera_.translation()); }
    /// The optical axis in the world, unit.
    Eigen::Vector3d axis() const {
      if (!tilted_) return to_world(frustum_->axis()) - position_;
      return to_world(frustum_->T_body_camera_.translation() + frustum_->axis()) - eye();
    }
    /// Axis-aligned bounds in the world.
    Box3 bounds() const {
      Box3 box;
      for (const Point3& c : frustum_->corners_) box.extend(to_world(c));
      return box;
    }

   private:
    /// Turned about the camera's centre and the body's y axis.
    Point3 tilted(const Point3& p, double sin) const {
      const Point3& c = frustum_->T_body_camera_.translation();
      const Eigen::Vector3d d = p - c;
      return c + Point3(cos_pitch_ * d.x() + sin * d.z(), d.y(), cos_pitch_ * d.z() - sin * d.x());
    }

    const ViewFrustum* frustum_;
    Point3 position_;
    double cos_, sin_;
    bool tilted_;
    double cos_pitch_, sin_pitch_;
  };
  /// Refers to this frustum, which must outlive it.
  Placed at(const Configuration& q) const { return Placed(*this, q); }

 private:
  PinholeCamera camera_;
  Pose T_body_camera_;
  std::array<Eigen::Vector3d, 6> normals_;  // inward, in the body frame
  std::array<double, 6> offsets_;
  std::array<Point3, 8> corners_;  // in the body frame
};
}  // namespace surfleet
