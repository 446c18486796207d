// SPDX-License-Identifier: MIT
/// @file
/// @brief Vector fields that lead a robot along a strip to a goal in its last triangle [004
/// §7.2.3].
///
///     const StripField field(mesh, strip.triangles, goal);    // eq. 7.1
///     const Eigen::Vector3d u = field(place, at.weights);     // where to, on the surface
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/strip_path.hpp>
#include <surfleet/surface/surface_point.hpp>
#include <surfleet/surface/triangle_strip.hpp>

namespace surfleet {
/// Lays a field into a strip: `prepare` once, then `field(place, weights)` in the plane,
/// at most about 1 long.
///
/// At every inner point of a place that has an exit it must lead on towards it, and nowhere out of
/// the strip, so that any robot that follows it leaves every place by its exit. `step` is how far
/// it can be followed straight without losing that [m].
template <typename F>
concept StripFieldPolicy = requires(F& field, const F& ready, const TriangleMesh& mesh,
                                    const UnfoldedStrip& strip, const Point2& goal,
                                    std::size_t place, const Eigen::Vector3d& weights) {
  field.prepare(mesh, strip, goal);
  { ready(place, weights) } -> std::convertible_to<Point2>;
  { ready.breaks() } -> std::convertible_to<std::size_t>;
};

namespace detail {
inline double least_height(const std::array<Point2, 3>& c) {
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (c[(k + 1) % 3] - c[k]).norm());
  return std::abs(cross2(c[1] - c[0], c[2] - c[0])) / longest;
}
/// From the goal to the farthest corner of its triangle.
inline double farthest_corner(const std::array<Point2, 3>& corners, const Point2& goal) {
  double far = 0.0;
  for (const Point2& c : corners) far = std::max(far, (goal - c).norm());
  return far;
}
}  // namespace detail

/// Eq. 7.1: a vector at every corner, interpolated by area.
///
/// A corner's vector crosses each inner edge at the corner forward and no border outward. Then each
/// place is left through its exit in bounded time, as all three of its vectors have a part along
/// the exit's normal. One vector serves all places about a vertex, and the field is continuous
/// there, where the angle from the vertex's first border edge to its last inner edge is less than
/// π; elsewhere every place takes its own, which is a break. Among the directions allowed the one
/// nearest to that of the strip's shortest path is taken.
class ContinuousField {
 public:
  /// How far vectors keep from the inner edges they cross, as a share of the angle allowed.
  double margin = 0.15;

  void prepare(const TriangleMesh& mesh, const UnfoldedStrip& strip, const Point2& goal) {
    const Point2 none = Point2::Zero();
    vectors_.assign(strip.size(), {none, none, none});
    height_.clear();
    for (const auto& c : strip.corners) height_.push_back(detail::least_height(c));
    breaks_ = shared_ = 0;
    const std::size_t last = strip.size() - 1;
    const double far = detail::farthest_corner(strip.corners[last], goal);
    for (std::size_t k = 0; k < 3; ++k)
      vectors_[last][k] =
          far > 0.0 ? Point2((goal - strip.corners[last][k]) / far) : Point2(Point2::Zero());
    const std::vector<Point2> wanted = directions(mesh, strip, goal);
    for (std::size_t i = 0; i < last; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const Point2 at = strip.corners[i][k];
        // The run of places about this corner, seen from its first.
        if (i > 0 && before(strip, i, k)) continue;
        std::size_t end = i;
        std::vector<int> corner{static_cast<int>(k)};
        while (end < last) {
          const auto c = static_cast<std::size_t>(corner.back());
          const auto out = static_cast<std::size_t>(strip.exit[end]);
          if (c != out && c != (out + 1) % 3) break;
          corner.push_back(corner_at(strip.corners[end + 1], at));
          ++end;
        }
        set_run(strip, i, corner, wanted);
      }
  }
  Point2 operator()(std::size_t place, const Eigen::Vector3d& weights) const {
    const auto& w = vectors_[place];
    return weights[0] * w[0] + weights[1] * w[1] + weights[2] * w[2];
  }
  /// At a border the field's outward part is 0 or less, and a height away at most 1: half of the
  /// least height never leads over it.
  double step(std::size_t place, const Eigen::Vector3d&) const { return 0.5 * height_[place]; }
  /// Vertices of the strip at which the field jumps from one place to the next.
  std::size_t breaks() const { return breaks_; }
  /// Vertices between two or more places that share one vector.
  std::size_t shared() const { return shared_; }
  /// The vector at a corner of a place.
  const Point2& vector(std::size_t place, std::size_t corner) const {
    return vectors_[place][corner];
  }

 private:
  /// Whether the place before i has this corner too.
  static bool before(const UnfoldedStrip& strip, std::size_t i, std::size_t k) {
    if (strip.entry[i] < 0) return false;
    const auto e = static_cast<std::size_t>(strip.entry[i]);
    return k == e || k == (e + 1) % 3;
  }
  /// The corner at `at`: exact, as neighbouring places have their edge in common.
  static int corner_at(const std::array<Point2, 3>& corners, const Point2& at) {
    return corners[0] == at ? 0 : corners[1] == at ? 1 : 2;
  }
  /// For every place the direction of the shortest path as it leaves it.
  static std::vector<Point2> directions(const TriangleMesh& mesh, const UnfoldedStrip& strip,
                                        const Point2& goal) {
    // From the middle of the first place.
    const Point2 start = strip.flat(0, Eigen::Vector3d::Constant(1.0 / 3.0));
    const auto corners = strip_corners(mesh, strip, start, goal);
    std::vector<Point2> result(strip.size());
    std::size_t next = 0;
    Point2 from = start;
    for (std::size_t i = 0; i < strip.size(); ++i) {
      while (next < corners.size() && corners[next].gate < i) from = corners[next++].at;
      const Point2 to = next < corners.size() ? corners[next].at : goal;
      result[i] = to != from ? Point2((to - from).normalized())
                             : (i > 0 ? result[i - 1] : Point2(1.0, 0.0));
    }
    return result;
  }

  /// Angles are measured about the corner from the first edge, in the sense in which the run turns.
  void set_run(const UnfoldedStrip& strip, std::size_t first, const std::vector<int>& corner,
               const std::vector<Point2>& wanted) {
    const std::size_t n = corner.size(), last = strip.size() - 1;
    const auto& head = strip.corners[first];
    const auto c = static_cast<std::size_t>(corner[0]);
    const auto out = static_cast<std::size_t>(strip.exit[first]);
    const Point2 at = head[c];
    // The first edge is the one that is no exit; it is a border, as the run begins here.
    const std::size_t beyond = out == c ? (c + 2) % 3 : (c + 1) % 3;
    const Point2 e0 = head[beyond] - at;
    std::vector<double> edge{0.0};  // angles of the run's edges from e0, growing
    const std::size_t other = n == 1 ? (c + 2) % 3 : (out == c ? (c + 1) % 3 : (c + 2) % 3);
    const double sense = cross2(e0, head[other] - at) >= 0.0 ? 1.0 : -1.0;
    for (std::size_t j = 0; j < n; ++j) {
      const auto& p = strip.corners[first + j];
      const auto k = static_cast<std::size_t>(corner[j]);
      const Point2 u = p[(k + 1) % 3] - at, v = p[(k + 2) % 3] - at;
      edge.push_back(edge.back() + std::atan2(std::abs(cross2(u, v)), u.dot(v)));
    }
    const auto vector_at = [&](double angle) {
      const double a = std::atan2(e0.y(), e0.x()) + sense * angle;
      return Point2(std::cos(a), std::sin(a));
    };
    const auto angle_of = [&](const Point2& d, double near) {
      const double a = sense * std::atan2(cross2(e0, d), e0.dot(d));
      return a + 2.0 * kPi * std::round((near - a) / (2.0 * kPi));
    };
    const auto choose = [&](double low, double high, const Point2& direction) {
      const double keep = margin * (high - low);
      const double middle = 0.5 * (low + high);
      return vector_at(std::clamp(angle_of(direction, middle), low + keep, high));
    };
    const bool ends_at_goal = first + n - 1 == last;
    const std::size_t inner = n - 1;  // inner edges: edge[1] … edge[inner]
    const Point2 direction = wanted[std::min(first + n / 2, wanted.size() - 1)];
    if (inner == 0) {
      vectors_[first][c] = choose(edge[0], edge[1], direction);
      return;
    }
    // Across every inner edge and out over neither border: (edge[inner], min(π, edge.back())].
    const double low = edge[inner], high = std::min(kPi, edge.back());
    bool share = low < kPi - 1e-9;
    Point2 common = Point2::Zero();
    if (ends_at_goal) {
      const Point2& w = vectors_[last][static_cast<std::size_t>(corner.back())];
      const double a = w.norm() > 0.0 ? angle_of(w, 0.5 * (low + high)) : -1.0;
      share = share && a > low + 1e-9 && a <= high;
      common = w;
    } else if (share) {
      common = choose(low, high, direction);
    }
    if (share) {
      ++shared_;
      for (std::size_t j = 0; j < n; ++j)
        vectors_[first + j][static_cast<std::size_t>(corner[j])] = common;
      return;
    }
    ++breaks_;
    for (std::size_t j = 0; j < n; ++j) {
      if (first + j == last) break;
      // Forward over the edges of this place alone: in by edge[j], out by edge[j + 1].
      // the last one not over the border.
      const double from = j + 1 == n ? edge[j] : edge[j + 1];
      const double to = j + 1 == n ? edge[n] : from + (1.0 - margin) * (edge[j] + kPi - from);
      vectors_[first + j][static_cast<std::size_t>(corner[j])] =
          choose(from, to, wanted[first + j]);
    }
  }

  std::vector<std::array<Point2, 3>> vectors_;
  std::vector<double> height_;  // the least of every place [m]
  std::size_t breaks_ = 0, shared_ = 0;
};
static_assert(StripFieldPolicy<ContinuousField>);

/// A field perpendicular to every inner edge where it crosses it, in the manner of Lindemann and
/// LaValle (2005): for steps that must be climbed squarely.
///
/// Between entry and exit it circles about the corner they have in common; near the border it heads
/// for the middle of the exit. Either way the angle about that corner grows. The first place heads
/// for the middle of its exit, the last for the goal. Continuous inside every place and over inner
/// edges, corners apart.
class PerpendicularField {
 public:
  void prepare(const TriangleMesh&, const UnfoldedStrip& strip, const Point2& goal) {
    strip_ = strip;
    goal_ = goal;
  }
  std::size_t breaks() const { return 0; }
  /// Short near the ends of the border, where the field turns on the spot.
  double step(std::size_t place, const Eigen::Vector3d& weights) const {
    const auto& c = strip_.corners[place];
    const double height = detail::least_height(c),
                 area = std::abs(cross2(c[1] - c[0], c[2] - c[0]));
    std::array<double, 3> distance{};  // to the side opposite each corner
    for (std::size_t k = 0; k < 3; ++k)
      distance[k] =
          weights[static_cast<Eigen::Index>(k)] * area / (c[(k + 2) % 3] - c[(k + 1) % 3]).norm();
    std::sort(distance.begin(), distance.end());
    return std::clamp(0.3 * (distance[0] + distance[1]), 1e-9 * height, 0.3 * height);
  }
  Point2 operator()(std::size_t place, const Eigen::Vector3d& weights) const {
    const auto& c = strip_.corners[place];
    const Point2 p = weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
    const int in = strip_.entry[place], out = strip_.exit[place];
    if (in < 0 && out < 0) return capped(goal_ - p, place);
    // Distance to side k, and the unit normal of side k into the place.
    const auto inward = [&](int k) {
      const Point2 a = c[static_cast<std::size_t>(k)],
                   along = c[static_cast<std::size_t>((k + 1) % 3)] - a;
      const Point2 n = Point2(-along.y(), along.x()).normalized();
      return n.dot(c[static_cast<std::size_t>((k + 2) % 3)] - a) < 0.0 ? Point2(-n) : n;
    };
    const auto distance = [&](int k) {
      return std::max(0.0, inward(k).dot(p - c[static_cast<std::size_t>(k)]));
    };
    const auto share = [](double inner, double border) {
      return inner + border > 0.0 ? inner / (inner + border) : 0.5;
    };
    if (out < 0) {  // the last place
      const double deep = inward(in).dot(goal_ - c[static_cast<std::size_t>(in)]);
      const double d = distance(in);
      const double border = std::min(distance((in + 1) % 3), distance((in + 2) % 3));
      const double s = d >= 0.5 * deep ? 1.0 : std::max(2.0 * d / deep, share(d, border));
      return (1.0 - s) * inward(in) + s * capped(goal_ - p, place);
    }
    const double d_out = distance(out);
    if (in < 0) {  // the first
      const Point2 middle =
          0.5 * (c[static_cast<std::size_t>(out)] + c[static_cast<std::size_t>((out + 1) % 3)]);
      const double border = std::min(distance((out + 1) % 3), distance((out + 2) % 3));
      const double s =
          share(std::max(repulsion(c, (out + 1) % 3), repulsion(c, (out + 2) % 3)) * d_out, border);
      return s * (middle - p).stableNormalized() - (1.0 - s) * inward(out);
    }
    const int border = 3 - in - out;
    // The corner of entry and exit is opposite the border.
    const Point2 pivot = c[static_cast<std::size_t>((border + 2) % 3)];
    const Point2 radius = p - pivot;
    Point2 turning = Point2(-radius.y(), radius.x()).stableNormalized();
    // From the entry to the exit.
    if (turning.dot(inward(in)) - turning.dot(inward(out)) < 0.0) turning = -turning;
    if (radius.isZero(0.0)) turning = (inward(in) - inward(out)).stableNormalized();
    const auto o = static_cast<std::size_t>(out);
    const Point2 onward = (0.5 * (c[o] + c[(o + 1) % 3]) - p).stableNormalized();
    const double s = share(repulsion(c, border) * std::min(distance(in), d_out), distance(border));
    return (1.0 - s) * turning + s * onward;
  }

 private:
  /// How much more the border counts than an inner edge. Where it meets the exit at an obtuse angle
  /// γ, 1 − cot γ is enough for the field to turn away from that corner and not into it.
  static double repulsion(const std::array<Point2, 3>& c, int border) {
    double most = 1.0;
    for (int end = 0; end < 2; ++end) {
      const auto k = static_cast<std::size_t>((border + end) % 3);
      const Point2 u = c[(k + 1) % 3] - c[k], v = c[(k + 2) % 3] - c[k];
      most = std::max(most, 1.0 - u.dot(v) / std::abs(cross2(u, v)));
    }
    return most;
  }
  /// Towards the goal, slower in its triangle.
  Point2 capped(const Point2& offset, std::size_t place) const {
    const double far = detail::farthest_corner(strip_.corners[place], goal_);
    return far > 0.0 ? Point2(offset / far) : Point2(Point2::Zero());
  }

  UnfoldedStrip strip_;
  Point2 goal_ = Point2::Zero();
};
static_assert(StripFieldPolicy<PerpendicularField>);

/// A field on a strip of a mesh. It belongs to places in the strip, as a triangle may recur.
template <StripFieldPolicy Field = ContinuousField>
class StripField {
 public:
  /// The mesh must outlive it. `goal` lies in the strip's last triangle, and the strip turns back
  /// nowhere (`split_at_turns`). Throws `Error` otherwise. O(n).
  StripField(const TriangleMesh& mesh, std::span<const std::int32_t> triangles,
             const SurfacePoint& goal, Field policy = {})
      : field(std::move(policy)), mesh_(&mesh), strip_(unfold(mesh, triangles)), goal_(goal) {
    require(!triangles.empty() && triangles.back() == goal.triangle,
            "strip field: expected the goal in the strip's last triangle");
    for (std::size_t i = 0; i < strip_.size(); ++i)
      require(strip_.entry[i] < 0 || strip_.entry[i] != strip_.exit[i],
              "strip field: the strip turns back in a triangle; expected it split there");
    field.prepare(mesh, strip_, strip_.flat(strip_.size() - 1, goal.weights));
  }

  /// The field on the surface: tangent to the triangle of `place`.
  Eigen::Vector3d operator()(std::size_t place, const Eigen::Vector3d& weights) const {
    const Point2 u = field(place, weights);
    const auto& c = strip_.corners[place];
    Eigen::Matrix2d flat;
    flat << c[1] - c[0], c[2] - c[0];
    const double det = flat.determinant();
    const Eigen::Vector2d part((flat(1, 1) * u.x() - flat(0, 1) * u.y()) / det,
                               (flat(0, 0) * u.y() - flat(1, 0) * u.x()) / det);
    const auto t = static_cast<std::size_t>(strip_.triangles[place]);
    return part.x() * (mesh_->corner(t, 1) - mesh_->corner(t, 0)) +
           part.y() * (mesh_->corner(t, 2) - mesh_->corner(t, 0));
  }
  const UnfoldedStrip& strip() const { return strip_; }
  const SurfacePoint& goal() const { return goal_; }
  const TriangleMesh& mesh() const { return *mesh_; }

  Field field;

 private:
  const TriangleMesh* mesh_;
  UnfoldedStrip strip_;
  SurfacePoint goal_;
};

/// A strip cut wherever it leaves a triangle by the edge it came in by: each part ends in that
/// triangle and the next begins there. O(n).
inline std::vector<std::vector<std::int32_t>> split_at_turns(
    std::span<const std::int32_t> triangles) {
  std::vector<std::vector<std::int32_t>> parts(1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    parts.back().push_back(triangles[i]);
    if (i > 0 && i + 1 < triangles.size() && triangles[i - 1] == triangles[i + 1])
      parts.push_back({triangles[i]});
  }
  return parts;
}
}  // namespace surfleet
