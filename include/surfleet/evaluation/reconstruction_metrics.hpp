// SPDX-License-Identifier: MIT
/// @file
/// @brief How complete and how exact a reconstruction is [000 §2.6.2].
///
/// @code
/// EvaluationOptions options{.e_max = half_voxel_diagonal(0.3)};
/// const auto samples = sample_surface(truth, {.density = 25});
/// const ReconstructionEvaluation e = evaluate(samples.cloud, truth, reconstruction, options);
/// use(e.metrics.surface_coverage, e.metrics.rmse_m);
/// @endcode
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/evaluation/m3c2.hpp>
#include <surfleet/evaluation/oriented_coverage.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/surface_sampling.hpp>
#include <surfleet/geometry/bvh.hpp>

namespace surfleet {
/// e_max of the seeds: half the diagonal of a voxel.
inline double half_voxel_diagonal(double voxel_size) {
  return 0.5 * std::numbers::sqrt3 * voxel_size;
}

struct EvaluationOptions {
  double e_max = 0.2598;  ///< A reference point is covered by surface this near [m].
  /// Points per m² on sampled meshes; nothing: about 8 a cylinder of M3C2.
  std::optional<double> density{};
  /// M3C2's d [m]; nothing: the voxel that e_max belongs to, 2/√3 e_max.
  std::optional<double> projection_scale{};
  std::optional<double> normal_scale{};  ///< M3C2's D [m], for normals not given; nothing: 2 d.
  std::optional<double> max_depth{};     ///< M3C2's cylinder to either side [m]; nothing: 2 e_max.
  /// What mean and 95 % distances count a distance as at most [m].
  double max_distance = std::numeric_limits<double>::infinity();
  bool sided = true;  ///< Coverage and M3C2 ask for the side that points are seen from.
  std::uint64_t seed = 1;
  int threads = 1;

  double cylinder_diameter() const {
    return projection_scale.value_or(2.0 / std::numbers::sqrt3 * e_max);
  }
  double sampling_density() const {
    const double d = cylinder_diameter();
    return density.value_or(32.0 / (std::numbers::pi * d * d));
  }
  double depth() const { return max_depth.value_or(2.0 * e_max); }
  /// How far off a part of the reconstruction that faces a point is searched [m].
  double coverage_reach() const { return 3.0 * e_max; }
};

/// The figures, SI units. What cannot be measured (an empty reconstruction) is NaN, coverage 0;
/// completeness then is `max_distance`, where that is finite.
struct ReconstructionMetrics {
  /// Share of the reference points that have some part of the reconstruction within e_max that
  /// faces the side they are seen from (`oriented_coverage.hpp`).
  double surface_coverage = 0.0;
  /// The same with whatever side of the reconstruction: a difference tells of sides mixed up.
  double unsided_coverage = 0.0;
  /// M3C2 over what is covered: |distance| ≤ e_max, as the seeds prune outliers.
  double m3c2_mean_m = 0.0, m3c2_std_m = 0.0, rmse_m = 0.0;
  /// M3C2 over every core point whose cylinder met both surfaces.
  double m3c2_unpruned_mean_m = 0.0, m3c2_unpruned_std_m = 0.0, unpruned_rmse_m = 0.0;
  /// Reference to reconstruction: what is missing. All reference points count.
  double completeness_mean_m = 0.0, completeness_p95_m = 0.0;
  /// Reconstruction to reference: what is wrong. Samples of the whole reconstruction.
  double accuracy_mean_m = 0.0, accuracy_p95_m = 0.0;
  std::size_t reference_points = 0, reconstruction_points = 0, m3c2_points = 0;

  /// Coverage by M3C2, as the seeds count it [000 §2.6.2]: the share of the reference whose
  /// distance along the normal is measured and at most e_max.
  double m3c2_coverage() const {
    return reference_points == 0
               ? 0.0
               : static_cast<double>(m3c2_points) / static_cast<double>(reference_points);
  }
};

struct ReconstructionEvaluation {
  ReconstructionMetrics metrics;
  std::vector<double> reference_distance;  ///< To the reconstruction, a reference point each [m].
  /// The same to what faces the point's side; infinite beyond the options' reach.
  std::vector<double> facing_distance;
  M3C2Result m3c2;  ///< Core points are the reference points.
};

/// A surface for measuring: a mesh (distances to its triangles, clouds sampled from it) or a cloud
/// (distances to its points).
class MeasuredSurface {
 public:
  /// Samples `mesh` at the options' density. The mesh need not live on.
  static MeasuredSurface from(const TriangleMesh& mesh, const EvaluationOptions& options) {
    MeasuredSurface s;
    s.surface_ = OrientedSurface(mesh);
    s.cloud_ =
        sample_surface(mesh, {.density = options.sampling_density(), .seed = options.seed}).cloud;
    return s;
  }
  static MeasuredSurface from(const PointCloud& cloud, const EvaluationOptions& = {}) {
    MeasuredSurface s;
    s.surface_ = OrientedSurface(cloud);
    s.cloud_ = cloud;
    return s;
  }
  const PointCloud& cloud() const { return cloud_; }
  const OrientedSurface& surface() const { return surface_; }
  /// To the surface [m]; infinite if it is empty.
  double distance(const Point3& p) const { return surface_.distance(p); }

 private:
  OrientedSurface surface_;
  PointCloud cloud_;
};

namespace detail {
inline std::vector<double> distances_to(const MeasuredSurface& surface,
                                        std::span<const Point3> points, int threads) {
  std::vector<double> distance(points.size());
  parallel_for(
      points.size(), threads, [&](std::size_t i) { distance[i] = surface.distance(points[i]); },
      256);
  return distance;
}
/// Mean and 95 % of distances, none counted as more than `limit`.
inline std::pair<double, double> mean_and_p95(std::vector<double> distance, double limit) {
  for (double& d : distance) d = std::min(d, limit);
  const double p95 = percentile(distance, 0.95);
  return {moments(distance).mean(), p95};
}
}  // namespace detail

/// Measures `reconstruction` against `reference` at `reference_points`: samples of the reference,
/// or the part of them that is to be judged (what a robot could have seen, a region of interest).
///
/// The points are coverage's unit of area and the core points of M3C2. Their normals, if present,
/// point to the side they are seen from; otherwise any side covers them and M3C2's normals are
/// estimated from the reference. Throws `Error` on an e_max that is not positive, or no reference
/// point.
inline ReconstructionEvaluation evaluate(const PointCloud& reference_points,
                                         const MeasuredSurface& reference,
                                         const MeasuredSurface& reconstruction,
                                         const EvaluationOptions& options = {}) {
  require(options.e_max > 0.0 && std::isfinite(options.e_max),
          "e_max: expected a positive length in metres");
  require(reference_points.size() > 0, "evaluation: the reference has no point to judge by");
  ReconstructionEvaluation e;
  ReconstructionMetrics& m = e.metrics;
  e.reference_distance =
      detail::distances_to(reconstruction, reference_points.points, options.threads);
  const auto near = std::count_if(e.reference_distance.begin(), e.reference_distance.end(),
                                  [&](double d) { return d <= options.e_max; });
  m.unsided_coverage = static_cast<double>(near) / static_cast<double>(reference_points.size());
  if (options.sided) {
    OrientedCoverage coverage = oriented_coverage(
        reference_points, reconstruction.surface(),
        {.e_max = options.e_max, .reach = options.coverage_reach(), .threads = options.threads});
    m.surface_coverage = coverage.share();
    e.facing_distance = std::move(coverage.distance);
  } else {
    m.surface_coverage = m.unsided_coverage;
    e.facing_distance = e.reference_distance;
  }
  m.reference_points = reference_points.size();
  m.reconstruction_points = reconstruction.cloud().size();

  const double d = options.cylinder_diameter();
  e.m3c2 = m3c2(reference_points, reference.cloud(), reconstruction.cloud(),
                {.normal_scale = options.normal_scale.value_or(2.0 * d),
                 .projection_scale = d,
                 .max_depth = options.depth(),
                 .sided = options.sided,
                 .threads = options.threads});
  const DistanceStatistics pruned = distance_statistics(e.m3c2.distance, options.e_max);
  m.m3c2_points = pruned.count;
  m.m3c2_mean_m = pruned.mean;
  m.m3c2_std_m = pruned.deviation;
  m.rmse_m = pruned.rmse;
  m.m3c2_unpruned_mean_m = e.m3c2.statistics.mean;
  m.m3c2_unpruned_std_m = e.m3c2.statistics.deviation;
  m.unpruned_rmse_m = e.m3c2.statistics.rmse;

  const auto or_none = [](std::pair<double, double> v) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return std::isfinite(v.first) ? v : std::pair(kNone, kNone);
  };
  std::tie(m.completeness_mean_m, m.completeness_p95_m) =
      or_none(detail::mean_and_p95(e.reference_distance, options.max_distance));
  std::tie(m.accuracy_mean_m, m.accuracy_p95_m) = or_none(detail::mean_and_p95(
      detail::distances_to(reference, reconstruction.cloud().points, options.threads),
      options.max_distance));
  return e;
}

/// The same of a mesh against a mesh. `reference_points` may be a part of the reference's surface.
inline ReconstructionEvaluation evaluate(const PointCloud& reference_points,
                                         const TriangleMesh& reference,
                                         const TriangleMesh& reconstruction,
                                         const EvaluationOptions& options = {}) {
  return evaluate(reference_points, MeasuredSurface::from(reference, options),
                  MeasuredSurface::from(reconstruction, options), options);
}

/// The same with the whole reference judged.
inline ReconstructionEvaluation evaluate(const TriangleMesh& reference,
                                         const TriangleMesh& reconstruction,
                                         const EvaluationOptions& options = {}) {
  const auto truth = MeasuredSurface::from(reference, options);
  return evaluate(truth.cloud(), truth, MeasuredSurface::from(reconstruction, options), options);
}

/// Distance of each point to `mesh`, negative behind the nearest triangle [m]; NaN beyond
/// `max_distance`. For colouring a reconstruction by its error.
inline std::vector<double> signed_distances(
    std::span<const Point3> points, const TriangleMesh& mesh, const Bvh& bvh,
    double max_distance = std::numeric_limits<double>::infinity(), int threads = 1) {
  std::vector<double> distance(points.size());
  parallel_for(
      points.size(), threads,
      [&](std::size_t i) {
        const auto nearest = bvh.closest_point(points[i], max_distance);
        if (!nearest) {
          distance[i] = std::numeric_limits<double>::quiet_NaN();
          return;
        }
        const Eigen::Vector3d outward =
            mesh.area_vector(static_cast<std::size_t>(nearest->triangle));
        distance[i] = std::copysign(nearest->distance, (points[i] - nearest->point).dot(outward));
      },
      256);
  return distance;
}
}  // namespace surfleet
