// SPDX-License-Identifier: MIT
/// @file
/// @brief The part of a surface that a flying camera could have seen: what coverage is measured
/// against.
///
/// A surface has two sides, and each is looked at for itself: a sheet that can be seen from both is
/// covered twice, while nobody sees the inner side of a closed solid. A side of a surface point
/// counts as observable if some position of a cubic lattice exists that
/// 1. lies in the flight space and keeps the body's radius plus a margin away from every triangle
///    and from every box that is closed to robots,
/// 2. is joined to the start by steps between neighbours of the lattice (26 of them), each step
///    straight and keeping the radius all along,
/// 3. has the point between the camera's least and greatest depth and inside its image once the
///    body has turned so that the optical axis faces the point (heading is free, roll and pitch
///    are zero, the mount is fixed),
/// 4. lies on that side and meets the surface at no more than the incidence limit,
/// 5. sees the point: the ray from the camera to it is not blocked.
/// All nodes carry the flood of 2, every `stride`-th along each axis (and a choice of others in
/// front of the point) is looked from. The lattice makes the answer a lower bound of what a
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
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/ray_caster.hpp>

namespace surfleet {
/// Where a body may be.
struct FlightSpace {
  Box3 bounds;                          ///< Of the body's centre; world frame [m].
  Point3 start = Point3::Zero();        ///< A free position.
  double radius = 1.0;                  ///< Of the body [m].
  double margin = 0.0;                  ///< Kept on top of the radius [m].
  double spacing = 0.5;                 ///< Of the lattice [m].
  std::size_t max_nodes = 200'000'000;  ///< A lattice larger than this is refused.
  KeepOut keep_out{};                   ///< Closed to the body, and to nothing else.
};

/// The free positions of a lattice that can be reached from a start.
///
/// Only what the flood reaches is examined. O(reached nodes × log triangles).
class ReachableLattice {
 public:
  /// Throws `Error` on an empty box, lengths that are not positive, a lattice that is too large,
  /// or a start that is not free.
  ReachableLattice(const Bvh& obstacles, const FlightSpace& space)
      : spacing_(space.spacing), keep_out_(space.keep_out) {
    require(!space.bounds.isEmpty() && space.bounds.sizes().allFinite(),
            "flight space: expected a box with each minimum at most its maximum");
    require(space.spacing > 0.0 && space.radius > 0.0 && space.margin >= 0.0,
            "flight space: expected a positive spacing and radius and a margin of 0 or more");
    const Eigen::Array3d cells = (space.bounds.sizes().array() / spacing_ + 1e-9).floor() + 1.0;
    if (!(cells.prod() <= static_cast<double>(space.max_nodes)))
      throw Error("flight space: a lattice of " + std::to_string(cells.prod()) +
                  " positions; expected a larger spacing or a smaller box");
    size_ = cells.cast<std::int32_t>().matrix();
    // Centred in the box, so that both faces are treated alike.
    origin_ = space.bounds.min() + 0.5 * (space.bounds.sizes() - spacing_ * (cells - 1.0).matrix());
    reached_.assign(static_cast<std::size_t>(cells.prod()), 0);
    flood(obstacles, space);
  }

  double spacing() const { return spacing_; }
  const Eigen::Vector3i& size() const { return size_; }
  std::size_t count() const { return count_; }
  bool contains(const Eigen::Vector3i& n) const {
    return (n.array() >= 0).all() && (n.array() < size_.array()).all();
  }
  bool reached(const Eigen::Vector3i& n) const { return contains(n) && reached_[index(n)] != 0; }
  Point3 position(const Eigen::Vector3i& n) const { return origin_ + spacing_ * n.cast<double>(); }
  /// The node nearest to `p`, which may lie outside the lattice.
  Eigen::Vector3i nearest_node(const Point3& p) const {
    return ((p - origin_) / spacing_).array().round().cwiseMax(-1e9).cwiseMin(1e9).cast<int>();
  }
  std::vector<Point3> positions() const {
    std::vector<Point3> list;
    list.reserve(count_);
    for (std::int32_t z = 0; z < size_.z(); ++z)
      for (std::int32_t y = 0; y < size_.y(); ++y)
        for (std::int32_t x = 0; x < size_.x(); ++x)
          if (reached_[index({x, y, z})] != 0) list.push_back(position({x, y, z}));
    return list;
  }

 private:
  std::size_t index(const Eigen::Vector3i& n) const {
    return (static_cast<std::size_t>(n.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(n.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(n.x());
  }

  /// Whether a ball of `radius` can go straight from `a`, with `clear` metres to the nearest
  /// triangle, to `b`: steps as long as the clearance allows, and never shorter than 1 % of the
  /// spacing.
  bool passable(const Bvh& obstacles, const Point3& a, double clear, const Point3& b,
                double radius) const {
    const double length = (b - a).norm();
    double at = 0.0;
    while (clear >= radius) {
      at += std::max(clear - radius, 0.01 * spacing_);
      if (at >= length) return true;
      clear = clearance(obstacles, a + at / length * (b - a), radius + spacing_);
    }
    return false;
  }
  /// Distance to the nearest triangle or closed box, or `enough` if it is no nearer.
  double clearance(const Bvh& obstacles, const Point3& p, double enough) const {
    const auto nearest = obstacles.closest_point(p, enough);
    return std::min(nearest ? nearest->distance : enough, keep_out_.distance(p));
  }

  void flood(const Bvh& obstacles, const FlightSpace& space) {
    const double radius = space.radius + space.margin;
    const double enough = radius + 2.0 * spacing_;
    const double at_start = clearance(obstacles, space.start, enough);
    if (at_start < space.radius)
      throw Error("start: " + std::to_string(at_start) + " m from the surface; expected " +
                  std::to_string(space.radius) + " m or more");
    // A start nearer than radius + margin may still leave; the margin is demanded of the nodes.
    const double start_radius = std::min(radius, at_start);
    std::vector<float> clear(reached_.size(), -1.0F);  // −1: not looked at yet
    std::vector<Eigen::Vector3i> frontier;
    const auto free = [&](const Eigen::Vector3i& n) {
      float& c = clear[index(n)];
      if (c < 0.0F) c = static_cast<float>(clearance(obstacles, position(n), enough));
      return c >= static_cast<float>(radius);
    };
    const auto reach = [&](const Eigen::Vector3i& n) {
      reached_[index(n)] = 1;
      ++count_;
      frontier.push_back(n);
    };
    const Eigen::Vector3i seed = nearest_node(space.start);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const Eigen::Vector3i n = seed + Eigen::Vector3i(dx, dy, dz);
          if (contains(n) && free(n) &&
              passable(obstacles, space.start, at_start, position(n), start_radius))
            reach(n);
        }
    while (!frontier.empty()) {
      const Eigen::Vector3i at = frontier.back();
      frontier.pop_back();
      const double here = clear[index(at)];
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const Eigen::Vector3i n = at + Eigen::Vector3i(dx, dy, dz);
            if (!contains(n) || reached_[index(n)] != 0) continue;
            const double step =
                spacing_ * std::sqrt(static_cast<double>(dx * dx + dy * dy + dz * dz));
            if (!free(n)) continue;
            // Two balls of clearance that overlap enough cover the step between their centres.
            const double there = clear[index(n)];
            if (here + there >= 2.0 * radius + step ||
                passable(obstacles, position(at), here, position(n), radius))
              reach(n);
          }
    }
  }

  double spacing_;
  KeepOut keep_out_;
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  Point3 origin_ = Point3::Zero();
  std::vector<std::uint8_t> reached_;
  std::size_t count_ = 0;
};

struct ObservabilityOptions {
  PinholeCamera camera;
  Pose T_body_camera = forward_camera_mount();
  double max_incidence = radians(80.0);  ///< Between the ray and the surface's normal [rad].
  bool two_sided = true;                 ///< Either side counts, else that of the normal alone.
  int stride = 2;            ///< Every so many-th node is looked from; all carry the flood.
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

/// What a camera on a level body has in view once the body has turned so that the optical axis lies
/// in the vertical plane of the point (a camera that looks straight up or down: the body's x axis).
class BestHeadingView {
 public:
  BestHeadingView(const PinholeCamera& camera, const Pose& T_body_camera)
      : camera_(camera),
        offset_(T_body_camera.translation()),
        R_camera_body_(T_body_camera.linear().transpose()) {
    const Eigen::Vector3d axis = T_body_camera.linear().col(2);
    const double level = axis.head<2>().norm();
    if (level > 1e-6) heading_ = axis.head<2>() / level;
    // The point stands in the middle column unless the camera is rolled or looks up or down.
    const bool upright = level > 1e-6 && std::abs(T_body_camera.linear()(2, 0)) < 1e-9;
    for (const double u : {-0.5, camera.width - 0.5})
      for (const double v : {-0.5, camera.height - 0.5})
        reach_ = std::max(reach_, camera.ray(upright ? camera.cx : u, v).norm());
    reach_ = camera.max_range * reach_ + 2.0 * offset_.norm();
  }

  /// No point farther than this from the body is in view [m].
  double reach() const { return reach_; }

  /// Whether `sample` is in range and in the image from `position`; occlusion is not looked at.
  bool sees(const Point3& position, const Point3& sample) const {
    const Eigen::Vector3d to_sample = sample - position;
    const double level = to_sample.head<2>().norm();
    const Eigen::Vector3d in_body(level * heading_.x(), level * heading_.y(), to_sample.z());
    const Point3 p_camera = R_camera_body_ * (in_body - offset_);
    return p_camera.z() >= camera_.min_range && p_camera.z() <= camera_.max_range &&
           camera_.project(p_camera).has_value();
  }
  /// Where the camera is then.
  Point3 eye(const Point3& position, const Point3& sample) const {
    const Eigen::Vector2d to_sample = (sample - position).head<2>();
    const double level = to_sample.norm();
    if (level < 1e-12) return position + offset_;
    const Eigen::Vector2d d = to_sample / level;
    // Turning the heading onto the direction of the point.
    const double c = heading_.dot(d), s = heading_.x() * d.y() - heading_.y() * d.x();
    return position + Point3(c * offset_.x() - s * offset_.y(), s * offset_.x() + c * offset_.y(),
                             offset_.z());
  }

 private:
  PinholeCamera camera_;
  Eigen::Vector3d offset_;
  Eigen::Matrix3d R_camera_body_;
  Eigen::Vector2d heading_ = Eigen::Vector2d::UnitX();
  double reach_ = 0.0;
};

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
  const PinholeCamera& camera = options.camera;
  const BestHeadingView view(camera, options.T_body_camera);
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
  const std::array<double, 3> ranges{std::lerp(camera.min_range, camera.max_range, 0.5),
                                     std::lerp(camera.min_range, camera.max_range, 0.2),
                                     std::lerp(camera.min_range, camera.max_range, 0.85)};
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
        // The first of some positions that sees a side, if any does. Rays start a little off it.
        const auto sees = [&](std::span<const Point3> positions,
                              const Eigen::Vector3d& side) -> std::optional<Point3> {
          const Point3 origin = p + options.tolerance * side;
          std::array<Eigen::Vector3d, kBundle> rays;
          std::array<Point3, kBundle> from;
          std::array<double, kBundle> t;
          std::size_t count = 0;
          for (const Point3& q : positions) {
            if (!view.sees(q, p)) continue;
            const Point3 eye = view.eye(q, p);
            const double along = (eye - p).dot(side);
            if (along <= options.tolerance || along < min_cosine * (eye - p).norm()) continue;
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
              if (!sees(std::span<const Point3>(&q, 1), side)) continue;
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
              const auto one = sees(bundle, side);
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
