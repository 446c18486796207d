// SPDX-License-Identifier: MIT
/// @file
/// @brief Tensor voting in space: surfaces and edges inferred from points [004 §3.4].
///
///     const TensorVoting<> vote{{.scale = 0.06}};
///     auto tokens = vote.refined(cloud.points);     // balls, token reduction, sticks and plates
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/kd_tree.hpp>

namespace surfleet {
/// How a vote fades: `decay(distance, sine)` with the distance in voting scales and the sine of the
/// angle between the voter's tangent plane and the line to the votee; 0 beyond `reach()` scales.
template <typename D>
concept VoteDecay = std::copyable<D> && requires(const D& decay, double z, double sine) {
  { decay(z, sine) } -> std::convertible_to<double>;
  { decay.reach() } -> std::convertible_to<double>;
};

/// King's (2008): greatest one scale away, nothing from three on or past 45°; z²(z − 3)⁴/16 ·
/// cos⁸θ.
struct KingDecay {
  double reach() const { return 3.0; }
  double operator()(double z, double sine) const {
    const double cosine2 = 1.0 - sine * sine;
    if (!(z < 3.0) || cosine2 < 0.5) return 0.0;
    const double far = (z - 3.0) * (z - 3.0);
    return z * z * far * far / 16.0 * cosine2 * cosine2 * cosine2 * cosine2;
  }
};
/// Exponential in arc length and curvature, after Mordohai and Medioni (2006), free of units.
struct GaussianVoteDecay {
  double curvature = 0.25;  ///< Weight of the squared curvature times scale.
  double reach() const { return 3.0; }
  double operator()(double z, double sine) const {
    if (!(z < 3.0) || sine * sine > 0.5) return 0.0;
    const double angle = std::asin(std::abs(sine));
    const double arc = angle > 1e-9 ? z * angle / std::sin(angle) : z;
    const double bend = z > 0.0 ? 2.0 * std::abs(sine) / z : 0.0;
    return std::exp(-(arc * arc + curvature * bend * bend));
  }
};
static_assert(VoteDecay<KingDecay> && VoteDecay<GaussianVoteDecay>);

/// A place with what was inferred there: eq. 3.13.
struct Token {
  Point3 position = Point3::Zero();
  double stick = 0.0;                                  ///< λ₁ − λ₂: surface saliency.
  double plate = 0.0;                                  ///< λ₂ − λ₃: edge saliency.
  double ball = 0.0;                                   ///< λ₃.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< e₁, of either sign.
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< e₃, of the edge, of either sign.

  /// (λ₂ − λ₃) / λ₁, 0 to 1: high at edges after sticks and plates have voted.
  double plate_share() const {
    const double first = stick + plate + ball;
    return first > 0.0 ? plate / first : 0.0;
  }
};

/// Splits a tensor into stick, plate and ball.
inline Token decomposed(const Point3& position, const Eigen::Matrix3d& tensor) {
  Token token;
  token.position = position;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(tensor);
  // Directly solved eigenvectors lose digits where two values lie close; then again, slowly.
  const Eigen::Vector3d values = solver.eigenvalues();
  if (values[1] - values[0] < 1e-6 * values[2] || values[2] - values[1] < 1e-6 * values[2])
    solver.compute(tensor);
  const Eigen::Vector3d& l = solver.eigenvalues();
  token.stick = std::max(0.0, l[2] - l[1]);
  token.plate = std::max(0.0, l[1] - l[0]);
  token.ball = std::max(0.0, l[0]);
  token.normal = solver.eigenvectors().col(2);
  token.tangent = solver.eigenvectors().col(0);
  return token;
}

/// The vote of a ball: `u` is the unit vector from voter to votee, `z` the distance in scales.
template <VoteDecay Decay>
Eigen::Matrix3d ball_vote(const Decay& decay, const Eigen::Vector3d& u, double z) {
  return decay(z, 0.0) * (Eigen::Matrix3d::Identity() - u * u.transpose());
}
/// The vote of a stick with normal `n`: the normal of the circle that leaves along the surface.
template <VoteDecay Decay>
Eigen::Matrix3d stick_vote(const Decay& decay, const Eigen::Vector3d& n, const Eigen::Vector3d& u,
                           double z) {
  const double sine = n.dot(u);
  const double weight = decay(z, sine);
  if (!(weight > 0.0)) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d turned = n - 2.0 * sine * u;
  return weight * turned * turned.transpose();
}
/// The vote of a plate with tangent `t`.
template <VoteDecay Decay>
Eigen::Matrix3d plate_vote(const Decay& decay, const Eigen::Vector3d& t, const Eigen::Vector3d& u,
                           double z) {
  const Eigen::Vector3d across = u - u.dot(t) * t;
  const double sine = across.norm();  // b₁ · u
  const double weight = decay(z, sine);
  if (!(weight > 0.0)) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d b1 =
      sine > 1e-12 ? Eigen::Vector3d(across / sine) : Eigen::Vector3d(t.unitOrthogonal());
  const Eigen::Vector3d b2 = t.cross(b1), turned = b1 - 2.0 * sine * u;
  return weight * (turned * turned.transpose() + b2 * b2.transpose());
}

struct VotingOptions {
  double scale = 0.06;  ///< σ [m].
  double mask = 0.5;    ///< β of token reduction: no two tokens nearer than β σ.
  int threads = 1;
};

/// Votes, round by round. The same result with any number of threads.
template <VoteDecay Decay = KingDecay>
class TensorVoting {
 public:
  VotingOptions options;
  [[no_unique_address]] Decay decay;

  /// Unit balls at the points vote for each other. A point far from all others gets nothing.
  /// O(n k) with k points in reach. Throws `Error` for a scale that is not positive or points that
  /// are not finite.
  std::vector<Token> balls(std::span<const Point3> points) const {
    check(points);
    return gathered(points, points, [&](std::size_t, const Eigen::Vector3d& u, double z) {
      return ball_vote(decay, u, z);
    });
  }

  /// Tokens' sticks and plates vote at `places`: dense voting on any set of places, sparse voting
  /// where they are the tokens' own. Balls do not vote.
  std::vector<Token> sticks_and_plates(std::span<const Token> tokens,
                                       std::span<const Point3> places) const {
    check(places);
    std::vector<Point3> at;
    for (const Token& t : tokens) at.push_back(t.position);
    return gathered(places, at, [&](std::size_t i, const Eigen::Vector3d& u, double z) {
      const Token& t = tokens[i];
      Eigen::Matrix3d vote = t.stick * stick_vote(decay, t.normal, u, z);
      if (t.plate > 0.0) vote += t.plate * plate_vote(decay, t.tangent, u, z);
      return vote;
    });
  }

  /// The tokens that stay when each, by falling surface saliency, drops the others within β σ, in
  /// ascending order. Ties go to the lower index.
  std::vector<std::size_t> reduced(std::span<const Token> tokens) const {
    require(options.mask >= 0.0, "token reduction: expected a mask of 0 or more");
    std::vector<Point3> at;
    for (const Token& t : tokens) at.push_back(t.position);
    const KdTree tree(at);
    std::vector<std::size_t> order(tokens.size()), kept;
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return tokens[a].stick != tokens[b].stick ? tokens[a].stick > tokens[b].stick : a < b;
    });
    std::vector<std::uint8_t> dropped(tokens.size(), 0);
    for (const std::size_t i : order) {
      if (dropped[i] != 0) continue;
      kept.push_back(i);
      tree.for_each_within(at[i], options.mask * options.scale, [&](const Neighbor& n) {
        dropped[static_cast<std::size_t>(n.index)] = 1;
      });
    }
    std::sort(kept.begin(), kept.end());
    return kept;
  }

  /// A round of balls, token reduction, and a round of sticks and plates among what is left.
  std::vector<Token> refined(std::span<const Point3> points) const {
    const std::vector<Token> first = balls(points);
    std::vector<Token> tokens;
    std::vector<Point3> at;
    for (const std::size_t i : reduced(first)) {
      tokens.push_back(first[i]);
      at.push_back(first[i].position);
    }
    return sticks_and_plates(tokens, at);
  }

 private:
  void check(std::span<const Point3> points) const {
    require(options.scale > 0.0 && std::isfinite(options.scale),
            "tensor voting: expected a scale of more than 0 m");
    for (const Point3& p : points) require(p.allFinite(), "tensor voting: a point is not finite");
  }
  template <typename Vote>
  std::vector<Token> gathered(std::span<const Point3> places, std::span<const Point3> voters,
                              const Vote& vote) const {
    const KdTree tree(voters);
    std::vector<Token> tokens(places.size());
    parallel_for(
        places.size(), options.threads,
        [&](std::size_t i) {
          Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
          tree.for_each_within(places[i], decay.reach() * options.scale, [&](const Neighbor& n) {
            if (!(n.distance2 > 0.0)) return;
            const auto voter = static_cast<std::size_t>(n.index);
            const double d = std::sqrt(n.distance2);
            sum += vote(voter, Eigen::Vector3d((places[i] - voters[voter]) / d), d / options.scale);
          });
          tokens[i] = decomposed(places[i], sum);
        },
        64);
    return tokens;
  }
};
}  // namespace surfleet
