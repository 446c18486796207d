// SPDX-License-Identifier: MIT
/// @file
/// @brief Points moved onto the sheet that runs through their neighbours, with its normal.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/point_moments.hpp>
#include <surfleet/surface/tensor_voting.hpp>

namespace surfleet {
/// The plain round of balls is an uncentred covariance, which mistakes noise across a sheet for
/// directions. This one is centred, with a weight that falls smoothly to nothing at `reach` scales,
/// and moves every point along the normal onto its sheet before the next round.
struct SheetTokens {
  double scale = 0.06;  ///< σ [m].
  double reach = 2.5;   ///< [scales]
  int rounds = 2;
  int threads = 1;

  /// Tokens at the moved points, in the points' order: λ are the shares of variance that a sheet
  /// lacks, normalised so that a flat sheet has stick 1, a line plate 1 and a cloud ball 1. A point
  /// with fewer than three others in reach stays where it is with none. O(n k) a round.
  std::vector<Token> operator()(std::span<const Point3> points) const {
    require(scale > 0.0 && reach > 0.0 && rounds >= 1,
            "sheet tokens: expected a positive scale and reach and one round or more");
    std::vector<Point3> at(points.begin(), points.end());
    for (const Point3& p : at) require(p.allFinite(), "sheet tokens: a point is not finite");
    std::vector<Token> tokens(at.size());
    const double radius = reach * scale;
    for (int round = 0; round < rounds; ++round) {
      const KdTree tree(at);
      parallel_for(
          at.size(), threads,
          [&](std::size_t i) {
            std::size_t count = 0;
            PointMoments moments;
            tree.for_each_within(at[i], radius, [&](const Neighbor& n) {
              const Eigen::Vector3d d = at[static_cast<std::size_t>(n.index)] - at[i];
              const double inside = 1.0 - n.distance2 / (radius * radius);
              const double w = inside * inside;
              moments.add(d, w);
              ++count;
            });
            tokens[i] = Token{};
            tokens[i].position = at[i];
            if (count < 4 || !(moments.weight > 0.0)) return;
            const PrincipalAxes axes(moments.covariance());
            const Eigen::Vector3d& l = axes.values;
            if (!(l[2] > 0.0)) return;
            tokens[i].stick = (l[1] - l[0]) / l[2];
            tokens[i].plate = (l[2] - l[1]) / l[2];
            tokens[i].ball = std::max(0.0, l[0]) / l[2];
            tokens[i].normal = axes.vectors.col(0);
            tokens[i].tangent = axes.vectors.col(2);
            tokens[i].position = at[i] + tokens[i].normal.dot(moments.mean()) * tokens[i].normal;
          },
          64);
      for (std::size_t i = 0; i < at.size(); ++i) at[i] = tokens[i].position;
    }
    return tokens;
  }
};
}  // namespace surfleet
