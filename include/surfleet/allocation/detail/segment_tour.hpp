// SPDX-License-Identifier: MIT
/// @file
/// @brief A closed tour in an array whose segments are exchanged and reversed, and changed back.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace surfleet::detail {
/// Nodes 0 to n − 1 in a cycle. Neighbours in O(1); a change costs the nodes it moves, and is
/// logged so that `rewind` undoes it at the same cost.
class SegmentTour {
 public:
  explicit SegmentTour(int n) : n_(n), position_(n), buffer_(n) {}

  void set(std::vector<int> cycle) {
    node_ = std::move(cycle);
    for (int k = 0; k < n_; ++k) position_[node_[k]] = k;
    log_.clear();
  }
  const std::vector<int>& cycle() const { return node_; }
  int size() const { return n_; }
  /// The node at position `k`, and the position of node `t`.
  int at(int k) const { return node_[k]; }
  int position(int t) const { return position_[t]; }
  int wrap(int k) const { return k < n_ ? k : k - n_; }
  int before(int k) const { return k == 0 ? n_ - 1 : k - 1; }
  int next(int t) const { return node_[wrap(position_[t] + 1)]; }
  int previous(int t) const { return node_[before(position_[t])]; }
  /// Steps from node `from` to node `t`.
  int offset(int t, int from) const {
    const int d = position_[t] - position_[from];
    return d < 0 ? d + n_ : d;
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
  /// Turns the `count` nodes from position `at` round.
  void reverse(int at, int count) {
    log_.push_back({at, count, -1});
    reverse_segment(at, count);
  }
  /// Changes so far, and back to when there were `to` of them.
  std::size_t changes() const { return log_.size(); }
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
  /// Forgets how the tour came about: it cannot be changed back beyond here.
  void forget() { log_.clear(); }

 private:
  struct Change {
    int at, first, second;  // second < 0: a reversal of `first` nodes from `at`
  };
  void place(int k, int t) {
    node_[k] = t;
    position_[t] = k;
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

  int n_;
  std::vector<int> node_, position_;
  std::vector<int> buffer_;
  std::vector<Change> log_;
};
}  // namespace surfleet::detail
