// SPDX-License-Identifier: MIT
/// @file
/// @brief A Lazy PRM* roadmap that is kept between queries and repaired as the map grows [000
/// §1.4.3, 2.5.3].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/geometry/graph.hpp>
#include <surfleet/motion/cell_sample.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lattice_path.hpp>
#include <surfleet/motion/reachable_set.hpp>
#include <surfleet/motion/shortcut.hpp>

namespace surfleet {
struct LazyPrmOptions {
  double spacing = 2.0;  ///< One sample a cube of this edge [m]; halve it for shorter paths.
  std::uint64_t seed = 1;
  /// How far a query may start from free space, and first fly back to it [m].
  double escape_distance = 2.0;
  ShortcutOptions shortcut{};
};

/// A path from every node of a roadmap to its neighbours; infinite where it is known to be blocked.
struct RoadmapArc {
  std::int32_t to = 0;
  std::uint32_t checked = 0;  ///< Epoch of the last check; 0 if it was never checked.
  double length = 0.0;        ///< [m]
};

/// A roadmap of stratified samples over the free space.
///
/// Every cube of edge `spacing` that has room holds one sample: the first free of a few jittered
/// tries, else its roomiest free voxel, so that narrow places are not missed. Samples closer than
/// the connection radius of PRM* (Karaman and Frazzoli 2011, k = e(1 + 1/d) log n at this density)
/// are neighbours. Edges are checked when a candidate path asks for them (Hauser 2015), and the
/// answer is kept until the free space changes nearby. Where the samples fail although the voxel
/// lattice is connected, the lattice's own path is taken and joins the roadmap: a query finds a
/// path exactly when `reachable` says there is one.
///
/// Repair after a map update is O(changed blocks). The same seed and the same history of updates
/// and queries give the same paths. The free space must outlive the roadmap. Models
/// `WeightedGraph`.
class LazyPrmStar {
 public:
  /// Throws `Error` unless the spacing is positive.
  explicit LazyPrmStar(const FreeSpace& space, LazyPrmOptions options = {})
      : space_(&space),
        options_(options),
        cells_({.voxel_size = options.spacing > 0.0 ? options.spacing : 1.0}),
        reachable_(space) {
    require(
        options.spacing > 0.0 && std::isfinite(options.spacing),
        "roadmap spacing " + std::to_string(options.spacing) + " m: expected a positive length");
    const Box3& bounds = space.options().bounds;
    const double cube = options.spacing * options.spacing * options.spacing;
    const double n = bounds.isEmpty() ? 1e4 : std::clamp(bounds.volume() / cube, 1e2, 1e7);
    const double k = std::numbers::e * (1.0 + 1.0 / 3.0) * std::log(n);
    radius_ = options.spacing * std::cbrt(3.0 * k / (4.0 * kPi));
    update();
  }

  const FreeSpace& space() const { return *space_; }
  const LazyPrmOptions& options() const { return options_; }
  const ReachableSet& reachable_set() const { return reachable_; }
  double connection_radius() const { return radius_; }
  /// Brings roadmap and components up to date; every query does so first.
  void update() {
    reachable_.update();
    const auto changed = space_->changed_since(cursor_);
    if (changed.empty()) return;
    cursor_ = space_->revision();
    ++epoch_;
    // Cells whose sample may have come or gone, and nodes an edge of which may have become free.
    std::vector<VoxelIndex> touched;
    for (const std::uint32_t slot : changed) {
      const Box3 box = space_->influence(slot);
      const VoxelIndex lo = cells_.index_of(box.min()), hi = cells_.index_of(box.max());
      for_each_index(lo, hi, [&](const VoxelIndex& c) {
        Cell& cell = cells_.ensure(c);
        if (cell.stamp == epoch_) return;
        cell.stamp = epoch_;
        touched.push_back(c);
      });
    }
    for (const VoxelIndex& c : touched) repair(c);
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(0.5 * radius_);
    const int rings = static_cast<int>(std::ceil(reach.x() / options_.spacing));
    for (const VoxelIndex& c : touched)
      for_each_index(c - VoxelIndex::Constant(rings), c + VoxelIndex::Constant(rings),
                     [&](const VoxelIndex& n) {
                       if (const Cell* cell = cells_.find(n); cell != nullptr)
                         for (const std::int32_t id : cell->nodes) forget_blocked(id);
                     });
  }

  /// What a robot at one place can reach; holds until the free space changes. Not for concurrent
  /// use.
  class Reach {
   public:
    /// The robot's place; beside what has turned out to be an obstacle, the way out of it.
    const Point3& start() const { return start_; }
    /// Whether a path exists; O(1).
    bool operator()(const Point3& b) const { return gate(b) || is_visible(b); }

   private:
    friend class LazyPrmStar;
    Reach(const ReachableSet& set, const Point3& start, double distance)
        : set_(&set), start_(start), home_(set.component(start)), distance_(distance) {}
    bool is_visible(const Point3& b) const { return set_->space().is_free_segment(start_, b); }
    /// From where the lattice leads to `b`: the start, or what a straight line joins to it.
    std::optional<Point3> gate(const Point3& b) const {
      const auto component = set_->component(b);
      if (!component) return std::nullopt;
      if (component == home_) return start_;
      if (!entrances_) entrances_ = set_->entrances(start_, distance_);
      for (const ReachableSet::Entrance& e : *entrances_)
        if (e.component == *component) return e.position;
      return std::nullopt;
    }
    const ReachableSet* set_;
    Point3 start_;
    std::optional<std::int32_t> home_;
    double distance_;
    mutable std::optional<std::vector<ReachableSet::Entrance>> entrances_;  // when first needed
  };
  /// O(1), and O(voxels within `escape_distance`) when first asked for another component.
  Reach reach_from(const Point3& a) {
    update();
    return {reachable_, space_->free_start(a, options_.escape_distance), options_.escape_distance};
  }

  /// A short free path from `a` to `b`; nothing if there is none. If `a` is not free, the path
  /// starts by leaving for the nearest free place; from a place too narrow for the voxel lattice,
  /// straight for one that is not.
  std::optional<Path> query(const Point3& a, const Point3& b) { return query(a, reach_from(a), b); }

  /// Whether a path exists.
  bool reachable(const Point3& a, const Point3& b) { return reach_from(a)(b); }
  /// The length of a path between two configurations [m], or nothing if there is none: models
  /// `PathDistance`, so that viewpoints can be clustered by a roadmap.
  std::optional<double> operator()(const Configuration& a, const Configuration& b) {
    const auto path = query(a.position, b.position);
    return path ? std::optional(path->length) : std::nullopt;
  }

  /// Path lengths from one place to many, infinite where there is none; one search for all of them.
  /// Exact where there is a line of sight, else along the roadmap, which is a few per cent longer
  /// than the path `query` returns [m].
  std::vector<double> distances(const Point3& from, std::span<const Point3> targets) {
    std::vector<double> result(targets.size(), std::numeric_limits<double>::infinity());
    const Reach reach = reach_from(from);
    const Point3& start = reach.start();
    if (!space_->is_free(start)) return result;
    const double lead = (start - from).norm();
    std::vector<std::size_t> open;
    std::vector<Attachment> gates(targets.size());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (!space_->is_free(targets[i])) continue;
      if (reach.is_visible(targets[i])) {
        result[i] = lead + (targets[i] - start).norm();
      } else if (reach.gate(targets[i]) == start) {
        gates[i] = attach(targets[i]);
        open.push_back(i);
      }
    }
    const Attachment sources = attach(start);
    while (!open.empty() && !sources.empty()) {
      std::vector<std::uint8_t> wanted(nodes_.size(), 0);
      std::size_t left = 0;
      for (const std::size_t i : open)
        for (const auto& [node, d] : gates[i])
          left += std::exchange(wanted[index(node)], 1) == 0 ? 1 : 0;
      const auto tree = shortest_paths(
          *this, std::span<const Source>(sources), NoHeuristic{},
          [&](std::int32_t node, double) { return wanted[index(node)] != 0 && --left == 0; });
      std::vector<std::size_t> still;
      for (const std::size_t i : open) {
        double best = std::numeric_limits<double>::infinity();
        std::int32_t via = -1;
        for (const auto& [node, d] : gates[i])
          if (tree.distance[index(node)] + d < best) {
            best = tree.distance[index(node)] + d;
            via = node;
          }
        if (via < 0) continue;  // the samples do not connect: left to a query
        if (check_path(tree.path(via)))
          result[i] = lead + best;
        else
          still.push_back(i);
      }
      open = std::move(still);
    }
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (!std::isfinite(result[i]) && reach.gate(targets[i]))
        if (const auto path = query(start, reach, targets[i])) result[i] = lead + path->length;
    return result;
  }

  // -- as a graph --------------------------------------------------------------------------------
  std::size_t size() const { return nodes_.size(); }
  std::span<const RoadmapArc> arcs(std::int32_t node) const { return nodes_[index(node)].arcs; }
  const Point3& position(std::int32_t node) const { return nodes_[index(node)].position; }
  /// Whether a node is in use; others have no arcs.
  bool alive(std::int32_t node) const { return nodes_[index(node)].alive; }
  /// Edge checks so far.
  std::uint64_t checks() const { return checks_; }

 private:
  struct Node {
    Point3 position;
    VoxelIndex cell;
    bool alive = false;
    bool learned = false;  // from a lattice path, not a cell's own sample
    std::vector<RoadmapArc> arcs;
  };
  struct Cell {
    std::uint32_t stamp = 0;
    std::vector<std::int32_t> nodes;
  };
  using Attachment = std::vector<Source>;
  static constexpr double kBlocked = std::numeric_limits<double>::infinity();

  /// `reach` is that from `a`, of now.
  std::optional<Path> query(const Point3& a, const Reach& reach, const Point3& b) {
    if (!space_->is_free(b)) return std::nullopt;
    const auto visible = [this](const Point3& p, const Point3& q) {
      return space_->is_free_segment(p, q);
    };
    const Point3& start = reach.start();
    Path path;
    if (visible(start, b)) {
      path = Path({start, b});
    } else {
      const auto gate = reach.gate(b);
      if (!gate) return std::nullopt;
      auto rough = search(*gate, b);
      const bool sampled = !rough.empty();
      if (!sampled) rough = lattice_path(reachable_, *gate, b);
      if (rough.empty()) return std::nullopt;
      if (*gate != start) rough.insert(rough.begin(), start);
      path = shortcut(std::move(rough), visible, options_.shortcut);
      if (!sampled) learn(path.points);
    }
    if (start == a) return path;
    path.points.insert(path.points.begin(), a);
    return Path(std::move(path.points));
  }

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  template <typename Fn>
  void for_each_near(const Point3& p, double radius, Fn&& fn) const {
    const Eigen::Vector3d r = Eigen::Vector3d::Constant(radius);
    for_each_index(cells_.index_of(p - r), cells_.index_of(p + r), [&](const VoxelIndex& c) {
      const Cell* cell = cells_.find(c);
      if (cell == nullptr) return;
      for (const std::int32_t id : cell->nodes) {
        const double d = (nodes_[index(id)].position - p).norm();
        if (d <= radius) fn(id, d);
      }
    });
  }

  // -- samples -----------------------------------------------------------------------------------
  void repair(const VoxelIndex& c) {
    Cell& cell = cells_.ensure(c);
    bool sampled = false;
    for (std::size_t i = 0; i < cell.nodes.size();) {
      const std::int32_t id = cell.nodes[i];
      if (space_->is_free(nodes_[index(id)].position)) {
        sampled = sampled || !nodes_[index(id)].learned;
        ++i;
      } else {
        disconnect(id);
        cell.nodes.erase(cell.nodes.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    if (sampled) return;
    if (const auto p = cell_sample(*space_, c, options_.spacing, options_.seed)) add(*p, false);
  }
  std::int32_t add(const Point3& p, bool learned) {
    std::int32_t id;
    if (!unused_.empty()) {
      id = unused_.back();
      unused_.pop_back();
    } else {
      id = static_cast<std::int32_t>(nodes_.size());
      nodes_.emplace_back();
    }
    Node& node = nodes_[index(id)];
    node.position = p;
    node.cell = cells_.index_of(p);
    node.alive = true;
    node.learned = learned;
    for_each_near(p, radius_, [&](std::int32_t other, double d) {
      node.arcs.push_back({other, 0, d});
      nodes_[index(other)].arcs.push_back({id, 0, d});
    });
    cells_.ensure(node.cell).nodes.push_back(id);
    return id;
  }
  void disconnect(std::int32_t id) {
    Node& node = nodes_[index(id)];
    for (const RoadmapArc& arc : node.arcs)
      std::erase_if(nodes_[index(arc.to)].arcs, [id](const auto& a) { return a.to == id; });
    node.arcs.clear();
    node.alive = false;
    unused_.push_back(id);
  }
  void forget_blocked(std::int32_t id) {
    Node& node = nodes_[index(id)];
    if (std::exchange(node_stamp(id), epoch_) == epoch_) return;
    for (RoadmapArc& arc : node.arcs)
      if (arc.length == kBlocked) {
        const double d = (nodes_[index(arc.to)].position - node.position).norm();
        set(id, arc.to, {arc.to, 0, d});
      }
  }
  std::uint32_t& node_stamp(std::int32_t id) {
    if (node_stamps_.size() < nodes_.size()) node_stamps_.resize(nodes_.size(), 0);
    return node_stamps_[index(id)];
  }

  // -- edges -------------------------------------------------------------------------------------
  RoadmapArc& arc(std::int32_t from, std::int32_t to) {
    auto& list = nodes_[index(from)].arcs;
    return *std::find_if(list.begin(), list.end(), [to](const auto& a) { return a.to == to; });
  }
  void set(std::int32_t a, std::int32_t b, const RoadmapArc& state) {
    arc(a, b) = {b, state.checked, state.length};
    arc(b, a) = {a, state.checked, state.length};
  }
  /// Checks an edge unless that was done since the last change of the map.
  bool check(std::int32_t a, std::int32_t b) {
    RoadmapArc& e = arc(a, b);
    if (e.checked == epoch_ || e.length == kBlocked) return e.length < kBlocked;
    ++checks_;
    const bool free = space_->is_free_segment(nodes_[index(a)].position, nodes_[index(b)].position);
    set(a, b, {b, epoch_, free ? e.length : kBlocked});
    return free;
  }
  /// Checks all edges of a path. Where one is blocked, everything else at its ends is checked too,
  /// since the next candidate will try those.
  bool check_path(const std::vector<std::int32_t>& path) {
    bool free = true;
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (check(path[i - 1], path[i])) continue;
      free = false;
      for (const std::int32_t end : {path[i - 1], path[i]})
        for (const RoadmapArc& e : nodes_[index(end)].arcs) check(end, e.to);
    }
    return free;
  }

  // -- search ------------------------------------------------------------------------------------
  /// The nodes that `p` sees within the connection radius, or twice that if there are none.
  Attachment attach(const Point3& p) const {
    Attachment seen;
    for (const double r : {radius_, 2.0 * radius_}) {
      for_each_near(p, r, [&](std::int32_t id, double d) {
        if (space_->is_free_segment(p, nodes_[index(id)].position)) seen.emplace_back(id, d);
      });
      if (!seen.empty()) break;
    }
    return seen;
  }
  std::vector<Point3> search(const Point3& a, const Point3& b) {
    const Attachment sources = attach(a), gates = attach(b);
    if (sources.empty() || gates.empty()) return {};
    std::vector<double> exit(nodes_.size(), kBlocked);
    for (const auto& [node, d] : gates) exit[index(node)] = d;
    const auto to_goal = [&](std::int32_t node) {
      return (nodes_[index(node)].position - b).norm();
    };
    for (;;) {
      double best = kBlocked;
      std::int32_t via = -1;
      const auto tree = shortest_paths(*this, std::span<const Source>(sources), to_goal,
                                       [&](std::int32_t node, double d) {
                                         if (d + to_goal(node) >= best) return true;
                                         if (d + exit[index(node)] < best) {
                                           best = d + exit[index(node)];
                                           via = node;
                                         }
                                         return false;
                                       });
      if (via < 0) return {};
      const auto path = tree.path(via);
      if (!check_path(path)) continue;
      std::vector<Point3> points{a};
      for (const std::int32_t id : path) points.push_back(nodes_[index(id)].position);
      points.push_back(b);
      return points;
    }
  }

  /// Puts a path's vertices, and points between them where they are far apart, into the roadmap.
  void learn(const std::vector<Point3>& points) {
    const auto put = [&](const Point3& p) {
      bool known = !space_->is_free(p);
      for_each_near(p, 1e-6, [&](std::int32_t, double) { known = true; });
      if (!known) add(p, true);
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
      put(points[i]);
      if (i + 1 == points.size()) break;
      const Eigen::Vector3d leg = points[i + 1] - points[i];
      const int parts = static_cast<int>(std::ceil(leg.norm() / (0.9 * radius_)));
      for (int k = 1; k < parts; ++k) put(points[i] + leg * (static_cast<double>(k) / parts));
    }
  }

  const FreeSpace* space_;
  LazyPrmOptions options_;
  VoxelGrid<Cell, 8> cells_;
  ReachableSet reachable_;
  double radius_ = 0.0;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> unused_;
  std::vector<std::uint32_t> node_stamps_;
  std::uint32_t epoch_ = 0;
  std::uint64_t cursor_ = 0;
  std::uint64_t checks_ = 0;
};
static_assert(WeightedGraph<LazyPrmStar>);
}  // namespace surfleet
