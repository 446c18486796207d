// SPDX-License-Identifier: MIT
/// @file
/// @brief The directed graph of viewpoint clusters whose arcs carry what a visit costs and gains
/// [000 §2.5.1, eq. 2.2, 2.3].
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// What the cluster graph asks of a utility: `u(gain, travel, inside)` is the benefit of a visit
/// that gains `gain` after `travel` metres to the cluster and `inside` metres in it. Not
/// negative, rising with the gain, falling with either length, zero at infinite length.
template <typename U>
concept UtilityPolicy = std::copyable<U> && requires(const U& u, double x) {
  { u(x, x, x) } -> std::convertible_to<double>;
};

/// f = g exp(−λ_tc travel − λ_ic inside) [000 eq. 2.3]. The defaults are those of [000 Table 2.1].
struct ExponentialUtility {
  double lambda_tc = 0.3;   ///< Penalty of travel between clusters [1/m].
  double lambda_ic = 0.03;  ///< Penalty of travel inside a cluster [1/m].
  double operator()(double gain, double travel, double inside) const {
    return gain * std::exp(-lambda_tc * travel - lambda_ic * inside);
  }
};

/// Gain per metre: f = g / (overhead + travel + inside).
struct RatioUtility {
  double overhead = 1.0;  ///< What a visit costs where it needs no travel [m]; positive.
  double operator()(double gain, double travel, double inside) const {
    return gain / (overhead + travel + inside);
  }
};
static_assert(UtilityPolicy<ExponentialUtility> && UtilityPolicy<RatioUtility>);

/// Configurations that are visited together, and the gain of the views from all of them.
template <typename P>
struct ConfigurationCluster {
  std::vector<P> configurations;  ///< At least one.
  double gain = 0.0;              ///< g(U) > 0 [000 eq. 2.1].
};

/// One visit: from a state (where the robot is) into a cluster and through it.
struct Hop {
  int state = -1;        ///< Where the visit ends: the state from which the next hop starts.
  double utility = 0.0;  ///< f_UV.
  double travel = 0.0;   ///< d(τ_k^l), to the cluster's entry [m].
  double inside = 0.0;   ///< d(τ_l^m), from the entry through all configurations [m].
  double length() const { return travel + inside; }
};

/// What allocation asks of the world: visits, one after the other.
///
/// `hop(robot, state, cluster)` is the visit of `cluster` from `state`, −1 being the robot's own
/// start. `gain(cluster)` ranks clusters. The utility of a visit may depend on where the one
/// before it ended, which is what `state` is for. Models: `ClusterGraph`, `MatrixRouting`.
template <typename G>
concept ClusterRouting = requires(const G& g, int i) {
  { g.clusters() } -> std::convertible_to<int>;
  { g.robots() } -> std::convertible_to<int>;
  { g.gain(i) } -> std::convertible_to<double>;
  { g.hop(i, i, i) } -> std::convertible_to<Hop>;
};

/// The travel of a visit alone, for graphs that know it before the path inside.
template <ClusterRouting G>
double travel_of_hop(const G& graph, int robot, int state, int cluster) {
  if constexpr (requires { graph.travel(robot, state, cluster); })
    return graph.travel(robot, state, cluster);
  else
    return Hop(graph.hop(robot, state, cluster)).travel;
}
/// What the utility of a visit is at most, for graphs that know so before the path inside.
template <ClusterRouting G>
double most_utility_of_hop(const G& graph, int robot, int state, int cluster) {
  if constexpr (requires { graph.most_utility(robot, state, cluster); })
    return graph.most_utility(robot, state, cluster);
  else
    return Hop(graph.hop(robot, state, cluster)).utility;
}

/// A table of utilities and lengths over the robots' starts (first) and the clusters (after them).
struct MatrixRouting {
  int robot_count = 0;
  CostMatrix utility;  ///< (robots + clusters)²; columns of robots are not used.
  CostMatrix length;   ///< The same, in metres.

  int robots() const { return robot_count; }
  int clusters() const { return utility.size() - robot_count; }
  double gain(int cluster) const {
    double most = 0.0;
    for (int i = 0; i < utility.size(); ++i)
      if (i != robot_count + cluster) most = std::max(most, utility(i, robot_count + cluster));
    return most;
  }
  Hop hop(int robot, int state, int cluster) const {
    const int from = state < 0 ? robot : robot_count + state, to = robot_count + cluster;
    return {cluster, utility(from, to), length(from, to), 0.0};
  }
};
static_assert(ClusterRouting<MatrixRouting>);

/// The edge e_UV of the cluster graph: the 6-tuple of eq. 2.2.
///
/// τ_k^l is the path from `exit` to `entry`; τ_l^m is `ClusterGraph::inside_path(entry)`.
struct ClusterEdge {
  int exit = -1;   ///< k: the configuration of U (or −1, the robot's start) that is left.
  int entry = -1;  ///< l: the configuration of V that is nearest to it.
  int end = -1;    ///< m: where the path inside V ends.
  double gain = 0.0;
  double travel = 0.0;  ///< d(τ_k^l) [m].
  double inside = 0.0;  ///< d(τ_l^m) [m].
  double utility = 0.0;
};

/// Clusters, robots, and the edges between them, made as they are asked for and kept.
///
/// A cluster is entered at its configuration nearest to where the robot comes from and left where
/// the shortest Hamiltonian path from there ends, so an edge depends on the configuration in which
/// the visit before ended: states are configurations, numbered cluster after cluster. An edge
/// costs |V| distances, and a 3-opt for an entry not used before. Not for concurrent use.
/// `travel` costs the distances alone; `most_utility` |V|² once for each cluster.
template <typename P, UtilityPolicy Utility = ExponentialUtility,
          typename Distance = EuclideanDistance, TourSolver PathSolver = ThreeOpt>
class ClusterGraph {
 public:
  /// `distance(a, b)` [m] may be infinite: there is no path. Utilities are one for all robots, or
  /// one each. Throws `Error` for an empty cluster or a gain that is not positive and finite.
  ClusterGraph(std::vector<ConfigurationCluster<P>> clusters, std::vector<P> robot_starts,
               std::vector<Utility> utilities = {Utility{}}, Distance distance = {},
               PathSolver solver = {})
      : clusters_(std::move(clusters)),
        starts_(std::move(robot_starts)),
        utilities_(std::move(utilities)),
        distance_(std::move(distance)),
        solver_(std::move(solver)) {
    require(utilities_.size() == 1 || (utilities_.size() == starts_.size() && !utilities_.empty()),
            "cluster graph: " + std::to_string(utilities_.size()) +
                " utilities; expected one, or one for each of the robots");
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      require(!clusters_[c].configurations.empty(),
              "cluster graph: cluster " + std::to_string(c) + " has no configuration");
      require(clusters_[c].gain > 0.0 && std::isfinite(clusters_[c].gain),
              "cluster graph: cluster " + std::to_string(c) +
                  " has a gain that is not positive and finite");
      first_.push_back(static_cast<int>(cluster_of_.size()));
      cluster_of_.insert(cluster_of_.end(), clusters_[c].configurations.size(),
                         static_cast<int>(c));
    }
    inside_.resize(cluster_of_.size());
    rows_.resize(cluster_of_.size() + starts_.size());
    lengths_.resize(clusters_.size());
    least_inside_.assign(clusters_.size(), -1.0);
  }

  int clusters() const { return static_cast<int>(clusters_.size()); }
  int robots() const { return static_cast<int>(starts_.size()); }
  int configurations() const { return static_cast<int>(cluster_of_.size()); }
  double gain(int cluster) const { return clusters_[cluster].gain; }
  int cluster_of(int configuration) const { return cluster_of_[configuration]; }
  const P& configuration(int index) const {
    const int c = cluster_of_[index];
    return clusters_[c].configurations[index - first_[c]];
  }
  const P& start(int robot) const { return starts_[robot]; }

  /// The edge from configuration `exit` (−1: the robot's start) to `cluster`.
  ClusterEdge edge(int robot, int exit, int cluster) const {
    const Leg& l = leg(robot, exit, cluster);
    return {exit,
            l.entry,
            l.hop.state,
            clusters_[cluster].gain,
            l.hop.travel,
            l.hop.inside,
            hop(robot, exit, cluster).utility};
  }
  Hop hop(int robot, int state, int cluster) const {
    Hop h = leg(robot, state, cluster).hop;
    if (utilities_.size() > 1)
      h.utility = utilities_[robot](clusters_[cluster].gain, h.travel, h.inside);
    return h;
  }
  /// The travel of `hop`.
  double travel(int robot, int state, int cluster) const {
    return arrival(robot, state, cluster).hop.travel;
  }
  /// No less than the utility of `hop`: every path inside is as long as the spanning tree.
  double most_utility(int robot, int state, int cluster) const {
    const Leg& l = arrival(robot, state, cluster);
    const Utility& utility = utilities_[utilities_.size() > 1 ? robot : 0];
    const double known = inside_[l.entry].order.empty() ? least_inside(cluster) * (1.0 - 1e-9)
                                                        : inside_[l.entry].length;
    return utility(clusters_[cluster].gain, l.hop.travel, known);
  }
  /// The configurations of a cluster in the order of the path from `entry`.
  std::span<const int> inside_path(int entry) const { return inside(entry).order; }

  /// All configurations that `robot` visits along a route of clusters, in order.
  std::vector<int> viewpoints(int robot, std::span<const int> route) const {
    std::vector<int> result;
    int state = -1;
    for (const int cluster : route) {
      const ClusterEdge e = edge(robot, state, cluster);
      const auto path = inside_path(e.entry);
      result.insert(result.end(), path.begin(), path.end());
      state = e.end;
    }
    return result;
  }

 private:
  struct Leg {
    int entry = -1;
    Hop hop;  // its utility by the first policy
  };
  struct Inside {
    std::vector<int> order;
    double length = 0.0;
  };

  /// The leg with entry and travel; the rest once `leg` has been asked for it.
  Leg& arrival(int robot, int state, int cluster) const {
    auto& row = rows_[state < 0 ? configurations() + robot : state];
    if (row.empty()) row.resize(clusters_.size());
    Leg& l = row[cluster];
    if (l.entry >= 0) return l;
    const P& p = state < 0 ? starts_[robot] : configuration(state);
    const auto& members = clusters_[cluster].configurations;
    for (int k = 0; k < static_cast<int>(members.size()); ++k) {
      const double d = distance_(p, members[k]);
      if (l.entry < 0 || d < l.hop.travel) {
        l.entry = first_[cluster] + k;
        l.hop.travel = d;
      }
    }
    return l;
  }
  const Leg& leg(int robot, int state, int cluster) const {
    Leg& l = arrival(robot, state, cluster);
    if (l.hop.state < 0) {
      const Inside& in = inside(l.entry);
      l.hop.inside = in.length;
      l.hop.state = in.order.back();
      l.hop.utility = utilities_.front()(clusters_[cluster].gain, l.hop.travel, l.hop.inside);
    }
    return l;
  }
  double length_inside(const P& a, const P& b) const { return std::min(distance_(a, b), kNoPath); }
  /// Weight of the minimum spanning tree of a cluster, by Prim [m].
  double least_inside(int cluster) const {
    double& least = least_inside_[cluster];
    if (least >= 0.0) return least;
    const auto& members = clusters_[cluster].configurations;
    std::vector<int> left(members.size() - 1);
    std::iota(left.begin(), left.end(), 1);
    std::vector<double> to_tree(members.size(), std::numeric_limits<double>::infinity());
    least = 0.0;
    for (int last = 0; !left.empty();) {
      std::size_t nearest = 0;
      for (std::size_t i = 0; i < left.size(); ++i) {
        double& d = to_tree[left[i]];
        d = std::min({d, length_inside(members[last], members[left[i]]),
                      length_inside(members[left[i]], members[last])});
        if (d < to_tree[left[nearest]]) nearest = i;
      }
      last = left[nearest];
      least += to_tree[last];
      left[nearest] = left.back();
      left.pop_back();
    }
    return least;
  }
  const Inside& inside(int entry) const {
    Inside& in = inside_[entry];
    if (in.order.empty()) {
      const int c = cluster_of_[entry];
      const auto& members = clusters_[c].configurations;
      const int n = static_cast<int>(members.size());
      CostMatrix& d = lengths_[c];
      if (d.size() != n) {
        d = CostMatrix(n);
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j)
            if (i != j) d(i, j) = length_inside(members[i], members[j]);
      }
      HamiltonianPath path = shortest_hamiltonian_path(d, entry - first_[c], solver_);
      for (int& k : path.order) k += first_[c];
      in = {std::move(path.order), path.length};
    }
    return in;
  }

  // Stands for "no path" inside a cluster, where tours need finite lengths.
  static constexpr double kNoPath = 1e9;

  std::vector<ConfigurationCluster<P>> clusters_;
  std::vector<P> starts_;
  std::vector<Utility> utilities_;
  Distance distance_;
  PathSolver solver_;
  std::vector<int> first_, cluster_of_;
  mutable std::vector<std::vector<Leg>> rows_;
  mutable std::vector<Inside> inside_;
  mutable std::vector<CostMatrix> lengths_;
  mutable std::vector<double> least_inside_;  // by cluster; −1: not known yet
};
static_assert(ClusterRouting<ClusterGraph<Configuration>>);
}  // namespace surfleet
