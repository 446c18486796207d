// SPDX-License-Identifier: MIT
/// @file
/// @brief The p-median problem: choose p of n places so that all clients together are cheap to
/// reach. Vertex substitution (Teitz and Bart), and a search around its local optima.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/coverage/mesh_graph.hpp>

namespace surfleet {
/// Places that may be chosen, clients to be served, and what each pair costs.
class PMedianProblem {
 public:
  PMedianProblem(std::size_t places, std::size_t clients)
      : places_(places), clients_(clients), cost_(places * clients) {}

  std::size_t places() const { return places_; }
  std::size_t clients() const { return clients_; }
  /// What every client pays for being served from `place`.
  std::span<double> row(std::size_t place) { return {&cost_[place * clients_], clients_}; }
  std::span<const double> row(std::size_t place) const {
    return {&cost_[place * clients_], clients_};
  }

 private:
  std::size_t places_, clients_;
  std::vector<double> cost_;
};

/// The problem of eq. 6.4 on a graph: d(v, place)^p M(v). Where a place cannot be reached it costs
/// more than any place that can. n searches: O(n² log n) time, 8 n² bytes.
inline PMedianProblem p_median_problem(const SurfaceGraph& graph, double exponent = 2.0) {
  const std::size_t n = graph.size();
  require(n <= 8000, "p-median: at most 8000 sites for a full matrix; use a coarser surface");
  PMedianProblem problem(n, n);
  double length = 0.0;
  for (std::size_t v = 0; v < n; ++v)
    for (const Arc& arc : graph.links.arcs(static_cast<std::int32_t>(v))) length += arc.length;
  for (std::size_t place = 0; place < n; ++place) {
    const auto paths = shortest_paths(graph, static_cast<std::int32_t>(place));
    const auto row = problem.row(place);
    for (std::size_t v = 0; v < n; ++v) {
      const double d = std::min(paths.distance[v], 2.0 * length);
      row[v] = (exponent == 2.0 ? d * d : std::pow(d, exponent)) * graph.mass[v];
    }
  }
  return problem;
}

/// Places chosen, with every client's best and second-best among them.
class PMedianSolution {
 public:
  PMedianSolution(const PMedianProblem& problem, std::vector<std::int32_t> chosen)
      : problem_(&problem), chosen_(std::move(chosen)), open_(problem.places(), 0) {
    require(!chosen_.empty(), "p-median: no place chosen");
    for (const std::int32_t place : chosen_) {
      std::uint8_t& open = open_[static_cast<std::size_t>(place)];
      require(open == 0, "p-median: a place is chosen twice");
      open = 1;
    }
    refresh();
  }
  const std::vector<std::int32_t>& chosen() const { return chosen_; }
  double cost() const { return cost_; }
  bool is_open(std::int32_t place) const { return open_[static_cast<std::size_t>(place)] != 0; }

  /// What opening `place` and closing the best slot for it would save. O(clients + p).
  ///
  /// What a robot must know for it is its own region: its clients' best and second-best costs. The
  /// bid of a new place is the sum over the regions it would draw clients from.
  double best_swap(std::int32_t place, std::size_t& slot) const {
    if (is_open(place)) return 0.0;
    loss_.assign(chosen_.size(), 0.0);
    const auto row = problem_->row(static_cast<std::size_t>(place));
    double gain = 0.0;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (row[c] < first_[c]) {
        gain += first_[c] - row[c];
      } else {
        loss_[first_slot_[c]] += std::min(second_[c], row[c]) - first_[c];
      }
    }
    slot = static_cast<std::size_t>(std::min_element(loss_.begin(), loss_.end()) - loss_.begin());
    return gain - loss_[slot];
  }
  /// Moves the robot of `slot` to `place`. O(clients) plus O(p) for each client it served.
  void swap(std::size_t slot, std::int32_t place) {
    open_[static_cast<std::size_t>(chosen_[slot])] = 0;
    open_[static_cast<std::size_t>(place)] = 1;
    chosen_[slot] = place;
    const auto row = problem_->row(static_cast<std::size_t>(place));
    cost_ = 0.0;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (first_slot_[c] == slot || second_slot_[c] == slot) {
        rank(c);
      } else if (row[c] < first_[c]) {
        second_[c] = first_[c];
        second_slot_[c] = first_slot_[c];
        first_[c] = row[c];
        first_slot_[c] = slot;
      } else if (row[c] < second_[c]) {
        second_[c] = row[c];
        second_slot_[c] = slot;
      }
      cost_ += first_[c];
    }
  }

 private:
  void rank(std::size_t c) {
    first_[c] = second_[c] = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < chosen_.size(); ++s) {
      const double d = problem_->row(static_cast<std::size_t>(chosen_[s]))[c];
      if (d < first_[c]) {
        second_[c] = first_[c];
        second_slot_[c] = first_slot_[c];
        first_[c] = d;
        first_slot_[c] = s;
      } else if (d < second_[c]) {
        second_[c] = d;
        second_slot_[c] = s;
      }
    }
  }
  void refresh() {
    const std::size_t n = problem_->clients();
    first_.resize(n);
    second_.resize(n);
    first_slot_.assign(n, 0);
    second_slot_.assign(n, 0);
    cost_ = 0.0;
    for (std::size_t c = 0; c < n; ++c) {
      rank(c);
      cost_ += first_[c];
    }
  }
  const PMedianProblem* problem_;
  std::vector<std::int32_t> chosen_;
  std::vector<std::uint8_t> open_;
  std::vector<double> first_, second_;
  std::vector<std::size_t> first_slot_, second_slot_;
  mutable std::vector<double> loss_;
  double cost_ = 0.0;
};

/// One pass of vertex substitution over all places in turn; true if any swap was made. O(n²).
inline bool substitution_pass(const PMedianProblem& problem, PMedianSolution& solution) {
  bool improved = false;
  for (std::size_t place = 0; place < problem.places(); ++place) {
    std::size_t slot = 0;
    const double gain = solution.best_swap(static_cast<std::int32_t>(place), slot);
    if (!(gain > 1e-12 * solution.cost())) continue;
    solution.swap(slot, static_cast<std::int32_t>(place));
    improved = true;
  }
  return improved;
}

/// Vertex substitution to its end: no single robot can move anywhere and lower the cost.
inline void substitute(const PMedianProblem& problem, PMedianSolution& solution) {
  while (substitution_pass(problem, solution)) {
  }
}

/// Variable neighbourhood search: `rounds` times, a few robots at random to random places, then
/// substitution; what is better stays. Deterministic for a seed.
inline void search_medians(const PMedianProblem& problem, PMedianSolution& solution, int rounds,
                           Random& random) {
  substitute(problem, solution);
  const std::size_t p = solution.chosen().size();
  if (p >= problem.places()) return;
  std::size_t strength = 1;
  for (int round = 0; round < rounds; ++round) {
    PMedianSolution trial = solution;
    for (std::size_t k = 0; k < strength; ++k) {
      std::int32_t place;
      do {
        place = static_cast<std::int32_t>(random.below(problem.places()));
      } while (trial.is_open(place));
      trial.swap(random.below(p), place);
    }
    substitute(problem, trial);
    if (trial.cost() < solution.cost() * (1.0 - 1e-12)) {
      solution = trial;
      strength = 1;
    } else {
      strength = strength % std::max<std::size_t>(1, std::min<std::size_t>(p, 4)) + 1;
    }
  }
}
}  // namespace surfleet
