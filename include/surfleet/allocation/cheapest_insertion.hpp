// SPDX-License-Identifier: MIT
/// @file
/// @brief Where candidates would be inserted into an open path at the least cost.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace surfleet {
/// The cheapest place of every candidate in a path that grows by one stop after the other.
///
/// The path has a start, which is its place 0, and n stops after it; leg k leads to stop k, and leg
/// n from the last stop to whoever would come after it. `distance(k, c)` is from place k to
/// candidate c and need not be what the legs were measured by.
class CheapestInsertion {
 public:
  struct Detour {
    double extra = std::numeric_limits<double>::infinity();  ///< What the insertion adds.
    std::size_t leg = 0;                                     ///< Before the stop of this index.
  };

  /// `legs` are the lengths of the path as it is. O(candidates · stops).
  template <typename Distance>
  CheapestInsertion(std::size_t candidates, std::span<const double> legs, Distance&& distance)
      : detours_(candidates) {
    for (std::size_t c = 0; c < candidates; ++c) search(c, legs, distance);
  }

  const Detour& operator[](std::size_t candidate) const { return detours_[candidate]; }

  /// A stop has been inserted in leg `k`, which makes two of it; `legs` are those of the path as it
  /// is now. O(candidates + stops · candidates whose leg it was).
  template <typename Distance>
  void inserted(std::size_t k, std::span<const double> legs, Distance&& distance) {
    for (std::size_t c = 0; c < detours_.size(); ++c) {
      Detour& d = detours_[c];
      if (d.leg == k) {
        d = {};
        search(c, legs, distance);
        continue;
      }
      if (d.leg > k) ++d.leg;
      shorten(c, k, legs, distance);
      shorten(c, k + 1, legs, distance);
    }
  }

 private:
  template <typename Distance>
  void search(std::size_t c, std::span<const double> legs, Distance&& distance) {
    for (std::size_t k = 0; k <= legs.size(); ++k) shorten(c, k, legs, distance);
  }
  template <typename Distance>
  void shorten(std::size_t c, std::size_t k, std::span<const double> legs, Distance&& distance) {
    double extra = distance(k, c);
    if (k < legs.size()) extra += distance(k + 1, c) - legs[k];
    if (extra < detours_[c].extra) detours_[c] = {extra, k};
  }

  std::vector<Detour> detours_;
};
}  // namespace surfleet
