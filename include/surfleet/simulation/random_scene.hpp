// SPDX-License-Identifier: MIT
/// @file
/// @brief Generated scenes without end: kinds by name, a structure for every seed.
///
/// @code
/// Scene scene = random_scene(parse_random_scene("random:shell:7"));
/// const RandomSceneSpec& spec = random_scene_spec("shell");   // .preset: voxel, range, body
/// @endcode
///
/// Each seed is another structure of sensible size with overhangs, gaps, thin sheets and members,
/// and pieces that stand free; every fifth has the dirty topology of real files. Seeds 1 to 99 are
/// for development, 1000 and up for reported figures only.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/simulation/detail/random_bridge.hpp>
#include <surfleet/simulation/detail/random_dirt.hpp>
#include <surfleet/simulation/detail/random_hall.hpp>
#include <surfleet/simulation/detail/random_hull.hpp>
#include <surfleet/simulation/detail/random_lattice.hpp>
#include <surfleet/simulation/detail/random_plant.hpp>
#include <surfleet/simulation/detail/random_shell.hpp>
#include <surfleet/simulation/detail/random_tower.hpp>
#include <surfleet/simulation/presets.hpp>
#include <surfleet/simulation/scene.hpp>

namespace surfleet {
/// A kind of scenes, and what a mission there flies with unless its user says otherwise.
struct RandomSceneSpec {
  std::string_view kind;
  MissionPreset preset{};

  /// Free space around a start after which a camera that opens 60° upright has seen the exit from
  /// there: where the image is as high as what the body needs, and what voxels blur.
  double start_clearance() const {
    return (preset.radius + preset.margin + preset.voxel) / std::sin(radians(30.0)) +
           1.5 * preset.voxel;
  }
  /// Between robots at their starting places.
  double spacing() const { return starting_distance(preset.radius, preset.margin); }
};

/// The kinds; seed N of `random:all` is kind N mod 7 in this order.
inline constexpr std::array<RandomSceneSpec, 7> kRandomSceneKinds{{
    {.kind = "plant"},
    {.kind = "tower"},
    {.kind = "lattice",
     .preset = {.voxel = 0.15,
                .margin = 0.4,
                .unknown_margin = 0.15,
                .nearest = 1.0,
                .farthest = 5.0,
                .standoff = 3.6}},
    {.kind = "shell"},
    {.kind = "bridge"},
    {.kind = "hall",  // indoors, for a small robot
     .preset = {.voxel = 0.15,
                .radius = 0.35,
                .margin = 0.2,
                .unknown_margin = 0.15,
                .nearest = 0.6,
                .farthest = 5.0,
                .standoff = 2.5}},
    {.kind = "hull"},
}};

/// The kind of this name; nothing if there is none.
inline const RandomSceneSpec* find_random_scene_spec(std::string_view kind) {
  const auto* it = std::find_if(kRandomSceneKinds.begin(), kRandomSceneKinds.end(),
                                [&](const RandomSceneSpec& s) { return s.kind == kind; });
  return it == kRandomSceneKinds.end() ? nullptr : it;
}
/// "plant, tower, …"
inline std::string random_scene_kinds() {
  std::string list;
  for (const RandomSceneSpec& s : kRandomSceneKinds)
    list += (list.empty() ? "" : ", ") + std::string(s.kind);
  return list;
}
/// Throws `Error` for a name that no kind has.
inline const RandomSceneSpec& random_scene_spec(std::string_view kind) {
  const RandomSceneSpec* spec = find_random_scene_spec(kind);
  if (spec == nullptr)
    throw Error("random scene '" + std::string(kind) + "': no such kind; expected " +
                random_scene_kinds() + " or all");
  return *spec;
}

/// One of the scenes: a kind, never `all`, and a seed.
struct RandomSceneId {
  std::string_view kind;  ///< Of `kRandomSceneKinds`.
  std::uint64_t seed = 1;

  std::string name() const { return "random:" + std::string(kind) + ":" + std::to_string(seed); }
  bool operator==(const RandomSceneId&) const = default;
};

/// Whether `name` claims to be one, well formed or not.
inline bool is_random_scene(std::string_view name) {
  return name == "random" || name.starts_with("random:");
}

/// Seeds are whole numbers up to this.
inline constexpr std::uint64_t kLastRandomSeed = 999'999'999;

/// Every scene of `random:KIND:SEEDS`, SEEDS one seed or a range `first-last` of at most 1000.
/// Throws `Error` on anything else.
inline std::vector<RandomSceneId> parse_random_scenes(std::string_view name) {
  const auto refuse = [&](const std::string& expected) {
    throw Error("scene '" + std::string(name) + "': expected " + expected);
  };
  const std::size_t mark = name.find(':', 7);
  if (!is_random_scene(name) || mark == std::string_view::npos)
    refuse("random:KIND:SEED with KIND " + random_scene_kinds() + " or all");
  const std::string_view kind = name.substr(7, mark - 7), seeds = name.substr(mark + 1);
  if (kind != "all") random_scene_spec(kind);
  const auto number = [&](std::string_view digits) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value > kLastRandomSeed)
      refuse("a seed of 0 to " + std::to_string(kLastRandomSeed) + " or a range as in 1-5");
    return value;
  };
  const std::size_t dash = seeds.find('-');
  const std::uint64_t first = number(seeds.substr(0, dash));
  const std::uint64_t last =
      dash == std::string_view::npos ? first : number(seeds.substr(dash + 1));
  if (last < first || last - first >= 1000) refuse("a range of 1 to 1000 seeds as in 1-5");
  std::vector<RandomSceneId> scenes;
  for (std::uint64_t seed = first; seed <= last; ++seed)
    scenes.push_back({kind == "all" ? kRandomSceneKinds[seed % kRandomSceneKinds.size()].kind
                                    : random_scene_spec(kind).kind,
                      seed});
  return scenes;
}
/// The scene of `random:KIND:SEED`, `random:all:SEED` resolved. Throws `Error` on anything else.
inline RandomSceneId parse_random_scene(std::string_view name) {
  const std::vector<RandomSceneId> scenes = parse_random_scenes(name);
  require(scenes.size() == 1, "scene '" + std::string(name) + "': expected one seed");
  return scenes.front();
}

/// What a seed may be used for: "development", "reported", or "unassigned" (0, 100 to 999).
inline std::string_view random_seed_use(std::uint64_t seed) {
  if (seed >= 1000) return "reported";
  return seed >= 1 && seed <= 99 ? "development" : "unassigned";
}
/// Whether the structure of this seed has dirty topology.
inline bool random_seed_is_dirty(std::uint64_t seed) { return seed % 5 == 0; }

namespace detail::random_scene {
inline Structure make_structure(const RandomSceneId& id) {
  using Maker = Structure (*)(const Draw&, std::uint64_t);
  constexpr std::array<Maker, kRandomSceneKinds.size()> kMakers{
      make_plant, make_tower, make_lattice, make_shell, make_bridge, make_hall, make_hull};
  const auto kind =
      static_cast<std::size_t>(&random_scene_spec(id.kind) - kRandomSceneKinds.data());
  const Draw draw = Draw(Random(id.seed))(id.kind);
  Structure made = kMakers[kind](draw, id.seed);
  if (random_seed_is_dirty(id.seed)) make_dirty(made.mesh, draw("dirt"), made.indoors ? -1.0 : 0.0);
  return made;
}

/// A place from which five robots, one on each side of the first, have the start clearance of the
/// kind: beside the structure, or where it is widest in the room around the origin.
inline std::optional<Point3> find_start(const Structure& made, const RandomSceneSpec& spec,
                                        Draw draw) {
  const Bvh surface(made.mesh);
  const double spacing = spec.spacing(), needed = spec.start_clearance();
  const auto clearance = [&](const Point3& p) {
    double least = surface.distance(p);
    for (const Point3& step :
         {Point3(1, 0, 0), Point3(-1, 0, 0), Point3(0, 1, 0), Point3(0, -1, 0)})
      if (least >= needed) least = std::min(least, surface.distance(p + spacing * step));
    return least;
  };
  const Box3 box = made.mesh.bounds();
  if (made.indoors) {
    std::optional<Point3> best;
    double widest = needed;
    for (double z = box.min().z() + needed; z + needed < box.max().z() + 0.1; z += 0.1)
      for (double y = -1.0; y <= 1.0; y += 0.25)
        for (double x = -1.0; x <= 1.0; x += 0.25)
          if (const double own = clearance({x, y, z}); own > widest) {
            best = Point3(x, y, z);
            widest = own;
          }
    return best;
  }
  const int side = draw.whole(0, 15);
  const Eigen::Vector2d half = 0.5 * box.sizes().head<2>();
  for (double away = needed; away < needed + spacing + 0.2; away += 0.4)
    for (int k = 0; k < 16; ++k) {
      const double angle = kPi * ((side + 5 * k) % 16) / 8.0;
      const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
      const double to_side = 1.0 / std::max(std::abs(d.x()) / half.x(), std::abs(d.y()) / half.y());
      const Eigen::Vector2d p = box.center().head<2>() + (to_side + away) * d;
      const Point3 start(p.x(), p.y(), spec.preset.radius + spec.preset.margin + 0.85);
      if (clearance(start) >= needed) return start;
    }
  return std::nullopt;
}
}  // namespace detail::random_scene

/// The structure of a random scene, without ground: outdoors it stands on z = 0. A pure function;
/// the same with every compiler up to the rounding of sines and powers. Throws `Error` on a kind
/// that there is not.
inline TriangleMesh random_mesh(const RandomSceneId& id) {
  return detail::random_scene::make_structure(id).mesh;
}

/// A random scene: outdoors with ground, indoors with the robots inside, with a start that has
/// room for five. O(n log n) in the triangles. Throws `Error` on a kind that there is not.
inline Scene random_scene(const RandomSceneId& id) {
  namespace make = detail::random_scene;
  const RandomSceneSpec& spec = random_scene_spec(id.kind);
  const make::Structure made = make::make_structure(id);
  SceneOptions options;
  options.name = id.name();
  options.radius = spec.preset.radius;
  options.margin = spec.preset.margin;
  options.start = make::find_start(made, spec, make::Draw(Random(id.seed))("start"));
  require(options.start.has_value(), options.name + ": no room for five robots to start");
  if (made.indoors) {
    constexpr double kBeyond = 0.5;  // of the walls [m]
    const Box3 box = made.mesh.bounds();
    options.bounds =
        Box3(box.min() - Point3::Constant(kBeyond), box.max() + Point3::Constant(kBeyond));
  } else {
    options.ground = 0.0;
    options.standoff =
        std::max(spec.preset.farthest, spec.start_clearance() + 2.0 * spec.spacing() + 0.2);
  }
  return scene_from_mesh(made.mesh, options);
}
}  // namespace surfleet
