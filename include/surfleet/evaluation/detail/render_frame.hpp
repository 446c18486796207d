// SPDX-License-Identifier: MIT
/// @file
/// @brief A view's coordinates and the pixels that a triangle covers in it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/render_view.hpp>

namespace surfleet::detail {
/// A view's coordinates: camera x right, y down, z forward; pixels with centres at integers.
struct RenderFrame {
  RenderFrame() = default;
  RenderFrame(const RenderView& view, int w, int h) : width(w), height(h), eye(view.eye) {
    forward = (view.target - view.eye).stableNormalized();
    if (!(forward.squaredNorm() > 0.5)) forward = Eigen::Vector3d::UnitX();
    right = forward.cross(view.up);
    if (right.norm() < 1e-9) right = forward.cross(Eigen::Vector3d::UnitY());
    if (right.norm() < 1e-9) right = forward.cross(Eigen::Vector3d::UnitX());
    right.normalize();
    down = forward.cross(right);
    orthographic = view.orthographic_height > 0.0;
    focal =
        orthographic ? h / view.orthographic_height : 0.5 * h / std::tan(0.5 * view.vertical_fov);
    near = orthographic ? -1e9 : 1e-3 * std::max(1.0, (view.target - view.eye).norm());
  }
  int width = 0, height = 0;
  Point3 eye = Point3::Zero();
  Eigen::Vector3d forward, right, down;
  bool orthographic = false;
  double focal = 1.0, near = 0.0;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  Point3 to_camera(const Point3& p) const {
    const Eigen::Vector3d v = p - eye;
    return {v.dot(right), v.dot(down), v.dot(forward)};
  }
  bool in_front(const Point3& c) const { return c.z() >= near; }
  /// Pixel and depth.
  Point3 project(const Point3& c) const {
    const double s = orthographic ? focal : focal / c.z();
    return {s * c.x() + 0.5 * (width - 1), s * c.y() + 0.5 * (height - 1), c.z()};
  }
  Point3 to_world(double x, double y, double z) const {
    const double s = orthographic ? 1.0 / focal : z / focal;
    return eye + (x - 0.5 * (width - 1)) * s * right + (y - 0.5 * (height - 1)) * s * down +
           z * forward;
  }
  bool clip_near(Point3& a, Point3& b) const {
    if (in_front(a) && in_front(b)) return true;
    if (!in_front(a) && !in_front(b)) return false;
    const Point3 cut = a + (near - a.z()) / (b.z() - a.z()) * (b - a);
    (in_front(a) ? b : a) = cut;
    return true;
  }
};

/// A corner of a triangle to be drawn.
struct RenderCorner {
  Point3 world;
  Eigen::Vector3f normal, color;
};

/// Calls `put(pixel, depth, weights)` for the pixels of a triangle before the near plane; each
/// vertex is a point of the camera frame and its weights in a larger triangle.
template <typename Vertex, typename Put>
void fill_front_triangle(const RenderFrame& frame, const Vertex& va, const Vertex& vb,
                         const Vertex& vc, Put&& put) {
  const Point3 a = frame.project(va.first), b = frame.project(vb.first),
               c = frame.project(vc.first);
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (!(std::abs(area) > 1e-12)) return;
  const auto whole = [](double v, double low, double high) {
    return static_cast<int>(std::clamp(v, low, high));
  };
  const int x0 = whole(std::ceil(std::min({a.x(), b.x(), c.x()})), 0.0, frame.width);
  const int x1 = whole(std::floor(std::max({a.x(), b.x(), c.x()})), -1.0, frame.width - 1);
  const int y0 = whole(std::ceil(std::min({a.y(), b.y(), c.y()})), 0.0, frame.height);
  const int y1 = whole(std::floor(std::max({a.y(), b.y(), c.y()})), -1.0, frame.height - 1);
  // Perspective: what is linear on the screen is 1/z and weight/z.
  const auto q = [&](const Point3& p) { return frame.orthographic ? 1.0 : 1.0 / p.z(); };
  const double qa = q(a), qb = q(b), qc = q(c);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double wa = ((b.x() - x) * (c.y() - y) - (b.y() - y) * (c.x() - x)) / area;
      const double wb = ((c.x() - x) * (a.y() - y) - (c.y() - y) * (a.x() - x)) / area;
      const double wc = 1.0 - wa - wb;
      if (wa < -1e-9 || wb < -1e-9 || wc < -1e-9) continue;
      const double sum = wa * qa + wb * qb + wc * qc;
      const double ua = wa * qa / sum, ub = wb * qb / sum, uc = wc * qc / sum;
      put(frame.index(x, y), ua * a.z() + ub * b.z() + uc * c.z(),
          [&] { return Eigen::Vector3d(ua * va.second + ub * vb.second + uc * vc.second); });
    }
}
/// Calls `put(pixel, depth, weights)` for the pixels of a triangle, cut at the near plane.
/// O(covered pixels).
template <typename Put>
void fill_triangle(const RenderFrame& frame, const std::array<RenderCorner, 3>& corners,
                   Put&& put) {
  std::array<Point3, 3> c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = frame.to_camera(corners[k].world);
  // Cut polygon: points of the camera frame with their weights in the whole triangle.
  std::array<std::pair<Point3, Eigen::Vector3d>, 4> cut;
  std::size_t n = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t m = (k + 1) % 3;
    const bool here = frame.in_front(c[k]), there = frame.in_front(c[m]);
    const auto unit = [](std::size_t i) {
      return Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i)).eval();
    };
    if (here) cut[n++] = {c[k], unit(k)};
    if (here != there) {
      const double f = (frame.near - c[k].z()) / (c[m].z() - c[k].z());
      cut[n++] = {c[k] + f * (c[m] - c[k]), (1.0 - f) * unit(k) + f * unit(m)};
    }
  }
  for (std::size_t k = 2; k < n; ++k) fill_front_triangle(frame, cut[0], cut[k - 1], cut[k], put);
}
}  // namespace surfleet::detail
