// SPDX-License-Identifier: MIT
/// @file
/// @brief What a mission takes place in: a true mesh, the part to reconstruct, the space to fly in.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// A world frame with a structure in it. Metres.
struct Scene {
  std::string name;
  TriangleMesh mesh;                    ///< The structure, then the ground if there is one.
  std::size_t structure_triangles = 0;  ///< The first triangles of the mesh: all but the ground.
  Box3 region;       ///< What must be reconstructed; a slab above the ground is left out.
  Box3 bounds;       ///< Where robots may be.
  KeepOut keep_out;  ///< Where in there they may not.
  bool has_ground = false;
  double ground_z = 0.0;  ///< Height of the ground, if there is one.
  Configuration station;  ///< The first starting place; further robots start around it.

  /// The structure alone, without the ground.
  TriangleMesh structure() const {
    TriangleMesh part = mesh;
    part.triangles.resize(structure_triangles);
    // Wider than the mesh: the rounded middle of a triangle on its border may lie beyond.
    const Box3 box = part.bounds();
    return cropped(part, Box3(box.min() - Point3::Ones(), box.max() + Point3::Ones()));
  }
};

/// What is free and what is solid in a scene, by its true mesh: closed parts that are oriented
/// outward are solid, parts oriented inward are rooms, open parts are sheets. Build O(n log n).
class SceneSpace {
 public:
  explicit SceneSpace(const TriangleMesh& mesh)
      : surface_(mesh), closed_(closed_parts(weld_vertices(mesh))), closed_surface_(closed_) {}

  const Bvh& surface() const { return surface_; }
  /// Distance to the mesh [m].
  double clearance(const Point3& p) const { return surface_.distance(p); }
  bool is_solid(const Point3& p) const { return winding_number(closed_surface_, closed_, p) > 0; }
  /// True within a closed part whose triangles face inward.
  bool is_room(const Point3& p) const { return winding_number(closed_surface_, closed_, p) < 0; }
  /// True if a ball of `radius` [m] about `p` holds nothing of the scene.
  bool is_free(const Point3& p, double radius) const {
    return !surface_.closest_point(p, radius) && !is_solid(p);
  }
  /// True if the segment meets no triangle.
  bool is_visible(const Point3& a, const Point3& b) const {
    return a == b || is_clear_segment(surface_, a, b);
  }

 private:
  Bvh surface_;
  TriangleMesh closed_;
  Bvh closed_surface_;
};

/// How far apart robots of this body start [m]: 2.8 m, small ones nearer.
constexpr double starting_distance(double radius, double margin) {
  return std::min(2.8, 2.0 * (radius + margin) + 0.1);
}

struct StartOptions {
  double radius = 1.0;   ///< Of a robot's body [m].
  double margin = 0.3;   ///< Free distance beyond the body [m].
  double spacing = 2.8;  ///< Between neighbouring robots [m].
  /// Free of the structure around every robot, whatever the ground; at least radius + margin [m].
  double clearance = 0.0;
};

namespace detail {
inline std::string text(const Point3& p) {
  std::string s = "(";
  for (int k = 0; k < 3; ++k) {
    std::string number = std::to_string(p[k]);
    number.resize(number.find('.') + 3);
    s += number + (k < 2 ? ", " : ")");
  }
  return s;
}
/// In centimetres, rounded down: what is said to do must do.
inline std::string text_down(double metres) {
  std::string number = std::to_string(std::floor(100.0 * metres + 1e-6) / 100.0);
  number.resize(number.find('.') + 3);
  return number;
}
}  // namespace detail

/// `count` starting places around the scene's station, the station first, `spacing` apart at one
/// height, free by radius + margin, with the clearance asked for to the `structure`, out of what is
/// closed and in sight of the station, headed for the region's centre [000 §3.6.1]. Throws `Error`
/// if there is no room for so many, saying the clearance that there is room for.
inline std::vector<Configuration> starting_places(const Scene& scene, const SceneSpace& space,
                                                  const Bvh& structure, int count,
                                                  const StartOptions& options = {}) {
  require(count >= 1 && count <= 1000, std::to_string(count) + " robots: expected 1 to 1000");
  require(options.radius > 0.0 && options.margin >= 0.0 && options.spacing > 0.0 &&
              options.clearance >= 0.0,
          "starting places: expected a positive radius and spacing");
  struct Candidate {
    double distance2;
    int i, j;
  };
  const Point3& station = scene.station.position;
  const Eigen::Vector3d reach = scene.bounds.sizes() / options.spacing;
  const auto limit = static_cast<int>(std::min(200.0, std::max(reach.x(), reach.y()) + 1.0));
  std::vector<Candidate> candidates;
  for (int j = -limit; j <= limit; ++j)
    for (int i = -limit; i <= limit; ++i)
      candidates.push_back({static_cast<double>(i * i + j * j), i, j});
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.distance2 < b.distance2; });
  std::vector<Configuration> places;
  std::vector<double> too_near;  // clearances of those that lack nothing else
  for (const Candidate& c : candidates) {
    if (static_cast<int>(places.size()) == count) break;
    const Point3 p = station + options.spacing * Point3(c.i, c.j, 0);
    if (!scene.bounds.contains(p) || !space.is_free(p, options.radius + options.margin) ||
        scene.keep_out.distance(p) < options.radius || !space.is_visible(station, p))
      continue;
    if (const auto near = structure.closest_point(p, options.clearance);
        near && near->distance < options.clearance) {
      require(c.distance2 > 0.0, "start clearance " + detail::text_down(options.clearance) +
                                     ": the start " + detail::text(p) + " has " +
                                     detail::text_down(near->distance) +
                                     " m around it; expected at most " +
                                     detail::text_down(near->distance) + " or another start");
      too_near.push_back(near->distance);
      continue;
    }
    const Eigen::Vector3d ahead = scene.region.center() - p;
    places.push_back(
        {p, ahead.head<2>().norm() > 1e-9 ? std::atan2(ahead.y(), ahead.x()) : scene.station.yaw});
  }
  const auto missing = static_cast<std::size_t>(count) - places.size();
  if (missing > 0 && missing <= too_near.size()) {
    std::sort(too_near.begin(), too_near.end(), std::greater<>());
    throw Error("start clearance " + detail::text_down(options.clearance) + ": room for " +
                std::to_string(places.size()) + " of " + std::to_string(count) +
                " robots around the start " + detail::text(station) + "; expected at most " +
                detail::text_down(too_near[missing - 1]) + ", fewer robots or another start");
  }
  require(missing == 0, scene.name + ": room for " + std::to_string(places.size()) + " of " +
                            std::to_string(count) +
                            " robots around the start; expected fewer robots, a smaller radius or "
                            "another start");
  return places;
}
inline std::vector<Configuration> starting_places(const Scene& scene, const SceneSpace& space,
                                                  int count, const StartOptions& options = {}) {
  return starting_places(scene, space, Bvh(scene.structure()), count, options);
}
inline std::vector<Configuration> starting_places(const Scene& scene, int count,
                                                  const StartOptions& options = {}) {
  return starting_places(scene, SceneSpace(scene.mesh), count, options);
}

/// How a mesh becomes a scene; what is left out is found from the mesh.
struct SceneOptions {
  std::string name = "scene";
  std::optional<Box3> bounds{};    ///< Flight space; else the mesh's box and `standoff` around it.
  std::optional<Point3> start{};   ///< Station; else a free place beside the structure.
  std::optional<double> ground{};  ///< Height of a ground plane to add; else there is none.
  double standoff = 8.0;           ///< Room around the structure [m].
  double ground_slab = 0.5;        ///< Height above the ground that is not to be reconstructed [m].
  double region_margin = 0.6;      ///< Of the region around the structure [m].
  double radius = 1.0;             ///< Of a robot's body [m].
  double margin = 0.3;             ///< Free distance beyond it at the start [m].
  /// What the station should have of the structure around it, whatever the ground [m]. A place that
  /// has is sought; if there is none, the one with the most is taken.
  double start_clearance = 0.0;
  /// Height that no robot's body comes below; −∞: no such. If not given, the structure's base,
  /// where no ground and no bounds are given and the station is above it and in no room.
  std::optional<double> floor{};
  KeepOut keep_out{};  ///< Closed to robots.
  /// How far a robot's body reaches below its centre; its radius if not given [m].
  std::optional<double> depth{};
};

namespace detail {
/// A free place for the station: within a room if the scene has any, else in front of a side of
/// the structure, else anywhere in the bounds; `wanted` metres from the structure if there is such
/// a place, else as far as may be.
inline std::optional<Point3> find_station(const Scene& scene, const SceneSpace& space,
                                          const Bvh& surface, const SceneOptions& options) {
  const Box3 structure = surface.bounds();
  const double floor = scene.has_ground ? scene.ground_z : structure.min().z();
  const double clearance = options.radius + options.margin, wanted = options.start_clearance;
  const Point3 c = structure.center();
  const Eigen::Vector3d half = 0.5 * structure.sizes();
  const auto good = [&](const Point3& p) {
    return scene.bounds.contains(p) && space.is_free(p, clearance) &&
           scene.keep_out.distance(p) >= options.radius;
  };
  constexpr int kSteps = 12;
  const auto lattice = [&](const Box3& box, int i, int j, int k) {
    return Point3(box.min() + box.sizes().cwiseProduct(Point3(i + 0.5, j + 0.5, k + 0.5)) / kSteps);
  };
  std::optional<Point3> best;
  double best_clearance = 0.0;
  for (int k = 0; k < kSteps; ++k)
    for (int j = 0; j < kSteps; ++j)
      for (int i = 0; i < kSteps; ++i) {
        const Point3 p = lattice(structure, i, j, k);
        if (!good(p) || !space.is_room(p)) continue;
        const double own = space.clearance(p);
        if (own > best_clearance + 1e-9) {
          best = p;
          best_clearance = own;
        }
      }
  if (best) return best;
  // True for a place that has all that is wanted; the best of the others is kept.
  const auto enough = [&](const Point3& p) {
    if (!good(p)) return false;
    const double own = surface.distance(p);
    if (!best || own > best_clearance + 1e-9) {
      best = p;
      best_clearance = own;
    }
    return own >= wanted;
  };
  // The structure may have a ground of its own, whose clearance takes more height.
  for (const double height : {clearance + 0.7, std::max(clearance, wanted) + 0.7})
    for (const double away : {3.5, 5.0, 2.0, 7.0})
      for (const double angle : {-0.5, 0.0, 0.5, 1.0, -0.25, 0.25, 0.75, -0.75}) {
        const Eigen::Vector3d d(std::cos(angle * kPi), std::sin(angle * kPi), 0.0);
        const double to_side = 1.0 / std::max(std::abs(d.x()) / std::max(half.x(), 1e-9),
                                              std::abs(d.y()) / std::max(half.y(), 1e-9));
        Point3 p = c + (to_side + away) * d;
        p.z() = floor + height;
        if (enough(p)) return p;
      }
  for (int k = 0; k < kSteps; ++k)
    for (int j = 0; j < kSteps; ++j)
      for (int i = 0; i < kSteps; ++i)
        if (const Point3 p = lattice(scene.bounds, i, j, k); enough(p)) return p;
  return best;
}
}  // namespace detail

/// Keeps robots above a floor: lifts the flight space, and nothing else, to `depth` above it, how
/// far a body reaches below its centre. Throws `Error` if the station is lower or nothing is left.
inline void set_floor(Scene& scene, double floor, double depth) {
  const double least = floor + depth;
  require(!(floor > scene.bounds.max().z() - depth) && !std::isnan(floor),
          "floor " + std::to_string(floor) + ": above the flight space; expected a height below " +
              std::to_string(scene.bounds.max().z() - depth));
  require(scene.station.position.z() >= least,
          "floor " + std::to_string(floor) + ": the start " + detail::text(scene.station.position) +
              " is lower than the body's radius above it; expected a floor of at most " +
              std::to_string(scene.station.position.z() - depth) + " or another start");
  scene.bounds.min().z() = std::max(scene.bounds.min().z(), least);
}

/// Makes a scene of any mesh: soups, open and non-manifold ones too.
///
/// Throws `Error` on a mesh without triangles or size, on bounds that miss it, and on a start that
/// is out of bounds, inside a closed part or a closed box, or nearer than the body's radius to a
/// triangle. Whether the station has `start_clearance` is for `starting_places` to say.
inline Scene scene_from_mesh(TriangleMesh mesh, const SceneOptions& options = {}) {
  require(!mesh.triangles.empty(), options.name + ": no triangles; expected a mesh with faces");
  require(options.standoff > 0.0 && options.radius > 0.0 && options.margin >= 0.0 &&
              options.ground_slab >= 0.0 && options.region_margin >= 0.0 &&
              options.start_clearance >= 0.0,
          "scene: expected positive lengths");
  Box3 structure;
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) structure.extend(mesh.vertices[static_cast<std::size_t>(v)]);
  require(structure.sizes().maxCoeff() > 0.0 && structure.sizes().maxCoeff() < 1e5,
          options.name + ": expected a structure of less than 100 km, in metres");
  Scene scene;
  scene.name = options.name;
  scene.structure_triangles = mesh.triangles.size();
  scene.has_ground = options.ground.has_value();
  scene.ground_z = options.ground.value_or(structure.min().z());
  require(
      std::isfinite(scene.ground_z) && (!scene.has_ground || scene.ground_z < structure.max().z()),
      options.name + ": the ground must lie below the top of the structure");
  if (options.bounds) {
    scene.bounds = *options.bounds;
    require(scene.bounds.min().allFinite() && scene.bounds.max().allFinite() &&
                (scene.bounds.sizes().array() > 0.0).all() && scene.bounds.intersects(structure),
            options.name + ": expected bounds with a volume that meet the structure, which spans " +
                detail::text(structure.min()) + " to " + detail::text(structure.max()));
  } else {
    scene.bounds = Box3(structure.min() - Point3::Constant(options.standoff),
                        structure.max() + Point3::Constant(options.standoff));
    if (scene.has_ground) scene.bounds.min().z() = scene.ground_z;
  }
  scene.region = Box3(structure.min() - Point3::Constant(options.region_margin),
                      structure.max() + Point3::Constant(options.region_margin))
                     .intersection(scene.bounds);
  if (scene.has_ground)
    scene.region.min().z() = std::max(scene.region.min().z(), scene.ground_z + options.ground_slab);
  scene.keep_out = options.keep_out;
  scene.mesh = std::move(mesh);
  if (scene.has_ground) {
    Box3 far = scene.bounds.merged(structure);
    const Point2 apron = Point2::Constant(20.0);
    append(scene.mesh, make_plane(Box2(far.min().head<2>() - apron, far.max().head<2>() + apron),
                                  scene.ground_z));
  }
  const SceneSpace space(scene.mesh);
  const double base = structure.min().z(), depth = options.depth.value_or(options.radius);
  const Box3 whole = scene.bounds;
  const bool floor_at_base = !options.floor && !scene.has_ground && !options.bounds;
  if (options.start) {
    const Point3& p = *options.start;
    require(p.allFinite() && scene.bounds.contains(p),
            "start " + detail::text(p) + " is out of bounds; expected a place between " +
                detail::text(scene.bounds.min()) + " and " + detail::text(scene.bounds.max()));
    const double clearance = space.clearance(p);
    require(!space.is_solid(p),
            "start " + detail::text(p) + " is inside an obstacle; expected a free place");
    require(clearance >= options.radius,
            "start " + detail::text(p) + " is " + std::to_string(clearance) +
                " m from an obstacle; expected at least " + std::to_string(options.radius) + " m");
    require(scene.keep_out.distance(p) >= options.radius,
            "start " + detail::text(p) + " is in or beside a keep-out box; expected a place " +
                std::to_string(options.radius) + " m from it");
    scene.station.position = p;
  } else {
    // A station is found above the floor that there will be.
    if (floor_at_base || options.floor)
      scene.bounds.min().z() =
          std::max(scene.bounds.min().z(), options.floor.value_or(base) + depth);
    const auto found =
        scene.bounds.isEmpty()
            ? std::nullopt
            : detail::find_station(scene, space,
                                   scene.has_ground ? Bvh(scene.structure()) : space.surface(),
                                   options);
    scene.bounds = whole;
    require(found.has_value(), options.name + ": no free starting place found; expected a start");
    scene.station.position = *found;
  }
  if (options.floor) {
    set_floor(scene, *options.floor, depth);
  } else if (const Point3& p = scene.station.position;
             floor_at_base && p.z() > base && !space.is_room(p)) {
    set_floor(scene, std::min(base, p.z() - depth), depth);
  }
  const Eigen::Vector3d ahead = scene.region.center() - scene.station.position;
  if (ahead.head<2>().norm() > 1e-9) scene.station.yaw = std::atan2(ahead.y(), ahead.x());
  return scene;
}
}  // namespace surfleet
