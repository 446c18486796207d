// SPDX-License-Identifier: MIT
/// @file
/// @brief What an inspection leaves behind: metrics, meshes, trajectories, pictures, a report.
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
/// The coverage of a map under way: that of the final judgement, of the surface that would be
/// handed over now, at some thousand of the reference points.
class CoverageProbe {
 public:
  /// The site must outlive it, with its reference found.
  CoverageProbe(const InspectionSite& site, const InspectionSettings& s)
      : site_(&site), settings_(s) {
    const PointCloud& all = site.reference;
    const std::size_t stride = std::max<std::size_t>(1, all.size() / 8000);
    for (std::size_t i = 0; i < all.size(); i += stride) {
      samples_.points.push_back(all.points[i]);
      samples_.normals.push_back(all.normals[i]);
    }
  }
  double operator()(const TsdfMap& map) const {
    const OrientedSurface surface(reconstruction_of(map, settings_, site_->scene.region));
    return oriented_coverage(
               samples_, surface,
               {.e_max = half_voxel_diagonal(settings_.voxel), .threads = settings_.threads})
        .share();
  }

 private:
  const InspectionSite* site_;
  InspectionSettings settings_;
  PointCloud samples_;
};

/// Coverage and work over time, from the probe.
struct CoverageCurve {
  std::vector<double> time, path, coverage, incomplete;
  double last() const { return coverage.empty() ? 0.0 : coverage.back(); }
  struct Milestone {
    double time = 0.0;  ///< [s]
    double path = 0.0;  ///< Of all robots [m].
  };
  /// When so much was first covered, between two checks; nothing if never.
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

/// Checks a mission's coverage while it is under way.
class CoverageWatch {
 public:
  CoverageWatch(const InspectionSite& site, const InspectionSettings& s) : probe_(site, s) {}
  void operator()(const MissionProgress& p, const TsdfMap& map) {
    if (p.time < next_) return;
    next_ = p.time + std::max(kPeriod, kShare * p.time);
    curve_.time.push_back(p.time);
    curve_.path.push_back(p.path_length);
    curve_.coverage.push_back(probe_(map));
    curve_.incomplete.push_back(static_cast<double>(p.incomplete));
  }
  const CoverageCurve& curve() const { return curve_; }

 private:
  static constexpr double kPeriod = 5.0;  // between checks at first [s] …
  static constexpr double kShare = 0.04;  // … and of the time that has passed, later
  CoverageProbe probe_;
  CoverageCurve curve_;
  double next_ = 0.0;
};
constexpr std::array<double, 3> kMilestones{0.90, 0.95, 0.98};  ///< Shares whose path is reported.

/// Whether the published figures are those of this scene and these settings: of a bundled structure
/// with its own preset, never of a user's mesh.
inline bool has_published_figures(const InspectionSettings& s) { return s.scene == s.preset; }
/// A warning in one line where the two judges do not agree; empty where they do.
std::string doubts(const InspectionJudgement& judged);

/// `metrics.json`.
nlohmann::json inspection_metrics(const InspectionSettings& s, const InspectionSite& site,
                                  const InspectionRun& run, const InspectionJudgement& judged,
                                  const CoverageCurve& curve);

/// Writes what the mission brought back: reconstruction, map and trajectories.
void write_inspection(const std::filesystem::path& out, const InspectionRun& run);
/// Writes what is said of it: metrics, with `more` keys, error colours and the report.
void write_judgement(const std::filesystem::path& out, const InspectionSettings& s,
                     const InspectionSite& site, const InspectionRun& run,
                     const InspectionJudgement& judged, const CoverageCurve& curve,
                     const nlohmann::json& more);
}  // namespace surfleet::examples
