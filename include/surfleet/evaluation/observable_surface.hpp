// SPDX-License-Identifier: MIT
/// @file
/// @brief The part of a surface that a flying camera or LiDAR could have seen: what coverage is
/// measured against.
///
/// A surface has two sides, and each counts for itself: a sheet that can be seen from both is
/// covered twice, while the inner side of a closed solid cannot be seen. A side of a surface point
/// counts as observable if some position of a cubic lattice exists that
/// 1. lies in the flight space and keeps the body's radius plus a margin away from every triangle
///    and from every box that is closed to robots,
/// 2. is joined to the start by steps between neighbours of the lattice (26 of them), each step
///    straight and keeping the radius all along,
/// 3. has the point between the camera's least and greatest depth and inside its image once the
///    body has turned so that the optical axis faces the point (heading is free, roll and pitch
///    are zero, the mount is fixed); or, for an upright LiDAR, within its range and between its
///    lowest and its highest beam, whatever the gaps between beams,
/// 4. lies on that side and meets the surface at no more than the incidence limit,
/// 5. sees the point: the ray from the camera to it is not blocked.
/// All nodes carry the flood of 2, every `stride`-th along each axis (and a choice of others in
/// front of the point) is viewed from. The lattice makes the answer a lower bound of what a
/// continuum of positions could see; a finer spacing tightens it. The start joins the lattice
/// through the free nodes next to it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/best_heading_view.hpp>
#include <surfleet/evaluation/reachable_lattice.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/ray_caster.hpp>

namespace surfleet {
struct ObservabilityOptions {
  PinholeCamera camera;
  Pose T_body_camera = forward_camera_mount();
  /// The sensor in place of the camera, upright at the camera's place, if any.
  std::optional<LidarModel> lidar{};
  double max_incidence = radians(80.0);  ///< Between the ray and the surface's normal [rad].
  bool two_sided = true;                 ///< Either side counts, else that of the normal alone.
  int stride = 2;            ///< Every so many-th node is viewed from; all carry the flood.
  double tolerance = 0.001;  ///< What is this near before the surface does not block it [m].
  int threads = 1;
};

/// What could have been seen, and from where.
struct ObservableSurface {
  static constexpr std::uint8_t kFront = 1;  ///< The side that the sample's normal points to.
  static constexpr std::uint8_t kBack = 2;   ///< The other.

  std::vector<std::uint8_t> seen_from;  ///< The sides of each sample that can be seen, as bits.
  /// Body positions that see the front and the back; undefined where none does.
  std::vector<std::array<Point3, 2>> viewers;
  std::size_t visible_count = 0;  ///< Samples of which some side can be seen.
  double fraction() const {
    return seen_from.empty()
               ? 0.0
               : static_cast<double>(visible_count) / static_cast<double>(seen_from.size());
  }
};

/// The samples that can be seen, each with its normal turned to the side it can be seen from; one
/// that can be seen from both is there twice. Fronts come first, in their order, then backs.
inline PointCloud oriented_samples(const PointCloud& samples, const ObservableSurface& seen) {
  require(samples.normals.size() == samples.size() && seen.seen_from.size() == samples.size(),
          "oriented samples: expected normals and sides, one a sample");
  PointCloud oriented;
  for (const std::uint8_t side : {ObservableSurface::kFront, ObservableSurface::kBack})
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if ((seen.seen_from[i] & side) == 0) continue;
      const Eigen::Vector3f& n = samples.normals[i];
      oriented.points.push_back(samples.points[i]);
      oriented.normals.push_back(side == ObservableSurface::kFront ? n : Eigen::Vector3f(-n));
    }
  return oriented;
}

/// Which sides of `samples` (with normals) the camera could have seen from the lattice; see the
/// head of this file for what "could" means. Rays are cast by `scene`, the true surface.
///
/// Each side first tries a few dozen positions ordered by their angle to its normal, which settles
/// most of what is visible, then every `stride`-th node in range, frontal ones first, until one
/// sees it. O(samples × nodes in range / stride³) rays at worst. Rays start at the sample, where
/// the inner side of a solid meets its own walls first.
template <RayCaster Caster>
ObservableSurface observable_surface(const PointCloud& samples, const Caster& scene,
                                     const ReachableLattice& lattice,
                                     const ObservabilityOptions& options) {
  require(samples.normals.size() == samples.size(),
          "observable surface: expected samples with normals");
  require(options.max_incidence > 0.0 && options.max_incidence <= 0.5 * kPi,
          "observable surface: expected an incidence limit in (0, 90] degrees");
  require(options.stride >= 1, "observable surface: expected a stride of 1 or more");
  const double min_cosine = std::cos(options.max_incidence);
  const BestHeadingView view =
      options.lidar ? BestHeadingView(*options.lidar, options.T_body_camera.translation())
                    : BestHeadingView(options.camera, options.T_body_camera);
  const double nearest = options.lidar ? options.lidar->min_range : options.camera.min_range;
  const double farthest = options.lidar ? options.lidar->max_range : options.camera.max_range;
  const double reach = view.reach();
  const int stride = options.stride;
  // Directions over the hemisphere, nearest to the pole first.
  std::vector<Eigen::Vector3d> fan{Eigen::Vector3d::UnitZ()};
  for (const auto& [angle, count] : {std::pair{0.35, 6}, {0.7, 8}, {1.05, 12}})
    for (int k = 0; k < count && angle < options.max_incidence; ++k) {
      const double turn = 2.0 * kPi * k / count;
      fan.emplace_back(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                       std::cos(angle));
    }
  const std::array<double, 3> ranges{std::lerp(nearest, farthest, 0.5),
                                     std::lerp(nearest, farthest, 0.2),
                                     std::lerp(nearest, farthest, 0.85)};
  const int shell = static_cast<int>(std::ceil(reach / lattice.spacing())) + 1;

  constexpr std::size_t kBundle = 16;  // rays cast at a time
  ObservableSurface result;
  result.seen_from.assign(samples.size(), 0);
  result.viewers.assign(samples.size(), {Point3::Zero(), Point3::Zero()});
  parallel_for(
      samples.size(), options.threads,
      [&](std::size_t i) {
        const Point3& p = samples.points[i];
        const Eigen::Vector3d normal = samples.normals[i].cast<double>();
        // The first of some positions with the sample in view from which a side shows, if any does.
        // Rays start a little off it.
        const auto shows_from = [&](std::span<const Point3> positions,
                                    const Eigen::Vector3d& side) -> std::optional<Point3> {
          const Point3 origin = p + options.tolerance * side;
          std::array<Eigen::Vector3d, kBundle> rays;
          std::array<Point3, kBundle> from;
          std::array<double, kBundle> t;
          std::size_t count = 0;
          for (const Point3& q : positions) {
            const Point3 eye = view.eye(q, p);
            const Eigen::Vector3d to_eye = eye - p;
            const double along = to_eye.dot(side);
            if (along <= options.tolerance || along < min_cosine * to_eye.norm()) continue;
            from[count] = q;
            rays[count++] = eye - origin;
          }
          if (count == 0) return std::nullopt;
          cast_bundle(scene, origin, std::span<const Eigen::Vector3d>(rays.data(), count), 1.0,
                      std::span<double>(t.data(), count));
          for (std::size_t r = 0; r < count; ++r)
            if (!(t[r] <= 1.0)) return from[r];
          return std::nullopt;
        };
        // Whether a position of the fan sees the side; most of what is visible is settled so.
        const auto at_once = [&](const Eigen::Vector3d& side, Point3& viewer) {
          const Eigen::Matrix3d frame =
              rotation_between(Eigen::Vector3d::UnitZ(), side).toRotationMatrix();
          for (const Eigen::Vector3d& d : fan)
            for (const double range : ranges) {
              const Eigen::Vector3i node = lattice.nearest_node(p + range * (frame * d));
              if (!lattice.reached(node)) continue;
              const Point3 q = lattice.position(node);
              if (!view.sees(q, p) || !shows_from(std::span<const Point3>(&q, 1), side)) continue;
              viewer = q;
              return true;
            }
          return false;
        };
        std::array<bool, 2> seen{};
        const std::size_t sides = options.two_sided ? 2 : 1;
        for (std::size_t k = 0; k < sides; ++k)
          seen[k] = at_once(k == 0 ? normal : -normal, result.viewers[i][k]);
        for (std::size_t k = 0; k < sides; ++k) {
          if (seen[k]) continue;
          const Eigen::Vector3d side = k == 0 ? normal : -normal;
          std::array<std::vector<Point3>, 2> candidates;  // the frontal ones, the rest
          const Eigen::Vector3i centre = lattice.nearest_node(p);
          const auto first = [&](int axis) {
            return (std::max(centre[axis] - shell, 0) + stride - 1) / stride * stride;
          };
          const Eigen::Vector3i last = (centre.array() + shell).min(lattice.size().array() - 1);
          // Most nodes are behind the side or out of reach, so that is asked first.
          const Eigen::Vector3d from = lattice.position(Eigen::Vector3i::Zero()) - p;
          const double step = lattice.spacing();
          for (int z = first(2); z <= last.z(); z += stride)
            for (int y = first(1); y <= last.y(); y += stride) {
              const double dy = from.y() + step * y, dz = from.z() + step * z;
              const double along_row = dy * side.y() + dz * side.z(), row2 = dy * dy + dz * dz;
              for (int x = first(0); x <= last.x(); x += stride) {
                const double dx = from.x() + step * x;
                const double along = along_row + dx * side.x(), away2 = row2 + dx * dx;
                if (along < 0.0 || away2 > reach * reach) continue;
                const Eigen::Vector3i node(x, y, z);
                if (!lattice.reached(node)) continue;
                const Point3 q = lattice.position(node);
                if (!view.sees(q, p)) continue;
                candidates[along * along >= 0.5 * away2 ? 0 : 1].push_back(q);
              }
            }
          for (const std::vector<Point3>& list : candidates)
            for (std::size_t at = 0; at < list.size() && !seen[k]; at += kBundle) {
              const std::span<const Point3> bundle(list.data() + at,
                                                   std::min(kBundle, list.size() - at));
              const auto one = shows_from(bundle, side);
              if (!one) continue;
              result.viewers[i][k] = *one;
              seen[k] = true;
            }
        }
        if (seen[0]) result.seen_from[i] |= ObservableSurface::kFront;
        if (seen[1]) result.seen_from[i] |= ObservableSurface::kBack;
      },
      64);
  result.visible_count = samples.size() - static_cast<std::size_t>(std::count(
                                              result.seen_from.begin(), result.seen_from.end(), 0));
  return result;
}
}  // namespace surfleet
