// SPDX-License-Identifier: MIT
/// @file
/// @brief An iterated Lin–Kernighan heuristic for asymmetric tours.
///
/// The steps of the descent exchange two neighbouring segments of the tour, which changes three
/// arcs and turns no arc round, so that asymmetric costs are as cheap to evaluate as symmetric
/// ones [Kanellakis & Papadimitriou 1980]. Steps are chained while the partial gain stays
/// positive; the first two (five arcs) are searched exhaustively among candidate arcs of small
/// reduced cost, the rest greedily. Where costs are nearly symmetric, reversals are tried as well.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/allocation/three_opt.hpp>
#include <surfleet/allocation/tour.hpp>
#include <surfleet/core/random.hpp>

namespace surfleet {
namespace detail {
/// For each node the arcs out of it that good tours are made of, cheapest first.
class CandidateArcs {
 public:
  CandidateArcs(const CostMatrix& costs, const Assignment& dual, int by_price, int by_cost) {
    const int n = costs.size();
    std::vector<char> chosen(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0);
    std::vector<std::pair<double, int>> keys;
    const auto choose = [&](int node, int count, auto&& key, bool into) {
      keys.clear();
      for (int j = 0; j < n; ++j)
        if (j != node) keys.emplace_back(key(j), j);
      if (count < static_cast<int>(keys.size()))
        std::nth_element(keys.begin(), keys.begin() + count, keys.end());
      for (int k = 0; k < std::min(count, static_cast<int>(keys.size())); ++k) {
        const int j = keys[k].second;
        chosen[static_cast<std::size_t>(into ? j : node) * static_cast<std::size_t>(n) +
               static_cast<std::size_t>(into ? node : j)] = 1;
      }
    };
    for (int i = 0; i < n; ++i) {
      choose(
          i, by_price, [&](int j) { return costs(i, j) - dual.column_price[j]; }, false);
      choose(
          i, by_cost, [&](int j) { return costs(i, j); }, false);
      choose(
          i, (by_price + 1) / 2, [&](int j) { return costs(j, i) - dual.row_price[j]; }, true);
    }
    first_.reserve(static_cast<std::size_t>(n) + 1);
    first_.push_back(0);
    for (int i = 0; i < n; ++i) {
      keys.clear();
      const char* row = chosen.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(n);
      for (int j = 0; j < n; ++j)
        if (row[j] != 0) keys.emplace_back(costs(i, j), j);
      std::sort(keys.begin(), keys.end());
      for (const auto& [cost, j] : keys) arcs_.push_back({j, cost});
      first_.push_back(static_cast<int>(arcs_.size()));
    }
  }
  struct Candidate {
    int to;
    double cost;
  };
  std::span<const Candidate> operator[](int node) const {
    return std::span<const Candidate>(arcs_).subspan(first_[node], first_[node + 1] - first_[node]);
  }

 private:
  std::vector<int> first_;
  std::vector<Candidate> arcs_;
};

/// A closed tour in an array, its local search and its perturbations.
class LinKernighanSearch {
 public:
  LinKernighanSearch(const CostMatrix& costs, const CandidateArcs& candidates, bool reversals,
                     bool symmetric)
      : costs_(costs),
        candidates_(candidates),
        n_(costs.size()),
        tolerance_(std::max(gain_tolerance(costs), 1e-300)),
        reversals_(reversals),
        symmetric_(symmetric),
        position_(n_),
        queued_(n_, 0),
        buffer_(n_) {}

  void set(std::vector<int> cycle) {
    node_ = std::move(cycle);
    for (int k = 0; k < n_; ++k) position_[node_[k]] = k;
    length_ = cycle_length(costs_, node_);
    log_.clear();
  }
  const std::vector<int>& cycle() const { return node_; }
  double length() const { return length_; }
  double tolerance() const { return tolerance_; }

  /// Descends from where the queued nodes' arcs are.
  void descend() {
    while (head_ < queue_.size()) {
      const int t = queue_[head_++];
      queued_[t] = 0;
      while (improve(t)) {
      }
    }
    queue_.clear();
    head_ = 0;
  }
  void enqueue(int node) {
    if (queued_[node] != 0) return;
    queued_[node] = 1;
    queue_.push_back(node);
  }

  /// Exchanges three short neighbouring segments B C D for D C B, somewhere.
  void kick(Random& random, int longest) {
    longest = std::min(longest, (n_ - 2) / 3);
    const auto length = [&] {
      return 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(longest)));
    };
    const int b = length(), c = length(), d = length();
    const int at = static_cast<int>(random.below(static_cast<std::uint64_t>(n_)));
    const int a_last = node_[wrap(at + n_ - 1)], b_first = node_[at],
              b_last = node_[wrap(at + b - 1)], c_first = node_[wrap(at + b)],
              c_last = node_[wrap(at + b + c - 1)], d_first = node_[wrap(at + b + c)],
              d_last = node_[wrap(at + b + c + d - 1)], a_first = node_[wrap(at + b + c + d)];
    length_ += costs_(a_last, d_first) + costs_(d_last, c_first) + costs_(c_last, b_first) +
               costs_(b_last, a_first) - costs_(a_last, b_first) - costs_(b_last, c_first) -
               costs_(c_last, d_first) - costs_(d_last, a_first);
    exchange(at, b, c);
    exchange(position_[c_first], b + c, d);
    for (const int t : {a_last, b_last, c_last, d_last, a_first, b_first, c_first, d_first})
      enqueue(t);
  }

  /// Forgets how the tour came about: `undo` will return here.
  void commit() {
    log_.clear();
    committed_ = length_;
  }
  void undo() {
    rewind(0);
    length_ = committed_;
  }

 private:
  struct Change {
    int at, first, second;  // second < 0: a reversal of `first` nodes from `at`
  };
  int wrap(int k) const { return k < n_ ? k : k - n_; }
  int before(int k) const { return k == 0 ? n_ - 1 : k - 1; }
  int next(int t) const { return node_[wrap(position_[t] + 1)]; }
  int previous(int t) const { return node_[before(position_[t])]; }
  void place(int k, int t) {
    node_[k] = t;
    position_[t] = k;
  }

  /// Exchanges the segment of `first` nodes at position `at` with the `second` ones behind it. Of
  /// the three segments of the cycle the longest stays where it is, so positions may turn.
  void exchange(int at, int first, int second) {
    const int rest = n_ - first - second;
    if (rest < first || rest < second) {
      if (first >= second) {
        at = wrap(at + first);
        first = second;
        second = rest;
      } else {
        at = wrap(at + first + second);
        second = first;
        first = rest;
      }
    }
    log_.push_back({at, first, second});
    swap_segments(at, first, second);
  }
  void swap_segments(int at, int first, int second) {
    if (first <= second) {
      for (int k = 0, p = at; k < first; ++k, p = wrap(p + 1)) buffer_[k] = node_[p];
      int to = at, from = wrap(at + first);
      for (int k = 0; k < second; ++k, to = wrap(to + 1), from = wrap(from + 1))
        place(to, node_[from]);
      for (int k = 0; k < first; ++k, to = wrap(to + 1)) place(to, buffer_[k]);
    } else {
      for (int k = 0, p = wrap(at + first); k < second; ++k, p = wrap(p + 1)) buffer_[k] = node_[p];
      int to = wrap(at + first + second - 1), from = wrap(at + first - 1);
      for (int k = 0; k < first; ++k, to = before(to), from = before(from)) place(to, node_[from]);
      for (int k = second - 1; k >= 0; --k, to = before(to)) place(to, buffer_[k]);
    }
  }
  void reverse(int at, int count) {
    log_.push_back({at, count, -1});
    reverse_segment(at, count);
  }
  void reverse_segment(int at, int count) {
    int a = at, b = wrap(at + count - 1);
    for (int k = 0; k < count / 2; ++k) {
      const int x = node_[a], y = node_[b];
      place(a, y);
      place(b, x);
      a = wrap(a + 1);
      b = before(b);
    }
  }
  void rewind(std::size_t to) {
    while (log_.size() > to) {
      const Change c = log_.back();
      log_.pop_back();
      if (c.second < 0)
        reverse_segment(c.at, c.first);
      else
        swap_segments(c.at, c.second, c.first);
    }
  }

  // One step of a chain. The arc t1 → t2 is open: the tour is a path from t2 to t1. The step adds
  // t1 → v, removes u → v, adds u → y and removes x → y, with y behind v: the path becomes
  // t2 … u, y … t1, v … x, and x is its new end.
  struct Step {
    int v = -1, y = -1;
    double open_gain = 0.0;  // before the closing arc x → t2
  };
  // Offsets from t2 along the path, before and after a step that has not been carried out.
  int offset(int t, int t2) const {
    const int d = position_[t] - position_[t2];
    return d < 0 ? d + n_ : d;
  }

  void carry_out(int t2, const Step& s) {
    const int u = previous(s.v), x = previous(s.y), t1 = previous(t2);
    const int v_to_x = offset(s.y, t2) - offset(s.v, t2);
    const int y_to_t1 = n_ - offset(s.y, t2);
    exchange(position_[s.v], v_to_x, y_to_t1);
    for (const int t : {t1, u, x, t2, s.v, s.y}) touched_.push_back(t);
    heads_.push_back(s.v);
    heads_.push_back(s.y);
  }
  void keep(double gain) {
    length_ -= gain;
    for (const int t : touched_) enqueue(t);
    touched_.clear();
  }

  /// One improving change that removes the arc out of t1; false if there is none.
  bool improve(int t1) {
    const int t2 = next(t1);
    const double removed = costs_(t1, t2);
    touched_.clear();
    if (reversals_ && improve_by_reversal(t1, t2, removed)) return true;
    // Three arcs: take the best.
    Step best;
    double best_gain = tolerance_;
    for (const auto& [v, cost_v] : candidates_[t1]) {
      const double g1 = removed - cost_v;
      if (g1 <= tolerance_) break;
      if (v == t2) continue;
      const int u = previous(v);
      const double g2 = g1 + costs_(u, v);
      const int at_v = offset(v, t2);
      for (const auto& [y, cost_y] : candidates_[u]) {
        const double g3 = g2 - cost_y;
        if (g3 <= tolerance_) break;
        if (offset(y, t2) <= at_v) continue;
        const int x = previous(y);
        const double open = g3 + costs_(x, y);
        const double gain = open - costs_(x, t2);
        if (gain > best_gain) best_gain = gain, best = {v, y, open};
      }
    }
    if (best.v >= 0) {
      carry_out(t2, best);
      keep(best_gain);
      return true;
    }
    return improve_by_two_steps(t1, t2, removed);
  }

  /// Five arcs and more, and double bridges.
  bool improve_by_two_steps(int t1, int t2, double removed) {
    Step deep_first, deep_second;
    double deepest = tolerance_;
    for (const auto& [v, cost_v] : candidates_[t1]) {
      const double g1 = removed - cost_v;
      if (g1 <= tolerance_) break;
      if (v == t2) continue;
      const int u = previous(v);
      const double g2 = g1 + costs_(u, v);
      const int at_v = offset(v, t2);
      const double split_gain = g2 - costs_(u, t2);
      if (split_gain > tolerance_ && join_cycles(t2, v, split_gain)) return true;
      for (const auto& [y, cost_y] : candidates_[u]) {
        const double g3 = g2 - cost_y;
        if (g3 <= tolerance_) break;
        const int at_y = offset(y, t2);
        if (at_y <= at_v) continue;
        const int x = previous(y);
        const double open = g3 + costs_(x, y);
        // The path as it would be: t2 … u | y … t1 | v … x.
        const auto place_of = [&](int t) {
          const int o = offset(t, t2);
          return o < at_v ? o : o < at_y ? o + n_ - at_y : o - at_y + at_v;
        };
        for (const auto& [v2, cost_v2] : candidates_[x]) {
          const double h1 = open - cost_v2;
          if (h1 <= tolerance_) break;
          if (v2 == t2 || v2 == y || v2 == v) continue;
          const int u2 = previous(v2);  // v2 ≠ v, y, so the arc into it is one of the old tour
          const double h2 = h1 + costs_(u2, v2);
          const int at_v2 = place_of(v2);
          for (const auto& [y2, cost_y2] : candidates_[u2]) {
            const double h3 = h2 - cost_y2;
            if (h3 <= tolerance_) break;
            if (y2 == v || y2 == y || place_of(y2) <= at_v2) continue;
            const int x2 = previous(y2);
            const double open2 = h3 + costs_(x2, y2);
            const double gain = open2 - costs_(x2, t2);
            if (gain > tolerance_) {
              carry_out(t2, {v, y, open});
              carry_out(t2, {v2, y2, open2});
              keep(gain);
              return true;
            }
            if (open2 > deepest) {
              deepest = open2;
              deep_first = {v, y, open};
              deep_second = {v2, y2, open2};
            }
          }
        }
      }
    }
    return deep_first.v >= 0 && improve_deeper(t2, deep_first, deep_second);
  }

  /// Goes on from two open steps, the best one each time, until the tour is better or no gain is
  /// left.
  bool improve_deeper(int t2, const Step& first, const Step& second) {
    const std::size_t mark = log_.size();
    touched_.clear();
    heads_.clear();
    carry_out(t2, first);
    carry_out(t2, second);
    double open = second.open_gain;
    for (int depth = 2; depth < kDepth; ++depth) {
      const int t1 = previous(t2);
      Step best;
      double best_gain = tolerance_;
      bool closes = false;
      for (const auto& [v, cost_v] : candidates_[t1]) {
        const double g1 = open - cost_v;
        if (g1 <= tolerance_) break;
        if (v == t2) continue;
        const int u = previous(v);
        if (was_added(v)) continue;
        const double g2 = g1 + costs_(u, v);
        const int at_v = offset(v, t2);
        for (const auto& [y, cost_y] : candidates_[u]) {
          const double g3 = g2 - cost_y;
          if (g3 <= tolerance_) break;
          if (offset(y, t2) <= at_v) continue;
          const int x = previous(y);
          if (was_added(y)) continue;
          const double next_open = g3 + costs_(x, y);
          const double gain = next_open - costs_(x, t2);
          if (gain > tolerance_ ? (!closes || gain > best_gain)
                                : (!closes && next_open > best_gain)) {
            closes = gain > tolerance_;
            best_gain = closes ? gain : next_open;
            best = {v, y, next_open};
          }
        }
      }
      if (best.v < 0) break;
      carry_out(t2, best);
      if (closes) {
        keep(best_gain);
        return true;
      }
      open = best.open_gain;
    }
    rewind(mark);
    touched_.clear();
    return false;
  }
  // Sparing every arc into a head of an added one keeps a chain from undoing itself.
  bool was_added(int head) const {
    return std::find(heads_.begin(), heads_.end(), head) != heads_.end();
  }

  /// The tour would fall into the cycles t2 … u and v … t1; joins them by two other arcs.
  bool join_cycles(int t2, int v, double split_gain) {
    const int at_v = offset(v, t2);
    const bool front_is_short = at_v <= n_ - at_v;
    const int begin = front_is_short ? 0 : at_v;
    const int count = front_is_short ? at_v : n_ - at_v;
    if (count > kLongestCycle) return false;
    const auto in_front = [&](int t) { return offset(t, t2) < at_v; };
    const int u = previous(v), t1 = previous(t2);
    // Removes w → z and x → y, one in each cycle, none of them a new one; adds w → y and x → z.
    double best_gain = tolerance_;
    int best_w = -1, best_y = -1;
    for (int k = 0, p = wrap(position_[t2] + begin); k < count; ++k, p = wrap(p + 1)) {
      const int w = node_[p];
      if (w == u || w == t1) continue;
      const double g = split_gain + costs_(w, next(w));
      for (const auto& [y, cost_y] : candidates_[w]) {
        if (in_front(y) == front_is_short || y == v || y == t2) continue;
        const int x = previous(y);
        const double gain = g - cost_y + costs_(x, y) - costs_(x, next(w));
        if (gain > best_gain) best_gain = gain, best_w = w, best_y = y;
      }
    }
    if (best_w < 0) return false;
    int w = best_w, y = best_y, z = next(w), x = previous(y);
    if (!front_is_short) {
      std::swap(w, x);  // let w → z be the arc of the cycle t2 … u
      std::swap(z, y);
    }
    // t2 … w | z … u | v … x | y … t1 becomes t2 … w | y … t1 | v … x | z … u.
    const int b = offset(v, t2) - offset(z, t2), c = offset(y, t2) - at_v, d = n_ - offset(y, t2);
    for (const int t : {t1, u, w, x, t2, v, z, y}) touched_.push_back(t);
    exchange(position_[z], b, c);
    exchange(position_[v], b + c, d);
    keep(best_gain);
    return true;
  }

  /// Two arcs exchanged, the path between them turned round.
  bool improve_by_reversal(int t1, int t2, double removed) {
    // t1 → v and t2 → next(v): the path t2 … v turns.
    for (const auto& [v, cost_v] : candidates_[t1]) {
      const double g1 = removed - cost_v;
      if (g1 <= tolerance_) break;
      if (v != t2 && turn(t1, t2, v, next(v))) return true;
    }
    for (const auto& [w, cost_w] : candidates_[t2]) {
      const double g1 = removed - cost_w;
      if (g1 <= tolerance_) break;
      if (w != t1 && turn(t1, t2, previous(w), w)) return true;
    }
    return false;
  }
  bool turn(int t1, int t2, int v, int w) {
    const double arcs = costs_(t1, t2) + costs_(v, w) - costs_(t1, v) - costs_(t2, w);
    if (v == t2 || w == t2 || (symmetric_ && arcs <= tolerance_)) return false;
    const double gain = arcs - turn_cost(t2, v);
    if (gain <= tolerance_) return false;
    const int count = offset(v, t2) + 1;
    touched_.assign({t1, t2, v, w});
    if (symmetric_ && count > n_ / 2)
      reverse(position_[w], n_ - count);
    else
      reverse(position_[t2], count);
    keep(gain);
    return true;
  }
  // What reversing the path a … b adds to its inside.
  double turn_cost(int a, int b) const {
    if (symmetric_) return 0.0;
    double sum = 0.0;
    for (int p = position_[a]; node_[p] != b;) {
      const int q = wrap(p + 1);
      sum += costs_(node_[q], node_[p]) - costs_(node_[p], node_[q]);
      p = q;
    }
    return sum;
  }

  static constexpr int kDepth = 6;
  static constexpr int kLongestCycle = 50;

  const CostMatrix& costs_;
  const CandidateArcs& candidates_;
  int n_;
  double tolerance_;
  bool reversals_;
  bool symmetric_;
  std::vector<int> node_, position_;
  std::vector<char> queued_;
  std::vector<int> buffer_;
  std::vector<int> queue_, touched_, heads_;
  std::size_t head_ = 0;
  std::vector<Change> log_;
  double length_ = 0.0, committed_ = 0.0;
};

/// A greedy tour along arcs of small reduced cost.
inline std::vector<int> priced_neighbour_cycle(const CostMatrix& costs, const Assignment& dual,
                                               int first) {
  const int n = costs.size();
  CostMatrix reduced(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      reduced(i, j) = costs(i, j) - dual.row_price[i] - dual.column_price[j];
  return nearest_neighbour_cycle(reduced, first);
}

/// Feasible prices of the assignment relaxation by row and column minima: a weaker bound.
inline Assignment reduced_prices(const CostMatrix& costs) {
  const int n = costs.size();
  Assignment dual;
  dual.row_price.assign(n, std::numeric_limits<double>::infinity());
  dual.column_price.assign(n, std::numeric_limits<double>::infinity());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j) dual.row_price[i] = std::min(dual.row_price[i], costs(i, j));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j)
        dual.column_price[j] = std::min(dual.column_price[j], costs(i, j) - dual.row_price[i]);
  for (int i = 0; i < n; ++i) dual.cost += dual.row_price[i] + dual.column_price[i];
  return dual;
}
}  // namespace detail

/// Iterated Lin–Kernighan: descend, perturb a short stretch of the tour, keep what is not worse.
///
/// Stops early when the tour meets the assignment bound, which proves it optimal. Up to eight
/// nodes are solved exactly. Preparation O(n³) (in practice nearer n²) for the bound, O(n² log n)
/// for the candidates; an iteration costs some microseconds at a few hundred nodes.
struct LinKernighan {
  TourSearch search{};
  int candidates = 6;        ///< Arcs out of a node by reduced cost; some more join by cost.
  int longest_kick = 30;     ///< Nodes in each of the segments that a perturbation exchanges.
  bool quick_bound = false;  ///< Bound and candidates from row and column minima, in O(n²).

  Tour operator()(const TourProblem& problem) const { return solve(problem, {}); }
  /// From `initial`, a tour of the problem, which the result is never worse than.
  Tour operator()(const TourProblem& problem, std::span<const int> initial) const {
    return solve(problem, initial);
  }

 private:
  Tour solve(const TourProblem& problem, std::span<const int> initial) const {
    require(candidates >= 1 && longest_kick >= 1,
            "Lin-Kernighan: candidates and longest_kick must be at least 1");
    const detail::SearchClock clock(search.time_limit_s);
    const detail::CycleProblem cycle = detail::cycle_problem(problem);
    const CostMatrix& costs = cycle.costs;
    const int n = costs.size();
    if (n <= 8) {
      std::vector<int> order = detail::held_karp(costs);
      const double length = detail::cycle_length(costs, order);
      return detail::to_tour(problem, std::move(order), length);
    }
    const Assignment dual =
        quick_bound ? detail::reduced_prices(costs) : detail::cycle_relaxation(costs);
    const detail::CandidateArcs arcs(costs, dual, candidates, (candidates + 1) / 2);
    const bool symmetric = costs.symmetric();
    detail::LinKernighanSearch tour(costs, arcs, symmetric || nearly_symmetric(costs), symmetric);
    Random random(search.seed);
    tour.set(initial.empty() ? detail::priced_neighbour_cycle(costs, dual, 0)
                             : detail::to_cycle(problem, cycle, initial));
    std::vector<int> all = tour.cycle();
    random.shuffle(all);
    for (const int node : all) tour.enqueue(node);
    tour.descend();
    tour.commit();
    const double proven = dual.cost + n * tour.tolerance();
    for (std::int64_t i = 0; i < search.max_iterations; ++i) {
      if (tour.length() <= proven || (i % 16 == 0 && clock.expired())) break;
      const double before = tour.length();
      tour.kick(random, longest_kick);
      tour.descend();
      if (tour.length() <= before + tour.tolerance())
        tour.commit();
      else
        tour.undo();
    }
    return detail::to_tour(problem, tour.cycle(), dual.cost);
  }

  static bool nearly_symmetric(const CostMatrix& costs) {
    double difference = 0.0, spread = 0.0, mean = 0.0;
    const int n = costs.size();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i != j) mean += costs(i, j);
    mean /= static_cast<double>(n) * (n - 1);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        if (i == j) continue;
        difference += std::abs(costs(i, j) - costs(j, i));
        spread += std::abs(costs(i, j) - mean);
      }
    }
    return difference < 0.2 * spread;
  }
};
static_assert(WarmStartedTourSolver<LinKernighan>);
}  // namespace surfleet
