// SPDX-License-Identifier: MIT
/// @file
/// @brief Straight steps on a triangle mesh: a line that is unfolded over every edge it crosses,
/// with the heading carried along.
///
///     const SurfaceWalk walk(mesh);
///     const SurfaceStep step = walk(pose, {0.3, 0.1});  // 30 cm ahead, 10 cm to the left
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/surface_point.hpp>

namespace surfleet {
/// Where a straight step led.
struct SurfaceStep {
  SurfacePose pose;
  double length = 0.0;   ///< Travelled [m].
  bool stopped = false;  ///< Before its end, at a border or an edge of three or more triangles.
  std::vector<std::int32_t> entered;  ///< The triangles met after the first, in order.
  std::vector<Point3> crossings;      ///< Where each of them was entered.
};

/// Walks straight lines. The mesh must outlive it and stay as it is.
///
/// A line that meets a vertex passes it on one side, as a line beside it would. A step ends after
/// finitely many triangles: every one it enters either takes it further or turns it about a vertex,
/// and what rounding could add to that is cut off. O(triangles met) a step, O(n) to build.
class SurfaceWalk {
 public:
  /// Throws `Error` where the mesh is not valid or a triangle has no area; `clean_surface` makes
  /// one fit.
  explicit SurfaceWalk(const TriangleMesh& mesh) : mesh_(&mesh), half_(mesh) {
    require_valid_surface(mesh);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      require(mesh.area_vector(t).squaredNorm() > 0.0,
              "surface walk: a triangle without area; expected a mesh that was cleaned");
  }

  const TriangleMesh& mesh() const { return *mesh_; }
  const HalfEdges& half_edges() const { return half_; }

  std::int32_t twin(std::int32_t half_edge) const { return half_.twin(half_edge); }

  /// Takes `pose` straight along `ahead` = (forward, left) [m]. The heading keeps its angle to the
  /// line. The step ends early where it has entered `most` triangles.
  SurfaceStep operator()(const SurfacePose& pose, const Eigen::Vector2d& ahead,
                         std::size_t most = std::numeric_limits<std::size_t>::max()) const {
    SurfaceStep step;
    step.pose = pose;
    double left_over = ahead.norm();
    if (!(left_over > 0.0)) return step;
    const Eigen::Vector2d unit = ahead / left_over;
    SurfacePose& at = step.pose;
    Eigen::Vector3d line = unit.x() * at.forward + unit.y() * at.left();
    int entry = -1;  // corner opposite the edge just crossed
    std::size_t standing = 0;
    const std::size_t most_standing = mesh_->triangles.size() + 16;
    while (left_over > 0.0) {
      const auto t = static_cast<std::size_t>(at.at.triangle);
      // How fast each weight changes along the line.
      const Eigen::Vector3d n = mesh_->area_vector(t);
      const double whole = n.squaredNorm();
      Eigen::Vector3d rate;
      for (std::size_t k = 0; k < 3; ++k)
        rate[static_cast<Eigen::Index>(k)] =
            n.cross(mesh_->corner(t, (k + 2) % 3) - mesh_->corner(t, (k + 1) % 3)).dot(line) /
            whole;
      double reach = left_over;
      int exit = -1;
      for (int k = 0; k < 3; ++k) {
        if (k == entry || !(rate[k] < 0.0)) continue;
        const double until = at.at.weights[k] / -rate[k];
        if (until < reach) {
          reach = until;
          exit = k;
        }
      }
      at.at.weights = (at.at.weights + reach * rate).cwiseMax(0.0);
      if (exit >= 0) at.at.weights[exit] = 0.0;
      const double sum = at.at.weights.sum();
      if (sum > 0.0) at.at.weights /= sum;
      left_over -= reach;
      step.length += reach;
      if (exit < 0) break;
      standing = reach > 0.0 ? 0 : standing + 1;
      const std::int32_t out = 3 * at.at.triangle + (exit + 1) % 3, in = twin(out);
      if (in < 0 || standing > most_standing) {
        step.stopped = true;
        break;
      }
      line = cross(at, line, out, in);
      entry = (in + 2) % 3;
      step.entered.push_back(at.at.triangle);
      step.crossings.push_back(at.at.position(*mesh_));
      if (step.entered.size() == most) break;
    }
    // The heading keeps its angle to the line.
    const Eigen::Vector3d beside = at.up.cross(line);
    at.forward = (unit.x() * line - unit.y() * beside).normalized();
    return step;
  }

  /// Takes a pose that stands on the edge of half-edge `out` over to `in`, its twin, and returns
  /// `direction`, tangent here, as it goes on there.
  Eigen::Vector3d cross(SurfacePose& at, const Eigen::Vector3d& direction, std::int32_t out,
                        std::int32_t in) const {
    const auto here = static_cast<std::size_t>(out / 3), there = static_cast<std::size_t>(in / 3);
    const auto k = static_cast<std::size_t>(out % 3), j = static_cast<std::size_t>(in % 3);
    const Point3& a = mesh_->corner(here, k);
    const Eigen::Vector3d along = (mesh_->corner(here, (k + 1) % 3) - a).normalized();
    const auto inward = [&](std::size_t t, std::size_t apex) {
      const Eigen::Vector3d side = mesh_->corner(t, apex) - a;
      return Eigen::Vector3d((side - side.dot(along) * along).normalized());
    };
    const Eigen::Vector3d away = -inward(here, (k + 2) % 3), into = inward(there, (j + 2) % 3);
    const auto carried = [&](const Eigen::Vector3d& d) {
      return Eigen::Vector3d((d.dot(along) * along + d.dot(away) * into).normalized());
    };
    // Up is carried as a cross product of two that are: triangles may be turned the other way.
    const double handed = along.cross(away).dot(at.up);
    const Eigen::Vector3d line = carried(direction);
    at.forward = carried(at.forward);
    at.up = (handed < 0.0 ? -1.0 : 1.0) * along.cross(into).normalized();
    // Weights by vertex.
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();
    const bool same = half_.from(in) == half_.from(out);
    const auto i = [](std::size_t corner) { return static_cast<Eigen::Index>(corner % 3); };
    weights[i(j)] = at.at.weights[i(same ? k : k + 1)];
    weights[i(j + 1)] = at.at.weights[i(same ? k + 1 : k)];
    const double sum = weights.sum();
    at.at = {static_cast<std::int32_t>(there),
             sum > 0.0 ? Eigen::Vector3d(weights / sum) : Eigen::Vector3d::Constant(1.0 / 3.0)};
    return line;
  }

 private:
  const TriangleMesh* mesh_;
  HalfEdges half_;
};
}  // namespace surfleet
