// SPDX-License-Identifier: MIT
/// @file
/// @brief From a raw cloud to the tokens that planners use: two rounds of sparse voting with a
/// reduction between them [004 §8.2.2], and which of them lie on an edge.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/surface/creases.hpp>
#include <surfleet/surface/sheet_tokens.hpp>
#include <surfleet/surface/tensor_voting.hpp>

namespace surfleet {
/// How the first round infers orientation and edges are told.
enum class FirstRound {
  balls,  ///< As printed: balls vote; an edge has a plate share above λ_edge after round two.
  sheets  ///< Points moved onto their sheet; an edge is a crease within half a scale.
};

struct CloudTokenOptions {
  double scale = 0.06;  ///< σ [m].
  double mask = 0.5;    ///< β: no two tokens nearer than β σ.
  /// λ_edge: least (λ₂ − λ₃) / λ₁ of an edge, of votes (balls: 0.25) or of normals (sheets).
  double edge_threshold = 0.06;
  double edge_width = 0.45;  ///< Greatest distance of an edge token from its crease [scales].
  FirstRound first = FirstRound::sheets;
  int threads = 1;
};

/// A place on an edge and the edge's direction there, of either sign.
struct EdgePoint {
  Point3 position = Point3::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
};

/// Tokens, for each whether it lies on an edge, and places on the edges: of creases the points
/// nearest to tokens within a scale of them, else the edge tokens' own.
struct CloudTokens {
  std::vector<Token> tokens;
  std::vector<std::uint8_t> edge;
  std::vector<EdgePoint> edge_points;
};

/// Reduced and refined tokens of a cloud: saliencies are those of the second round. The same for
/// any number of threads. O(n k). Throws `Error` for points that are not finite or settings out of
/// range.
inline CloudTokens cloud_tokens(std::span<const Point3> points,
                                const CloudTokenOptions& options = {}) {
  require(options.edge_threshold >= 0.0 && options.edge_threshold <= 1.0,
          "cloud tokens: expected an edge threshold of 0 to 1");
  require(options.edge_width >= 0.0, "cloud tokens: expected an edge width of 0 or more");
  const TensorVoting<> vote{{options.scale, options.mask, options.threads}, {}};
  const bool sheets = options.first == FirstRound::sheets;
  const std::vector<Token> first =
      sheets ? SheetTokens{.scale = options.scale, .threads = options.threads}(points)
             : vote.balls(points);
  // A sheet's saliency is a share, not a strength, and low at creases: there, spacing is what
  // counts.
  std::vector<std::size_t> reduced;
  if (sheets) {
    std::vector<Point3> moved;
    for (const Token& t : first) moved.push_back(t.position);
    reduced = evenly_spaced(moved, options.mask * options.scale);
  } else {
    reduced = vote.reduced(first);
  }
  std::vector<Token> kept;
  for (const std::size_t i : reduced) kept.push_back(first[i]);
  CloudTokens result;
  if (sheets) {
    std::vector<Eigen::Vector3d> normals;
    const SheetTokens raw{
        .scale = options.scale, .reach = 2.0, .rounds = 1, .threads = options.threads};
    for (const Token& t : raw(points)) normals.push_back(t.normal);
    const auto creases =
        CreaseFinder{.scale = options.scale, .threads = options.threads}(points, normals, reduced);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const Crease& crease = creases[k];
      const bool at_edge = crease.share > options.edge_threshold &&
                           crease.distance <= options.edge_width * options.scale;
      result.edge.push_back(at_edge ? 1 : 0);
      if (crease.share > options.edge_threshold && crease.distance <= options.scale)
        result.edge_points.push_back({crease.nearest, crease.tangent});
      // Beside a crease its own sheet is not what all neighbours together make.
      if (crease.share <= options.edge_threshold / 2.0) continue;
      kept[k].normal = crease.normal;
      kept[k].position = points[reduced[k]] + crease.offset * crease.normal;
      kept[k].tangent = crease.tangent;
    }
  }
  std::vector<Point3> at;
  for (const Token& t : kept) at.push_back(t.position);
  result.tokens = vote.sticks_and_plates(kept, at);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (sheets) {
      result.tokens[k].normal = kept[k].normal;
      result.tokens[k].tangent = kept[k].tangent;
    } else {
      const Token& t = result.tokens[k];
      result.edge.push_back(t.plate_share() > options.edge_threshold ? 1 : 0);
      if (result.edge.back() != 0) result.edge_points.push_back({t.position, t.tangent});
    }
  }
  return result;
}
}  // namespace surfleet
