// SPDX-License-Identifier: MIT
/// @file
/// @brief A mesh grown over a cloud triangle by triangle: the fast triangulation (FTM) of
/// [004 §7.2.2] after Marton, Rusu and Beetz (2009).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/scan.hpp>

namespace surfleet {
struct GreedyProjectionOptions {
  std::optional<double> longest_edge = {};  ///< [m]; else 3.5 times the points' median spacing.
  double least_angle = radians(10.0);       ///< In a triangle [rad].
  double greatest_angle = radians(120.0);   ///< Beside the edge grown from [rad].
  double greatest_bend = radians(60.0);     ///< Between a point's normal and its surroundings'.
  double least_part = 0.02;                 ///< Parts with a lesser share of the largest go.
  OrientedCloudOptions cloud = {};
};

namespace detail {
/// The front of a mesh that grows: each open side takes the point that it sees under the widest
/// angle in the plane of its normals, and that no side already there hides.
class GrowingMesh {
 public:
  GrowingMesh(const PointCloud& cloud, double reach, const GreedyProjectionOptions& options)
      : cloud_(cloud),
        tree_(cloud.points),
        reach_(reach),
        options_(options),
        of_point_(cloud.size()),
        open_(cloud.size(), 0) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!of_point_[i].empty()) continue;
      seed(static_cast<std::int32_t>(i));
      grow(false);
    }
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t)
      push_open_sides(t);
    grow(true);
  }
  TriangleMesh mesh() const {
    TriangleMesh whole;
    whole.vertices = cloud_.points;
    whole.normals = cloud_.normals;
    whole.triangles = triangles_;
    return selected(whole, [](std::size_t) { return true; });
  }

 private:
  using Side = std::array<std::int32_t, 2>;
  struct Flat {  // a point near a side, in the plane there
    std::int32_t index;
    Point2 at;
  };

  const Point3& point(std::int32_t i) const { return cloud_.points[static_cast<std::size_t>(i)]; }
  Eigen::Vector3d normal(std::int32_t i) const {
    return cloud_.normals[static_cast<std::size_t>(i)].cast<double>();
  }
  std::vector<std::int32_t>& triangles_of(std::int32_t i) {
    return of_point_[static_cast<std::size_t>(i)];
  }
  /// Whether some triangle has this side, in this direction.
  bool taken(std::int32_t from, std::int32_t to) const {
    for (const std::int32_t t : of_point_[static_cast<std::size_t>(from)]) {
      const Triangle& c = triangles_[static_cast<std::size_t>(t)];
      for (std::size_t k = 0; k < 3; ++k)
        if (c[k] == from && c[(k + 1) % 3] == to) return true;
    }
    return false;
  }
  void add(const Triangle& t) {
    const auto number = static_cast<std::int32_t>(triangles_.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const int change = taken(t[(k + 1) % 3], t[k]) ? -1 : 1;  // closes a side, or opens one
      open_[static_cast<std::size_t>(t[k])] += change;
      open_[static_cast<std::size_t>(t[(k + 1) % 3])] += change;
    }
    triangles_.push_back(t);
    for (const std::int32_t v : t) triangles_of(v).push_back(number);
    push_open_sides(number);
  }
  void push_open_sides(std::int32_t t) {
    const Triangle& c = triangles_[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < 3; ++k)
      if (!taken(c[(k + 1) % 3], c[k])) front_.push_back({c[k], c[(k + 1) % 3]});
  }

  /// The points about a side in a plane: `from` at the origin, `to` on the x axis, and what a new
  /// triangle may use above it. Points of other sheets are not there.
  bool flatten(std::int32_t from, std::int32_t to) {
    const Eigen::Vector3d n = (normal(from) + normal(to)).stableNormalized();
    Eigen::Vector3d x = point(to) - point(from);
    x -= x.dot(n) * n;
    if (!(x.norm() > 1e-12)) return false;
    x.normalize();
    const Eigen::Vector3d y = x.cross(n);  // to the right of the side, as its triangle lies left
    near_.clear();
    const double least = std::cos(options_.greatest_bend);
    tree_.for_each_within(0.5 * (point(from) + point(to)), 1.5 * reach_,
                          [&](const Neighbor& found) {
                            if (normal(found.index).dot(n) < least) return;
                            const Eigen::Vector3d d = point(found.index) - point(from);
                            near_.push_back({found.index, Point2(d.dot(x), d.dot(y))});
                          });
    std::sort(near_.begin(), near_.end(),
              [](const Flat& a, const Flat& b) { return a.index < b.index; });
    return flat(from) != nullptr && flat(to) != nullptr;
  }
  const Flat* flat(std::int32_t i) const {
    const auto found =
        std::lower_bound(near_.begin(), near_.end(), i,
                         [](const Flat& a, std::int32_t index) { return a.index < index; });
    return found != near_.end() && found->index == i ? &*found : nullptr;
  }
  bool hidden(const Flat& a, const Flat& c) const {
    for (const Flat& p : near_)
      for (const std::int32_t t : of_point_[static_cast<std::size_t>(p.index)]) {
        const Triangle& corner = triangles_[static_cast<std::size_t>(t)];
        for (std::size_t k = 0; k < 3; ++k) {
          if (corner[k] != p.index) continue;
          const std::int32_t q = corner[(k + 1) % 3];
          if (p.index == a.index || p.index == c.index || q == a.index || q == c.index) continue;
          const Flat* other = flat(q);
          if (other != nullptr && segments_intersect(a.at, c.at, p.at, other->at)) return true;
        }
      }
    return false;
  }
  bool holds_a_point(const Flat& a, const Flat& b, const Flat& c) const {
    const int orientation = turn(a.at, b.at, c.at);
    for (const Flat& p : near_) {
      if (p.index == a.index || p.index == b.index || p.index == c.index) continue;
      if (orientation * turn(a.at, b.at, p.at) >= 0 && orientation * turn(b.at, c.at, p.at) >= 0 &&
          orientation * turn(c.at, a.at, p.at) >= 0)
        return true;
    }
    return false;
  }

  void grow(bool closing) {
    struct Choice {
      double cosine;  // of the angle under which the side is seen
      const Flat* at;
    };
    std::vector<Choice> choices;
    while (!front_.empty()) {
      const auto [from, to] = front_.front();
      front_.pop_front();
      if (taken(to, from) || !flatten(from, to)) continue;
      const Flat a = *flat(from), b = *flat(to);
      choices.clear();
      for (const Flat& c : near_) {
        const std::int32_t i = c.index;
        if (i == from || i == to || !(c.at.y() > 0.0)) continue;
        const bool used = !of_point_[static_cast<std::size_t>(i)].empty();
        if (used && open_[static_cast<std::size_t>(i)] == 0) continue;
        if (taken(from, i) || taken(i, to)) continue;
        if ((point(i) - point(from)).norm() > reach_ || (point(i) - point(to)).norm() > reach_)
          continue;
        const Point2 u = c.at - a.at, v = c.at - b.at, w = b.at - a.at;
        const double at_a = std::atan2(std::abs(cross2(w, u)), w.dot(u)),
                     at_b = std::atan2(std::abs(cross2(w, v)), -w.dot(v)), at_c = kPi - at_a - at_b;
        if (closing) {  // what is left over: only what joins two open sides or more
          if (!taken(i, from) && !taken(to, i)) continue;
        } else if (std::min({at_a, at_b, at_c}) < options_.least_angle ||
                   std::max(at_a, at_b) > options_.greatest_angle) {
          continue;
        }
        choices.push_back({u.dot(v) / (u.norm() * v.norm()), &c});
      }
      std::sort(choices.begin(), choices.end(), [](const Choice& p, const Choice& q) {
        return p.cosine != q.cosine ? p.cosine < q.cosine : p.at->index < q.at->index;
      });
      for (const Choice& choice : choices) {
        const Flat& c = *choice.at;
        if (holds_a_point(a, b, c)) continue;
        if (!taken(c.index, from) && hidden(a, c)) continue;
        if (!taken(to, c.index) && hidden(b, c)) continue;
        add({to, from, c.index});
        break;
      }
    }
  }

  /// A first triangle about a point that has none: with two of its nearest, where nothing is.
  void seed(std::int32_t i) {
    const auto near = tree_.k_nearest(point(i), 8);
    for (std::size_t p = 1; p < near.size(); ++p)
      for (std::size_t q = 1; q < near.size(); ++q) {
        const std::int32_t j = near[p].index, k = near[q].index;
        if (p == q || i == j || i == k || !of_point_[static_cast<std::size_t>(j)].empty() ||
            !of_point_[static_cast<std::size_t>(k)].empty())
          continue;
        const double longest =
            std::max({near[p].distance(), near[q].distance(), (point(j) - point(k)).norm()});
        // The triangle (i, j, k) lies to the left of ij: flatten by the other side.
        if (longest > reach_ || !flatten(j, i)) continue;
        const Flat *a = flat(j), *b = flat(i), *c = flat(k);
        if (c == nullptr || !(c->at.y() > 0.0)) continue;
        const Point2 u = b->at - a->at, v = c->at - a->at, w = c->at - b->at;
        const double angles[] = {std::atan2(cross2(u, v), u.dot(v)),
                                 std::atan2(cross2(u, w), -u.dot(w)),
                                 std::atan2(cross2(v, w), v.dot(w))};
        if (*std::min_element(angles, angles + 3) < options_.least_angle) continue;
        if (holds_a_point(*a, *b, *c) || hidden(*a, *b) || hidden(*a, *c) || hidden(*b, *c))
          continue;
        add({i, j, k});
        return;
      }
  }

  const PointCloud& cloud_;
  KdTree tree_;
  double reach_;
  const GreedyProjectionOptions& options_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::int32_t>> of_point_;
  std::vector<int> open_;  // open sides at each point, every side counted at both its ends
  std::deque<Side> front_;
  std::vector<Flat> near_;
};
}  // namespace detail

/// Grows over the points from a first triangle: on every open side the point that sees it under the
/// widest angle, projected on the plane of the side's normals, among those near, not hidden, and
/// within limits of angle. New parts begin where no triangle has come.
///
/// Keeps points where they are, so noise must be small against the spacing: thin the cloud
/// (`options.cloud.spacing`) to two or three times the noise. Edges have two triangles at most,
/// which run along them in opposite senses. O(n (log n + k²)) with k points in reach.
struct GreedyProjection {
  GreedyProjectionOptions options = {};

  TriangleMesh operator()(std::span<const Scan> scans) const {
    return (*this)(oriented_cloud(scans, options.cloud));
  }
  /// From points with unit normals.
  TriangleMesh operator()(const PointCloud& cloud) const {
    require(cloud.normals.size() == cloud.size(),
            "greedy projection: expected a normal for every point");
    detail::check_finite(cloud.points, "greedy projection");
    const double reach = options.longest_edge.value_or(3.5 * median_spacing(cloud.points));
    require(reach >= 0.0 && std::isfinite(reach),
            "greedy projection: expected edges of 0 m or more");
    if (cloud.size() < 3 || reach == 0.0) return {};
    return without_small_parts(detail::GrowingMesh(cloud, reach, options).mesh(),
                               options.least_part);
  }
};
static_assert(SurfaceReconstruction<GreedyProjection>);
}  // namespace surfleet
