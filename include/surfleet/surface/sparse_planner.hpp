// SPDX-License-Identifier: MIT
/// @file
/// @brief Paths over the points of a sparse cloud by RRT* [004 §8.3].
///
///     const SparsePlanner plan(cloud);
///     if (const auto path = plan(start, goal)) use(path->points);
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/surface/quadric_patch.hpp>

namespace surfleet {
struct SparsePlannerOptions {
  std::size_t samples = 5000;        ///< Points drawn from the cloud.
  std::optional<double> gamma = {};  ///< Of the radius γ (log n / n)^½ [m]; else from the area.
  std::optional<double> longest_edge = {};  ///< Of the tree [m]; else 8 times the points' spacing.
  std::optional<double> gap = {};        ///< Farthest an edge may pass from points [m]; else 2.5.
  double greatest_bend = radians(60.0);  ///< Between normals at the ends of an edge [rad].
  double goal_bias = 0.02;               ///< Share of the samples that are the goal.
  std::uint64_t seed = 1;
};

/// Cloud points from the start to the goal.
struct SparsePath {
  std::vector<std::int32_t> points;
  double length = 0.0;    ///< [m]
  double cost = 0.0;      ///< The length by the tree's own account [m].
  std::size_t nodes = 0;  ///< Of the tree.
};

/// The optimal rapidly exploring random tree (Karaman and Frazzoli 2011) whose samples and nodes
/// are the cloud's own points: the scanner has sampled the surface already. An edge is short, bends
/// little between its ends' normals and stays near points all along, so that the tree neither jumps
/// over gaps nor cuts through what it is to climb over.
///
/// The cloud must have normals and outlive it. The same seed gives the same tree. O(s log s + edges
/// tested) for s samples.
class SparsePlanner {
 public:
  explicit SparsePlanner(const PointCloud& cloud, SparsePlannerOptions options = {})
      : cloud_(&cloud), options_(options), tree_(cloud.points) {
    require(cloud.size() >= 2 && cloud.normals.size() == cloud.size(),
            "sparse planner: expected two points or more, with normals");
    require(options.samples >= 1 && options.goal_bias >= 0.0 && options.goal_bias < 1.0,
            "sparse planner: expected samples, and a goal bias of 0 or more and less than 1");
    const double spacing = median_spacing(cloud.points);
    require(spacing > 0.0, "sparse planner: the points lie at one place");
    gap_ = options.gap.value_or(2.5 * spacing);
    // Points thrown at random lie 0.47/√density from their nearest in the median.
    const double area = static_cast<double>(cloud.size()) * spacing * spacing / 0.22;
    gamma_ = options.gamma.value_or(2.0 * std::sqrt(1.5 * area / kPi));
    const double n = static_cast<double>(options.samples) + 1.0;
    longest_ =
        options.longest_edge.value_or(std::max(8.0 * spacing, gamma_ * std::sqrt(std::log(n) / n)));
    require(longest_ > 0.0 && gap_ > 0.0, "sparse planner: expected edges of more than 0 m");
  }

  /// Between two points of the cloud; nothing where the tree did not reach the goal.
  std::optional<SparsePath> operator()(std::int32_t start, std::int32_t goal) const {
    for (const std::int32_t i : {start, goal})
      require(i >= 0 && static_cast<std::size_t>(i) < cloud_->size(),
              "sparse planner: expected points of the cloud");
    Tree t{std::vector<std::int32_t>(cloud_->size(), -2),
           std::vector<double>(cloud_->size(), 0.0),
           std::vector<std::vector<std::int32_t>>(cloud_->size()),
           {},
           Cells({.voxel_size = longest_}),
           0};
    add(t, start, -1, 0.0);
    Random random(mix64(options_.seed) ^ 0x59a5eULL);
    for (std::size_t s = 0; s < options_.samples; ++s) {
      const std::int32_t sample = random.uniform() < options_.goal_bias
                                      ? goal
                                      : static_cast<std::int32_t>(random.below(cloud_->size()));
      extend(t, sample);
    }
    if (t.parent[at(goal)] == -2) return std::nullopt;
    SparsePath path;
    path.nodes = t.count;
    path.cost = t.cost[at(goal)];
    for (std::int32_t i = goal; i >= 0; i = t.parent[at(i)]) path.points.push_back(i);
    std::reverse(path.points.begin(), path.points.end());
    for (std::size_t i = 1; i < path.points.size(); ++i)
      path.length += (point(path.points[i]) - point(path.points[i - 1])).norm();
    return path;
  }

  /// Whether a robot may go straight from one point to another.
  bool edge(std::int32_t a, std::int32_t b) const {
    const Eigen::Vector3d d = point(b) - point(a);
    const double length = d.norm();
    if (length > longest_ || !(length > 0.0)) return a == b;
    const Eigen::Vector3d na = normal(a), nb = normal(b);
    if (na.dot(nb) < std::cos(options_.greatest_bend)) return false;
    const int parts = static_cast<int>(std::ceil(length / gap_));
    for (int k = 1; k < parts; ++k)
      if (!tree_.nearest(point(a) + d * k / parts, gap_)) return false;
    return true;
  }
  const KdTree& tree() const { return tree_; }
  double longest_edge() const { return longest_; }

 private:
  /// The tree's nodes by cells of the longest edge.
  using Cells = VoxelGrid<std::vector<std::int32_t>, 1>;
  template <typename Use>
  static void for_each_near(const Cells& cells, const Point3& p, const Use& use) {
    const VoxelIndex home = cells.index_of(p);
    for_each_index(home - VoxelIndex::Ones(), home + VoxelIndex::Ones(), [&](const VoxelIndex& c) {
      if (const auto* nodes = cells.find(c))
        for (const std::int32_t i : *nodes) use(i);
    });
  }
  struct Tree {
    std::vector<std::int32_t> parent;  // −1 at the root, −2 outside
    std::vector<double> cost;
    std::vector<std::vector<std::int32_t>> children;
    std::vector<std::int32_t> nodes;
    Cells cells;
    std::size_t count;
  };
  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }
  const Point3& point(std::int32_t i) const { return cloud_->points[at(i)]; }
  Eigen::Vector3d normal(std::int32_t i) const { return cloud_->normals[at(i)].cast<double>(); }

  void add(Tree& t, std::int32_t i, std::int32_t parent, double cost) const {
    t.parent[at(i)] = parent;
    t.cost[at(i)] = cost;
    if (parent >= 0) t.children[at(parent)].push_back(i);
    t.nodes.push_back(i);
    t.cells.ensure(t.cells.index_of(point(i))).push_back(i);
    ++t.count;
  }
  void extend(Tree& t, std::int32_t sample) const {
    std::int32_t node = sample;
    if (t.parent[at(sample)] == -2) {
      // The tree's nearest node, then a cloud point a step from it towards the sample.
      std::int32_t nearest = -1;
      double least = longest_;
      for_each_near(t.cells, point(sample), [&](std::int32_t i) {
        const double d = (point(i) - point(sample)).norm();
        if (d < least || (d == least && i < nearest)) {
          least = d;
          nearest = i;
        }
      });
      if (nearest < 0) {
        least = std::numeric_limits<double>::infinity();
        for (const std::int32_t i : t.nodes) {
          const double d = (point(i) - point(sample)).norm();
          if (d < least) {
            least = d;
            nearest = i;
          }
        }
        const Point3 step =
            point(nearest) + 0.7 * longest_ / least * (point(sample) - point(nearest));
        node = tree_.nearest(step)->index;
      }
    }
    // Parents in reach, the cheapest first; then the nodes that it serves better.
    const double n = static_cast<double>(t.count + 1);
    const double radius = std::min(longest_, gamma_ * std::sqrt(std::log(n + 1.0) / n));
    struct Near {
      double cost, length;
      std::int32_t index;
    };
    std::vector<Near> near;
    for_each_near(t.cells, point(node), [&](std::int32_t i) {
      const double d = (point(i) - point(node)).norm();
      if (i != node && d <= radius) near.push_back({t.cost[at(i)] + d, d, i});
    });
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
      return a.cost != b.cost ? a.cost < b.cost : a.index < b.index;
    });
    const bool fresh = t.parent[at(node)] == -2;
    for (const Near& p : near) {
      if (!fresh && p.cost >= t.cost[at(node)]) break;
      if (!edge(p.index, node)) continue;
      if (fresh)
        add(t, node, p.index, p.cost);
      else
        move(t, node, p.index, p.cost);
      break;
    }
    if (t.parent[at(node)] == -2) return;
    for (const Near& p : near)
      if (t.cost[at(node)] + p.length < t.cost[at(p.index)] * (1.0 - 1e-12) && edge(node, p.index))
        move(t, p.index, node, t.cost[at(node)] + p.length);
  }
  void move(Tree& t, std::int32_t i, std::int32_t parent, double cost) const {
    if (t.parent[at(i)] == -1) return;
    std::erase(t.children[at(t.parent[at(i)])], i);
    t.parent[at(i)] = parent;
    t.children[at(parent)].push_back(i);
    const double change = cost - t.cost[at(i)];
    std::vector<std::int32_t> stack{i};
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      t.cost[at(v)] += change;
      stack.insert(stack.end(), t.children[at(v)].begin(), t.children[at(v)].end());
    }
  }

  const PointCloud* cloud_;
  SparsePlannerOptions options_;
  KdTree tree_;
  double longest_ = 0.0, gap_ = 0.0, gamma_ = 0.0;
};
}  // namespace surfleet
