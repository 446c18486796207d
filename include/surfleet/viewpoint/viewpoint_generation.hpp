// SPDX-License-Identifier: MIT
/// @file
/// @brief Viewpoints for incomplete surface elements.
///
///     const auto views = generate_viewpoints(incomplete, states, camera, {.distance = 4.7},
///                                            is_free);
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/detail/point_cells.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/revealing_view.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/viewpoint.hpp>
#include <surfleet/viewpoint/viewpoint_predicates.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
struct ViewpointOptions {
  double distance = 4.7;      ///< δ_pose: from the element to the camera [m].
  double min_distance = 0.0;  ///< Nearest that is tried [m], if the camera sees as near.
  /// Farthest that is tried [m]; nothing: as far as the camera's farthest depth.
  std::optional<double> max_distance{};
  double distance_step = 0.5;         ///< Between distances that are tried [m].
  double max_angle = radians(100.0);  ///< Largest between n̄_v and the line of sight [rad].
  double angle_step = radians(15.0);  ///< Between lines of sight that are tried [rad].
  double margin =
      radians(3.0);     ///< Kept between elements and the image's upper and lower edge [rad].
  int max_tries = 256;  ///< Poses that are asked about for one element.
  bool unknown_blocks = false;  ///< Whether unknown voxels end the line of sight.
  bool known_eye = true;        ///< Whether the camera must be in a voxel known to be empty.
  Pose T_body_camera = forward_camera_mount();
};

namespace detail {
/// A line of sight, from the element to the camera, and the robot's configuration to view along it.
struct ViewLine {
  Eigen::Vector3d direction;     ///< Unit.
  double yaw = 0.0;              ///< That turns the optical axis over the azimuth of −direction.
  Eigen::Vector3d eye_offset;    ///< From the body's to the camera's position, world frame [m].
  double depth_per_metre = 0.0;  ///< Along the optical axis.
};

/// The lines of sight from which a mounted camera can have a point in its image at all, whatever
/// the robot's heading: a band of elevations about the optical axis.
class ViewLines {
 public:
  ViewLines(const ViewFrustum& frustum, const ViewpointOptions& o)
      : axis_(frustum.axis()), eye_(frustum.T_body_camera().translation()) {
    const PinholeCamera& c = frustum.camera();
    const double up = std::atan((c.cy + 0.5) / c.fy);
    const double down = std::atan((c.height - 0.5 - c.cy) / c.fy);
    const double half = std::max(0.0, std::min(up, down) - o.margin);
    const double center = -std::asin(std::clamp(axis_.z(), -1.0, 1.0));
    axis_azimuth_ = axis_.head<2>().norm() > 1e-9 ? std::atan2(axis_.y(), axis_.x()) : 0.0;
    low_ = std::max(-0.5 * kPi, center - half);
    high_ = std::min(0.5 * kPi, center + half);
    const int levels = 1 + static_cast<int>(std::ceil((high_ - low_) / o.angle_step - 1e-9));
    for (int i = 0; i < levels; ++i) {
      const double elevation =
          levels == 1 ? low_ : low_ + (high_ - low_) * i / static_cast<double>(levels - 1);
      const int around = std::max(
          1, static_cast<int>(std::ceil(2.0 * kPi * std::cos(elevation) / o.angle_step - 1e-6)));
      for (int k = 0; k < around; ++k)
        fan_.push_back(line(unit(2.0 * kPi * k / around, elevation)));
    }
  }

  /// Lines over the whole band, about an angle step apart.
  std::span<const ViewLine> fan() const { return fan_; }

  /// The line of the band that is nearest to the direction `n`; nothing if many are equally near.
  std::optional<ViewLine> nearest(const Eigen::Vector3d& n) const {
    const double level = n.head<2>().norm();
    const double elevation = std::atan2(n.z(), level);
    const double clamped = std::clamp(elevation, low_, high_);
    if (elevation == clamped) return line(n);
    if (level < 1e-6) return std::nullopt;
    return line(unit(std::atan2(n.y(), n.x()), clamped));
  }

 private:
  static Eigen::Vector3d unit(double azimuth, double elevation) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }
  ViewLine line(const Eigen::Vector3d& d) const {
    const double azimuth = d.head<2>().norm() > 1e-9 ? std::atan2(-d.y(), -d.x()) : 0.0;
    ViewLine l;
    l.direction = d;
    l.yaw = wrap_angle(azimuth - axis_azimuth_);
    const Eigen::AngleAxisd turn(l.yaw, Eigen::Vector3d::UnitZ());
    l.eye_offset = turn * eye_;
    l.depth_per_metre = -(turn * axis_).dot(d);
    return l;
  }

  Eigen::Vector3d axis_, eye_;  // body frame
  double axis_azimuth_ = 0.0, low_ = 0.0, high_ = 0.0;
  std::vector<ViewLine> fan_;
};

/// The distances to try, the preferred one first, then outwards from it.
inline std::vector<double> view_distances(const PinholeCamera& camera, const ViewpointOptions& o) {
  const double low = std::max(o.min_distance, camera.min_range);
  const double high = o.max_distance.value_or(camera.max_range * std::sqrt(2.0));
  std::vector<double> d;
  if (o.distance >= low && o.distance <= high) d.push_back(o.distance);
  for (int i = 1; o.distance - i * o.distance_step > low || o.distance + i * o.distance_step < high;
       ++i) {
    const double nearer = o.distance - i * o.distance_step;
    const double farther = o.distance + i * o.distance_step;
    if (nearer >= low && nearer <= high) d.push_back(nearer);
    if (farther >= low && farther <= high) d.push_back(farther);
  }
  return d;
}
}  // namespace detail

/// A viewpoint for an element from which it is really seen, or the reason why there is none
/// [000 §2.4.2].
///
/// The camera is put at `distance` along n̄_v, or along the nearest direction from which the mount
/// lets a robot with four degrees of freedom view it, and turned towards the element. If the
/// element is not in sight from there, or the robot cannot be there, others are tried: first
/// distances within about a step of the wanted one, over directions by growing angle to n̄_v up to
/// `max_angle`; then all other distances over the same fan of directions. An element without
/// direction takes directions as they come. Every view reveals its element: it is in the frustum
/// and in sight, and so is one of its unknown neighbours. One object a thread; the map must outlive
/// it and not gain blocks meanwhile.
class ViewpointGenerator {
 public:
  /// Throws `Error` on a distance or a step that is not positive.
  ViewpointGenerator(const VoxelStateMap& map, const PinholeCamera& camera,
                     const ViewpointOptions& options)
      : map_(&map),
        options_(checked(options)),
        frustum_(camera, options.T_body_camera),
        lines_(frustum_, options),
        distances_(detail::view_distances(camera, options)),
        min_distance_(std::max(options.min_distance, camera.min_range)),
        min_cosine_(std::cos(options.max_angle)),
        sight_(map, {.unknown_blocks = options.unknown_blocks}) {}

  /// `is_free` and `is_reachable` hold for the view, `promises` holds for its line of sight.
  /// O(tries), one where nothing occludes.
  template <ConfigurationPredicate IsFree, ConfigurationPredicate IsReachable = AlwaysTrue,
            ViewPredicate Promises = AlwaysTrue>
  ViewpointChoice operator()(const IncompleteElement& e, const IsFree& is_free,
                             const IsReachable& is_reachable = {}, const Promises& promises = {}) {
    const PinholeCamera& camera = frustum_.camera();
    const auto first = std::span(distances_).first(std::min<std::size_t>(3, distances_.size()));
    const auto rest = std::span(distances_).subspan(first.size());
    const bool directed = !e.direction.isZero();
    int tries = 0;
    bool in_band = false, in_sight = false, free = false, refused = false;
    ViewpointChoice choice;
    choice.asked.extend(e.position);

    const auto attempt = [&](const detail::ViewLine& l, std::span<const double> lengths) {
      if (directed && e.direction.dot(l.direction) < min_cosine_) return false;
      if (!promises(e, l.direction)) {
        refused = true;
        return false;
      }
      in_band = true;
      double clear = -1.0;  // how far one sees from the element; not known yet
      for (const double distance : lengths) {
        if (tries >= options_.max_tries) return false;
        const double depth = distance * l.depth_per_metre;
        if (depth < camera.min_range || depth > camera.max_range) continue;
        if (clear < 0.0) {
          const auto [nearest, farthest] = std::minmax_element(lengths.begin(), lengths.end());
          const double voxel = map_->voxel_size();
          clear = voxel +
                  clear_along(e, l.direction, *nearest - 1.001 * voxel, *farthest, choice.asked);
        }
        if (distance > clear) continue;
        const Point3 eye = e.position + distance * l.direction;
        choice.asked.extend(eye);
        if (options_.known_eye && sight_.state(map_->grid().index_of(eye)) != VoxelState::empty)
          continue;
        const Configuration q{eye - l.eye_offset, l.yaw};
        if (!reveals(frustum_.at(q), e, sight_)) continue;
        in_sight = true;
        ++tries;
        choice.asked.extend(q.position);
        if (!is_free(q)) continue;
        free = true;
        if (!is_reachable(q)) {
          choice.out_of_reach = true;
          continue;
        }
        choice.view = Viewpoint{q, l.direction, {}};
        return true;
      }
      return false;
    };

    const auto ideal = directed ? lines_.nearest(e.direction) : std::nullopt;
    if (ideal && attempt(*ideal, first)) return choice;
    const auto fan = lines_.fan();
    order_.clear();
    for (std::size_t k = 0; k < fan.size(); ++k) {
      const double cosine = directed ? e.direction.dot(fan[k].direction) : 1.0;
      if (cosine >= min_cosine_) order_.emplace_back(cosine, -static_cast<std::ptrdiff_t>(k));
    }
    const auto line_of = [&](const auto& c) -> const detail::ViewLine& {
      return fan[static_cast<std::size_t>(-c.second)];
    };
    // The nearest direction first: a heap, as the search mostly ends early; sorted if it does not.
    std::make_heap(order_.begin(), order_.end());
    for (auto heap_end = order_.end(); heap_end != order_.begin(); --heap_end) {
      std::pop_heap(order_.begin(), heap_end);
      if (attempt(line_of(*std::prev(heap_end)), first)) return choice;
    }
    for (auto it = order_.rbegin(); it != order_.rend() && tries < options_.max_tries; ++it)
      if (attempt(line_of(*it), rest)) return choice;

    const auto opens = [&](const auto& c) {
      return clear_along(e, line_of(c).direction, min_distance_, min_distance_, choice.asked) >=
             min_distance_;
    };
    choice.reason = free       ? NoViewReason::unreachable
                    : refused  ? NoViewReason::viewed_in_vain
                    : !in_band ? NoViewReason::outside_view
                    : in_sight || std::any_of(order_.begin(), order_.end(), opens)
                        ? NoViewReason::no_free_pose
                        : NoViewReason::occluded;
    return choice;
  }

 private:
  static const ViewpointOptions& checked(const ViewpointOptions& o) {
    require(o.distance > 0.0 && std::isfinite(o.distance),
            "viewpoint distance: expected a positive length");
    require(std::isfinite(o.min_distance) && std::isfinite(o.max_distance.value_or(0.0)),
            "viewpoint distance: expected finite bounds");
    require(o.distance_step > 0.01 && o.angle_step > 0.01 && o.max_tries > 0,
            "viewpoint steps: expected more than 1 cm, more than 0.01 rad and at least one try");
    return o;
  }
  /// How far away along a line, at most `limit`, the element is in sight, and about, one of its
  /// unknown neighbours. If that is less than `least`, any such length.
  double clear_along(const IncompleteElement& e, const Eigen::Vector3d& direction, double least,
                     double limit, Box3& asked) {
    const auto clear_from = [&](const Point3& p) {
      const double length = sight_.free_length(p, direction, limit);
      asked.extend(p);
      asked.extend(p + length * direction);
      return length;
    };
    const double own = clear_from(e.position);
    // What an element that does not tell its unknown neighbours shows, `reveals` alone decides.
    if (own < least || e.unknown == 0 || options_.unknown_blocks) return own;
    double beside = 0.0;
    e.any_unknown([&](const VoxelIndex& offset) {
      beside =
          std::max(beside, clear_from(e.position + map_->voxel_size() * offset.cast<double>()));
      return beside >= own;
    });
    return std::min(own, beside);
  }

  const VoxelStateMap* map_;
  ViewpointOptions options_;
  ViewFrustum frustum_;
  detail::ViewLines lines_;
  std::vector<double> distances_;
  double min_distance_, min_cosine_;
  LineOfSight sight_;
  std::vector<std::pair<double, std::ptrdiff_t>> order_;  // of lines; kept for its memory
};

/// What a `ViewpointGenerator` finds for each element; a view's `targets` is its element's index.
/// O(elements × tries).
template <ConfigurationPredicate IsFree, ConfigurationPredicate IsReachable = AlwaysTrue,
          ViewPredicate Promises = AlwaysTrue>
ViewpointSet generate_viewpoints(std::span<const IncompleteElement> elements,
                                 const VoxelStateMap& map, const PinholeCamera& camera,
                                 const ViewpointOptions& options, const IsFree& is_free,
                                 const IsReachable& is_reachable = {},
                                 const Promises& promises = {}) {
  ViewpointGenerator generate(map, camera, options);
  ViewpointSet result;
  for (std::size_t i = 0; i < elements.size(); ++i)
    result.add(static_cast<std::int32_t>(i),
               generate(elements[i], is_free, is_reachable, promises));
  return result;
}

/// The same for the elements of an `IncompleteSurface`, whose indices are those of `elements()`.
template <NeighborhoodPolicy U, NeighborhoodPolicy O, NeighborhoodPolicy D,
          ConfigurationPredicate IsFree, ConfigurationPredicate IsReachable = AlwaysTrue>
ViewpointSet generate_viewpoints(const BasicIncompleteSurface<U, O, D>& incomplete,
                                 const VoxelStateMap& map, const PinholeCamera& camera,
                                 const ViewpointOptions& options, const IsFree& is_free,
                                 const IsReachable& is_reachable = {}) {
  const std::vector<IncompleteElement> elements = incomplete.elements();
  return generate_viewpoints(std::span<const IncompleteElement>(elements), map, camera, options,
                             is_free, is_reachable);
}
/// The same where a configuration is free if its own voxel is empty.
template <NeighborhoodPolicy U, NeighborhoodPolicy O, NeighborhoodPolicy D>
ViewpointSet generate_viewpoints(const BasicIncompleteSurface<U, O, D>& incomplete,
                                 const VoxelStateMap& map, const PinholeCamera& camera,
                                 const ViewpointOptions& options = {}) {
  return generate_viewpoints(incomplete, map, camera, options, EmptyBall{&map});
}
/// The same straight from a TSDF map, whose states are taken at the surface's W_th: O(map).
template <NeighborhoodPolicy U, NeighborhoodPolicy O, NeighborhoodPolicy D>
ViewpointSet generate_viewpoints(const BasicIncompleteSurface<U, O, D>& incomplete,
                                 const TsdfMap& map, const PinholeCamera& camera,
                                 const ViewpointOptions& options = {}) {
  const VoxelStateMap states(map, {.known_weight = incomplete.options().known_weight});
  return generate_viewpoints(incomplete, states, camera, options);
}
}  // namespace surfleet
