// SPDX-License-Identifier: MIT
/// @file  What an inspection leaves behind: metrics, meshes, trajectories, pictures, a report.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "support/inspection.hpp"

namespace surfleet::examples {
/// A quick look at the coverage of a map under way: the share of some thousand reference points
/// whose voxel knows of a surface within e_max. The judgement at the end is made on the mesh.
class CoverageProbe {
 public:
  CoverageProbe(const InspectionSite& site, double e_max) : e_max_(e_max) {
    const auto& points = site.reference.points;
    const std::size_t stride = std::max<std::size_t>(1, points.size() / 8000);
    for (std::size_t i = 0; i < points.size(); i += stride) points_.push_back(points[i]);
  }
  double operator()(const TsdfMap& map) const {
    std::size_t covered = 0;
    auto voxels = map.accessor();
    for (const Point3& p : points_) {
      const VoxelIndex v = map.index_of(p);
      bool near = false;
      for (int k = 0; k < 7 && !near; ++k) {
        VoxelIndex n = v;
        if (k > 0) n[(k - 1) / 2] += (k & 1) != 0 ? 1 : -1;
        const TsdfVoxel* x = voxels.find(n);
        near = x != nullptr && x->weight > 0.0F &&
               std::abs(static_cast<double>(x->distance)) <= e_max_;
      }
      covered += near ? 1 : 0;
    }
    return points_.empty() ? 0.0
                           : static_cast<double>(covered) / static_cast<double>(points_.size());
  }

 private:
  double e_max_;
  std::vector<Point3> points_;
};

/// Coverage and work over time, from the probe.
struct CoverageCurve {
  std::vector<double> time, path, coverage, incomplete;
  double last() const { return coverage.empty() ? 0.0 : coverage.back(); }
  struct Milestone {
    double time = 0.0;  ///< [s]
    double path = 0.0;  ///< Of all robots [m].
  };
  /// When so much was first covered, between two looks at it; nothing if never.
  std::optional<Milestone> reached(double share) const {
    const auto at =
        std::find_if(coverage.begin(), coverage.end(), [&](double c) { return c >= share; });
    if (at == coverage.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(at - coverage.begin());
    if (i == 0) return Milestone{time[0], path[0]};
    const double t = (share - coverage[i - 1]) / (coverage[i] - coverage[i - 1]);
    return Milestone{std::lerp(time[i - 1], time[i], t), std::lerp(path[i - 1], path[i], t)};
  }
};

/// Looks at a mission's coverage while it is under way.
class CoverageWatch {
 public:
  CoverageWatch(const InspectionSite& site, double e_max) : probe_(site, e_max) {}
  void operator()(const MissionProgress& p, const TsdfMap& map) {
    if (p.time < next_) return;
    next_ = p.time + kPeriod;
    curve_.time.push_back(p.time);
    curve_.path.push_back(p.path_length);
    curve_.coverage.push_back(probe_(map));
    curve_.incomplete.push_back(static_cast<double>(p.incomplete));
  }
  const CoverageCurve& curve() const { return curve_; }

 private:
  static constexpr double kPeriod = 5.0;  // [s]
  CoverageProbe probe_;
  CoverageCurve curve_;
  double next_ = 0.0;
};
constexpr std::array<double, 3> kMilestones{0.90, 0.95, 0.98};  ///< Shares whose path is reported.

/// A warning in one line where the two judges do not agree; empty where they do.
std::string doubts(const InspectionJudgement& judged);

/// `metrics.json`.
nlohmann::json inspection_metrics(const InspectionSettings& s, const InspectionSite& site,
                                  const InspectionRun& run, const InspectionJudgement& judged,
                                  const CoverageCurve& curve);

/// Writes what the mission brought back: reconstruction, map and trajectories.
void write_inspection(const std::filesystem::path& out, const InspectionRun& run);
/// Writes what is said of it: metrics, error colours and the report.
void write_judgement(const std::filesystem::path& out, const InspectionSettings& s,
                     const InspectionSite& site, const InspectionRun& run,
                     const InspectionJudgement& judged, const CoverageCurve& curve);
}  // namespace surfleet::examples
