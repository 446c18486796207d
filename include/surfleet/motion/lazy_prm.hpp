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
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/assert.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/motion/cell_sample.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lattice_path.hpp>
#include <surfleet/motion/reachable_set.hpp>
#include <surfleet/motion/shortcut.hpp>

namespace surfleet {
struct LazyPrmOptions {
  double spacing = 2.0;  ///< One sample a cube of this edge at first [m].
  /// What a cube that obstacles reach into has with time.
  std::size_t samples = 4;
  std::size_t growth = 16;  ///< Samples that an update adds at most.
  std::uint64_t seed = 1;
  /// How far a query may start from free space, and first fly back to it [m].
  double escape_distance = 2.0;
  ShortcutOptions shortcut{};
};

/// A path from every node of a roadmap to its neighbours.
struct RoadmapArc {
  std::int32_t to = 0;
  mutable std::uint32_t checked = 0;  ///< Epoch of the last check; 0 if it was never checked.
  mutable double length = 0.0;        ///< Infinite where it is known to be blocked [m].
};

/// A roadmap of stratified samples over the free space, which becomes denser with time.
///
/// Every cube of edge `spacing` that has room holds one sample: the first free of a few jittered
/// tries, else its roomiest free voxel, so that narrow places are not missed. Cubes that obstacles
/// reach into are given more, some with every change, so that paths get shorter. Samples closer
/// than the connection radius of PRM* (Karaman and Frazzoli 2011, k = e(1 + 1/d) log n) at the
/// density of where they are put are neighbours. Edges are checked when a candidate path asks for
/// them (Hauser 2015), and the answer is kept until the free space changes nearby. Where the
/// samples fail although the voxel lattice is connected, the lattice's own path is taken: a query
/// finds a path exactly when `reachable` says there is one.
///
/// `update` costs O(changed blocks + growth). The same seed and the same history of updates give
/// the same paths, whatever was asked before: queries leave no trace but what they found out of
/// edges. They are not for concurrent use. The free space must outlive the roadmap. Models
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
    require(options.samples > 0 && options.growth > 0,
            "roadmap samples and growth: expected at least 1");
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
  /// Brings roadmap and components up to date with the free space, and adds samples if that has
  /// changed. Queries want it after every change of the free space.
  void update() {
    if (follow()) grow();
  }
  /// Adds samples until all cubes have theirs: for a space that is known from the beginning.
  void densify() {
    while (!sparse_.empty()) grow();
  }

  /// O(1), and O(voxels within `escape_distance`) when first asked for another component.
  ReachFrom reach_from(const Point3& a) const {
    SURFLEET_ASSERT(cursor_ == space_->revision(), "the roadmap follows the free space");
    return {reachable_, space_->free_start(a, options_.escape_distance), options_.escape_distance};
  }

  /// A short free path from `a` to `b`; nothing if there is none. If `a` is not free, the path
  /// starts by leaving for the nearest free place; from a place too narrow for the voxel lattice,
  /// straight for one that is not.
  std::optional<Path> query(const Point3& a, const Point3& b) const {
    const ReachFrom reach = reach_from(a);
    auto path = query(reach, b);
    if (!path || reach.start() == a) return path;
    path->points.insert(path->points.begin(), a);
    return Path(std::move(path->points));
  }
  /// The same from where `reach` starts, for many ends.
  std::optional<Path> query(const ReachFrom& reach, const Point3& b) const {
    if (!space_->is_free(b)) return std::nullopt;
    const auto visible = [this](const Point3& p, const Point3& q) {
      return space_->is_free_segment(p, q);
    };
    const Point3& start = reach.start();
    if (visible(start, b)) return Path({start, b});
    const auto gate = reach.gate(b);
    if (!gate) return std::nullopt;
    auto rough = search(*gate, b);
    if (rough.empty()) rough = lattice_path(reachable_, *gate, b);
    if (rough.empty()) return std::nullopt;
    if (*gate != start) rough.insert(rough.begin(), start);
    return shortcut(std::move(rough), visible, options_.shortcut);
  }

  /// Whether a path exists.
  bool reachable(const Point3& a, const Point3& b) const { return reach_from(a)(b); }
  /// The length of a path between two configurations [m], or nothing if there is none: models
  /// `PathDistance`, so that viewpoints can be clustered by a roadmap.
  std::optional<double> operator()(const Configuration& a, const Configuration& b) const {
    const auto path = query(a.position, b.position);
    return path ? std::optional(path->length) : std::nullopt;
  }

  /// Path lengths from one place to many, infinite where there is none; one search for all of them.
  /// Exact where there is a line of sight, else along the roadmap, which is a few per cent longer
  /// than the path `query` returns [m].
  std::vector<double> distances(const Point3& from, std::span<const Point3> targets) const {
    std::vector<double> result(targets.size(), std::numeric_limits<double>::infinity());
    const ReachFrom reach = reach_from(from);
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
        if (const auto path = query(reach, targets[i])) result[i] = lead + path->length;
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
    std::vector<RoadmapArc> arcs;
  };
  struct Cell {
    std::uint32_t stamp = 0;
    bool waits = false;       // for further samples
    std::size_t tries = 0;    // left at those
    std::uint64_t drawn = 0;  // of them so far
    std::vector<std::int32_t> nodes;
  };
  using Attachment = std::vector<Source>;
  static constexpr double kBlocked = std::numeric_limits<double>::infinity();

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
  /// True if the free space has changed.
  bool follow() {
    reachable_.update();
    const auto changed = space_->changed_since(cursor_);
    if (changed.empty()) return false;
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
    // The order in which blocks have changed is nothing that the samples should depend on.
    std::sort(touched.begin(), touched.end(),
              [](const VoxelIndex& a, const VoxelIndex& b) { return key_of(a) < key_of(b); });
    for (const VoxelIndex& c : touched) repair(c);
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(0.5 * radius_);
    const int rings = static_cast<int>(std::ceil(reach.x() / options_.spacing));
    for (const VoxelIndex& c : touched)
      for_each_index(c - VoxelIndex::Constant(rings), c + VoxelIndex::Constant(rings),
                     [&](const VoxelIndex& n) {
                       if (const Cell* cell = cells_.find(n); cell != nullptr)
                         for (const std::int32_t id : cell->nodes) forget_blocked(id);
                     });
    return true;
  }
  void repair(const VoxelIndex& c) {
    Cell& cell = cells_.ensure(c);
    std::erase_if(cell.nodes, [&](std::int32_t id) {
      if (space_->is_free(nodes_[index(id)].position)) return false;
      disconnect(id);
      return true;
    });
    if (cell.nodes.empty())
      if (const auto p = cell_sample(*space_, c, options_.spacing, options_.seed)) add(*p, radius_);
    cell.tries = 4 * options_.samples;
    if (!std::exchange(cell.waits, true)) sparse_.push_back(c);
  }
  /// Adds the next samples to cells that obstacles reach into, each in its turn.
  void grow() {
    for (std::size_t added = 0; added < options_.growth && !sparse_.empty();) {
      const VoxelIndex c = sparse_.front();
      sparse_.pop_front();
      Cell& cell = cells_.ensure(c);
      cell.waits = false;
      const std::size_t has = cell.nodes.size();
      if (has == 0 || has >= options_.samples || is_open_cell(*space_, c, options_.spacing))
        continue;
      ++added;
      const double density = static_cast<double>(has + 1);
      if (const auto p = further_sample(*space_, c, options_.spacing, options_.seed, cell.drawn++))
        add(*p, radius_ / std::cbrt(density));
      if (--cell.tries == 0) continue;
      cell.waits = true;
      sparse_.push_back(c);
    }
  }
  std::int32_t add(const Point3& p, double radius) {
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
    for_each_near(p, radius, [&](std::int32_t other, double d) {
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
    for (const RoadmapArc& arc : node.arcs)
      if (arc.length == kBlocked)
        note(id, arc.to, 0, (nodes_[index(arc.to)].position - node.position).norm());
  }
  std::uint32_t& node_stamp(std::int32_t id) {
    if (node_stamps_.size() < nodes_.size()) node_stamps_.resize(nodes_.size(), 0);
    return node_stamps_[index(id)];
  }

  // -- edges -------------------------------------------------------------------------------------
  const RoadmapArc& arc(std::int32_t from, std::int32_t to) const {
    const auto& list = nodes_[index(from)].arcs;
    return *std::find_if(list.begin(), list.end(), [to](const auto& a) { return a.to == to; });
  }
  void note(std::int32_t a, std::int32_t b, std::uint32_t checked, double length) const {
    for (const RoadmapArc* directed : {&arc(a, b), &arc(b, a)}) {
      directed->checked = checked;
      directed->length = length;
    }
  }
  /// Checks an edge unless that was done since the last change of the map.
  bool check(std::int32_t a, std::int32_t b) const {
    const RoadmapArc& e = arc(a, b);
    if (e.checked == epoch_ || e.length == kBlocked) return e.length < kBlocked;
    ++checks_;
    const bool free = space_->is_free_segment(nodes_[index(a)].position, nodes_[index(b)].position);
    note(a, b, epoch_, free ? e.length : kBlocked);
    return free;
  }
  /// Checks all edges of a path. Where one is blocked, everything else at its ends is checked too,
  /// since the next candidate will try those.
  bool check_path(const std::vector<std::int32_t>& path) const {
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
  std::vector<Point3> search(const Point3& a, const Point3& b) const {
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
  std::deque<VoxelIndex> sparse_;  // cells that may want more samples, in turn
  mutable std::uint64_t checks_ = 0;
};
static_assert(WeightedGraph<LazyPrmStar>);
}  // namespace surfleet
