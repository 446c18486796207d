// SPDX-License-Identifier: MIT
/// @file
/// @brief Targets that look like nothing else, not like themselves either: positions of markers
/// whose distances differ as much as they can [004 §9.3.2].
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/localization/marker_target.hpp>
#include <surfleet/localization/nelder_mead.hpp>
#include <surfleet/localization/uncertain_pose.hpp>

namespace surfleet {
struct TargetDesignOptions {
  std::size_t targets = 1;       ///< n, told apart by their distances, too.
  std::size_t markers = 4;       ///< m, of each.
  double weight = 2.0 / 3.0;     ///< w of the least difference; 1 − w of the mean one.
  double min_distance = 0.15;    ///< D₁ between two markers of a target [m].
  double max_distance = 0.30;    ///< D₂ [m].
  double min_height = 0.12;      ///< H, least altitude of faces and tetrahedra [m].
  double marker_radius = 0.015;  ///< [m]
  int starts = 1000;
  std::uint64_t seed = 1;
  int threads = 1;
};

/// What can be said of targets used together.
struct TargetQuality {
  double similarity = 0.0;               ///< s*: the least difference of two of all distances [m].
  double mean_difference = 0.0;          ///< s̄ over all pairs of distances [m].
  double shortest = 0.0, longest = 0.0;  ///< Distances [m].
  double least_height = 0.0;  ///< Of faces over their sides and of tetrahedra over their faces [m].

  /// F of [004 eq. 9.6] where the bounds are kept [m].
  double objective(double weight) const {
    return weight * similarity + (1.0 - weight) * mean_difference;
  }
};

namespace detail {
/// Least altitude of a triangle with the given corners.
inline double triangle_height(const Point3& a, const Point3& b, const Point3& c) {
  const double side =
      std::sqrt(std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()}));
  return side > 0.0 ? (b - a).cross(c - a).norm() / side : 0.0;
}
}  // namespace detail

/// O(k log k) for k distances, and O(m⁴) for the tetrahedra of m markers.
inline TargetQuality target_quality(std::span<const MarkerTarget> targets) {
  TargetQuality q;
  std::vector<double> d;
  q.least_height = std::numeric_limits<double>::infinity();
  for (const MarkerTarget& t : targets) {
    const auto& p = t.markers;
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t j = i + 1; j < p.size(); ++j) {
        d.push_back((p[i] - p[j]).norm());
        for (std::size_t k = j + 1; k < p.size(); ++k) {
          q.least_height = std::min(q.least_height, detail::triangle_height(p[i], p[j], p[k]));
          for (std::size_t l = k + 1; l < p.size(); ++l) {
            const double volume = std::abs((p[j] - p[i]).cross(p[k] - p[i]).dot(p[l] - p[i]));
            const double face = std::max(
                {(p[j] - p[i]).cross(p[k] - p[i]).norm(), (p[j] - p[i]).cross(p[l] - p[i]).norm(),
                 (p[k] - p[i]).cross(p[l] - p[i]).norm(), (p[k] - p[j]).cross(p[l] - p[j]).norm()});
            q.least_height = std::min(q.least_height, face > 0.0 ? volume / face : 0.0);
          }
        }
      }
  }
  if (d.empty()) return q;
  std::sort(d.begin(), d.end());
  q.shortest = d.front();
  q.longest = d.back();
  if (d.size() < 2) return q;
  q.similarity = std::numeric_limits<double>::infinity();
  const auto n = static_cast<double>(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (i > 0) q.similarity = std::min(q.similarity, d[i] - d[i - 1]);
    q.mean_difference += (2.0 * static_cast<double>(i) + 1.0 - n) * d[i];
  }
  q.mean_difference /= 0.5 * n * (n - 1.0);
  return q;
}

struct TargetDesign {
  std::vector<MarkerTarget> targets;
  TargetQuality quality;
  double objective = 0.0;  ///< F [m].
};

namespace detail {
/// Positions in space whose distances are as near to the given ones (i < j, in order) as their
/// spectrum allows: exactly, where such a figure exists.
inline std::vector<Point3> embed_distances(std::size_t m, std::span<const double> distances) {
  const auto size = static_cast<Eigen::Index>(m);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);  // of half the squares, then centred
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = i + 1; j < size; ++j, ++k)
      gram(i, j) = gram(j, i) = -0.5 * distances[k] * distances[k];
  const Eigen::VectorXd mean = gram.rowwise().mean();
  const double all = mean.mean();
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j) gram(i, j) += all - mean[i] - mean[j];
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  std::vector<Point3> points(m, Point3::Zero());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::Index at = size - 1 - axis;
    const double scale = std::sqrt(std::max(0.0, eigen.eigenvalues()[at]));
    for (Eigen::Index i = 0; i < size; ++i)
      points[static_cast<std::size_t>(i)][axis] = scale * eigen.eigenvectors()(i, at);
  }
  return points;
}
inline double design_value(const TargetQuality& q, const TargetDesignOptions& o) {
  const double broken = std::max(0.0, o.min_distance - q.shortest) +
                        std::max(0.0, q.longest - o.max_distance) +
                        std::max(0.0, o.min_height - q.least_height);
  // −G, and more the farther outside, so that a simplex finds its way in.
  return broken > 1e-12 ? -1.0 - 10.0 * broken : q.objective(o.weight);
}
inline std::vector<MarkerTarget> unpack_targets(const std::vector<double>& x,
                                                const TargetDesignOptions& o) {
  std::vector<MarkerTarget> targets(o.targets);
  std::size_t k = 0;
  for (MarkerTarget& t : targets) {
    t.marker_radius = o.marker_radius;
    t.markers.resize(o.markers);
    for (Point3& p : t.markers)
      for (int axis = 0; axis < 3; ++axis) p[axis] = x[k++];
  }
  return targets;
}
}  // namespace detail

/// The best of many searches, each by Nelder–Mead from random places: lengths evenly spaced between
/// the bounds, in random order, laid out in space. The same on any number of threads. O(starts).
///
/// Throws `Error` on settings out of range and where no start kept the bounds.
inline TargetDesign design_targets(const TargetDesignOptions& options = {}) {
  require(options.targets >= 1 && options.targets <= 16 && options.markers >= 4 &&
              options.markers <= 16,
          "target design: expected 1 to 16 targets of 4 to 16 markers");
  require(options.weight >= 0.0 && options.weight <= 1.0, "target design: weight: expected 0 to 1");
  require(options.min_distance > 0.0 && options.max_distance > options.min_distance &&
              std::isfinite(options.max_distance) && options.min_height >= 0.0,
          "target design: bounds: expected 0 < D1 < D2 and H >= 0");
  require(options.starts >= 1, "target design: expected at least one start");
  const std::size_t pairs = options.markers * (options.markers - 1) / 2;
  const std::size_t count = options.targets * pairs;
  struct Found {
    double value = -std::numeric_limits<double>::infinity();
    std::vector<double> x;
  };
  std::vector<Found> found(static_cast<std::size_t>(options.starts));
  const Random streams(options.seed);
  const double range = options.max_distance - options.min_distance;
  parallel_for(found.size(), options.threads, [&](std::size_t start) {
    Random random = streams.fork(start);
    std::vector<double> lengths(count);
    Found best;
    for (int attempt = 0; attempt < 20; ++attempt) {
      for (std::size_t k = 0; k < count; ++k)
        lengths[k] =
            options.min_distance + range * static_cast<double>(k) / static_cast<double>(count - 1);
      random.shuffle(lengths);
      Found one;
      for (std::size_t t = 0; t < options.targets; ++t)
        for (const Point3& p :
             detail::embed_distances(options.markers, std::span(lengths).subspan(t * pairs, pairs)))
          for (int axis = 0; axis < 3; ++axis) one.x.push_back(p[axis]);
      one.value =
          detail::design_value(target_quality(detail::unpack_targets(one.x, options)), options);
      if (one.value > best.value) best = std::move(one);
      if (best.value > 0.0) break;
    }
    NelderMeadOptions search;
    search.step = 0.02 * options.max_distance;
    search.tolerance = 1e-7;
    search.max_values = 60 * best.x.size();
    const auto loss = [&](const std::vector<double>& x) {
      return -detail::design_value(target_quality(detail::unpack_targets(x, options)), options);
    };
    const auto result = nelder_mead(loss, best.x, search);
    found[start] = {-result.value, result.x};
  });
  const auto best = std::max_element(
      found.begin(), found.end(), [](const Found& a, const Found& b) { return a.value < b.value; });
  require(best->value > 0.0,
          "target design: no start kept the bounds; expected D1, D2 farther apart, a smaller H, or "
          "more starts");
  TargetDesign design;
  design.targets = detail::unpack_targets(best->x, options);
  design.quality = target_quality(design.targets);
  design.objective = design.quality.objective(options.weight);
  return design;
}

/// The target turned so that it is most distinct from above: F of the distances as projected on the
/// plane z = 0, of which none is shorter than a third of D₁. The markers' middle is on the z axis,
/// the lowest at z = 0. O(turns).
inline MarkerTarget turned_for_view_from_above(const MarkerTarget& target,
                                               const TargetDesignOptions& options = {},
                                               int turns = 200) {
  Point3 middle = Point3::Zero();
  for (const Point3& p : target.markers) middle += p / static_cast<double>(target.markers.size());
  const auto turned = [&](const std::vector<double>& w) {
    MarkerTarget t = target;
    const Eigen::Matrix3d r = rotation_exp({w[0], w[1], 0.0});
    double lowest = std::numeric_limits<double>::infinity();
    for (Point3& p : t.markers) {
      p = r * (p - middle);
      lowest = std::min(lowest, p.z());
    }
    for (Point3& p : t.markers) p.z() -= lowest;
    return t;
  };
  const auto loss = [&](const std::vector<double>& w) {
    std::vector<MarkerTarget> flat{turned(w)};
    for (Point3& p : flat[0].markers) p.z() = 0.0;
    const TargetQuality q = target_quality(flat);
    const double broken = options.min_distance / 3.0 - q.shortest;
    return broken > 0.0 ? 1.0 + broken : -q.objective(options.weight);
  };
  Random random(options.seed);
  NelderMeadResult best;
  best.value = std::numeric_limits<double>::infinity();
  NelderMeadOptions search;
  search.max_values = 150;
  for (int i = 0; i < turns; ++i) {
    const double angle = random.uniform(0.0, kPi), about = random.uniform(0.0, 2.0 * kPi);
    const auto one = nelder_mead(loss, {angle * std::cos(about), angle * std::sin(about)}, search);
    if (one.value < best.value) best = one;
  }
  return turned(best.x);
}
}  // namespace surfleet
