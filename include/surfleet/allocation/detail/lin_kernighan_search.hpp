// SPDX-License-Identifier: MIT
/// @file
/// @brief The local search of the Lin–Kernighan heuristic for asymmetric tours.
///
/// A step exchanges two neighbouring segments of the tour, which changes three arcs and turns no
/// arc round [Kanellakis & Papadimitriou 1980]. Steps are chained while the partial gain stays
/// positive; the first two (five arcs) are searched exhaustively among the candidate arcs, the rest
/// greedily. Where costs are nearly symmetric, reversals are tried as well.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <surfleet/allocation/detail/candidate_arcs.hpp>
#include <surfleet/allocation/detail/segment_tour.hpp>
#include <surfleet/allocation/three_opt.hpp>
#include <surfleet/allocation/tour.hpp>
#include <surfleet/core/random.hpp>

namespace surfleet::detail {
/// A closed tour, its local search and its perturbations.
class LinKernighanSearch : private SegmentTour {
 public:
  LinKernighanSearch(const CostMatrix& costs, const CandidateArcs& candidates, bool reversals,
                     bool symmetric)
      : SegmentTour(costs.size()),
        costs_(costs),
        candidates_(candidates),
        tolerance_(std::max(gain_tolerance(costs), 1e-300)),
        reversals_(reversals),
        symmetric_(symmetric),
        queued_(costs.size(), 0) {}

  void set(std::vector<int> cycle) {
    SegmentTour::set(std::move(cycle));
    length_ = cycle_length(costs_, SegmentTour::cycle());
  }
  using SegmentTour::cycle;
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
    longest = std::min(longest, (size() - 2) / 3);
    const auto length = [&] {
      return 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(longest)));
    };
    const int b = length(), c = length(), d = length();
    const int from = static_cast<int>(random.below(static_cast<std::uint64_t>(size())));
    const int a_last = at(wrap(from + size() - 1)), b_first = at(from),
              b_last = at(wrap(from + b - 1)), c_first = at(wrap(from + b)),
              c_last = at(wrap(from + b + c - 1)), d_first = at(wrap(from + b + c)),
              d_last = at(wrap(from + b + c + d - 1)), a_first = at(wrap(from + b + c + d));
    length_ += costs_(a_last, d_first) + costs_(d_last, c_first) + costs_(c_last, b_first) +
               costs_(b_last, a_first) - costs_(a_last, b_first) - costs_(b_last, c_first) -
               costs_(c_last, d_first) - costs_(d_last, a_first);
    exchange(from, b, c);
    exchange(position(c_first), b + c, d);
    for (const int t : {a_last, b_last, c_last, d_last, a_first, b_first, c_first, d_first})
      enqueue(t);
  }

  /// Forgets how the tour came about: `undo` will return here.
  void commit() {
    forget();
    committed_ = length_;
  }
  void undo() {
    rewind(0);
    length_ = committed_;
  }

 private:
  // One step of a chain. The arc t1 → t2 is open: the tour is a path from t2 to t1. The step adds
  // t1 → v, removes u → v, adds u → y and removes x → y, with y behind v: the path becomes
  // t2 … u, y … t1, v … x, and x is its new end.
  struct Step {
    int v = -1, y = -1;
    double open_gain = 0.0;  // before the closing arc x → t2
  };
  void carry_out(int t2, const Step& s) {
    const int u = previous(s.v), x = previous(s.y), t1 = previous(t2);
    const int v_to_x = offset(s.y, t2) - offset(s.v, t2);
    const int y_to_t1 = size() - offset(s.y, t2);
    exchange(position(s.v), v_to_x, y_to_t1);
    for (const int t : {t1, u, x, t2, s.v, s.y}) touched_.push_back(t);
    heads_.push_back(s.v);
    heads_.push_back(s.y);
  }
  /// Calls `use(step, gain)` for the steps from the path t2 … t1 that keep a partial gain, `open`
  /// being that so far and `gain` what closing the tour after the step leaves of it. Arcs into
  /// heads that are `spared(head)` are not removed.
  template <typename Spared, typename Use>
  void for_each_step(int t1, int t2, double open, const Spared& spared, const Use& use) const {
    for (const auto& [v, cost_v] : candidates_[t1]) {
      const double g1 = open - cost_v;
      if (g1 <= tolerance_) break;
      if (v == t2 || spared(v)) continue;
      const int u = previous(v);
      const double g2 = g1 + costs_(u, v);
      const int at_v = offset(v, t2);
      for (const auto& [y, cost_y] : candidates_[u]) {
        const double g3 = g2 - cost_y;
        if (g3 <= tolerance_) break;
        if (offset(y, t2) <= at_v || spared(y)) continue;
        const int x = previous(y);
        const double next_open = g3 + costs_(x, y);
        use(Step{v, y, next_open}, next_open - costs_(x, t2));
      }
    }
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
    for_each_step(
        t1, t2, removed, [](int) { return false; },
        [&](const Step& step, double gain) {
          if (gain > best_gain) best_gain = gain, best = step;
        });
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
          return o < at_v ? o : o < at_y ? o + size() - at_y : o - at_y + at_v;
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
    const std::size_t mark = changes();
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
      for_each_step(
          t1, t2, open, [this](int head) { return was_added(head); },
          [&](const Step& step, double gain) {
            if (gain > tolerance_ ? (!closes || gain > best_gain)
                                  : (!closes && step.open_gain > best_gain)) {
              closes = gain > tolerance_;
              best_gain = closes ? gain : step.open_gain;
              best = step;
            }
          });
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
    const bool front_is_short = at_v <= size() - at_v;
    const int begin = front_is_short ? 0 : at_v;
    const int count = front_is_short ? at_v : size() - at_v;
    if (count > kLongestCycle) return false;
    const auto in_front = [&](int t) { return offset(t, t2) < at_v; };
    const int u = previous(v), t1 = previous(t2);
    // Removes w → z and x → y, one in each cycle, none of them a new one; adds w → y and x → z.
    double best_gain = tolerance_;
    int best_w = -1, best_y = -1;
    for (int k = 0, p = wrap(position(t2) + begin); k < count; ++k, p = wrap(p + 1)) {
      const int w = at(p);
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
    const int b = offset(v, t2) - offset(z, t2), c = offset(y, t2) - at_v,
              d = size() - offset(y, t2);
    for (const int t : {t1, u, w, x, t2, v, z, y}) touched_.push_back(t);
    exchange(position(z), b, c);
    exchange(position(v), b + c, d);
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
    if (symmetric_ && count > size() / 2)
      reverse(position(w), size() - count);
    else
      reverse(position(t2), count);
    keep(gain);
    return true;
  }
  // What reversing the path a … b adds to its inside.
  double turn_cost(int a, int b) const {
    if (symmetric_) return 0.0;
    double sum = 0.0;
    for (int p = position(a); at(p) != b;) {
      const int q = wrap(p + 1);
      sum += costs_(at(q), at(p)) - costs_(at(p), at(q));
      p = q;
    }
    return sum;
  }

  static constexpr int kDepth = 6;
  static constexpr int kLongestCycle = 50;

  const CostMatrix& costs_;
  const CandidateArcs& candidates_;
  double tolerance_;
  bool reversals_;
  bool symmetric_;
  std::vector<char> queued_;
  std::vector<int> queue_, touched_, heads_;
  std::size_t head_ = 0;
  double length_ = 0.0, committed_ = 0.0;
};
}  // namespace surfleet::detail
