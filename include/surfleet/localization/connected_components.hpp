// SPDX-License-Identifier: MIT
/// @file
/// @brief Connected pixels brighter than a threshold.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/localization/image_thresholds.hpp>

namespace surfleet {
/// Pixels u in [begin, end) of row v.
struct PixelRun {
  int v = 0, begin = 0, end = 0;
};

/// Pixels that touch, by sides or corners.
struct PixelComponent {
  std::vector<PixelRun> runs;  ///< By rows, then from the left.
  PixelWindow box;
  int area = 0;  ///< [px]
};

/// The components of pixels of `window` brighter than `threshold`, by the row and column of their
/// first pixel. O(pixels + runs).
inline std::vector<PixelComponent> connected_components(const GreyImage& image,
                                                        const PixelWindow& window, int threshold) {
  std::vector<PixelRun> runs;
  DisjointSets sets;
  std::size_t before = 0, before_end = 0;  // the runs of the row above
  for (int v = window.top; v < window.bottom; ++v) {
    const std::uint8_t* row = image.row(v);
    const std::size_t start = runs.size();
    int u = window.left;
    while (u < window.right) {
      // Eight at a time where nothing is bright, as nearly everywhere.
      while (u + 8 <= window.right) {
        bool any = false;
        for (int k = 0; k < 8; ++k) any |= row[u + k] > threshold;
        if (any) break;
        u += 8;
      }
      while (u < window.right && row[u] <= threshold) ++u;
      if (u >= window.right) break;
      const int begin = u;
      while (u < window.right && row[u] > threshold) ++u;
      sets.add();
      runs.push_back({v, begin, u});
    }
    std::size_t above = before;
    for (std::size_t i = start; i < runs.size(); ++i) {
      while (above < before_end && runs[above].end < runs[i].begin) ++above;
      for (std::size_t k = above; k < before_end && runs[k].begin <= runs[i].end; ++k)
        sets.unite(static_cast<std::int32_t>(i), static_cast<std::int32_t>(k));
    }
    before = start;
    before_end = runs.size();
  }
  std::vector<PixelComponent> components;
  std::vector<std::size_t> index(runs.size());
  const std::vector<std::int32_t>& first = sets.flattened();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto r = static_cast<std::size_t>(first[i]);
    const PixelRun& run = runs[i];
    if (r == i) {
      index[i] = components.size();
      components.push_back({{}, {run.begin, run.v, run.end, run.v + 1}, 0});
    }
    PixelComponent& c = components[index[r]];
    c.runs.push_back(run);
    c.area += run.end - run.begin;
    c.box = {std::min(c.box.left, run.begin), c.box.top, std::max(c.box.right, run.end), run.v + 1};
  }
  return components;
}
}  // namespace surfleet
