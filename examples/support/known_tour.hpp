// SPDX-License-Identifier: MIT
/// @file
/// @brief Coverage tours of a site that is known, and what the images taken on them cover, for
///        `plan_coverage_tour` and the clairvoyant benchmark.
#pragma once

#include <utility>
#include <vector>

#include "support/inspection.hpp"

#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/planning/coverage_tour.hpp>

namespace surfleet::examples {
/// Plans tours over the sides of a site's surface that can be seen, in the free space that a
/// perfect survey would know: that of a mission. The site must outlive it, with its reference found
/// from `start`.
class KnownSitePlanner {
 public:
  /// `density`: samples a square metre, at most those of the reference. `margin`: kept beyond the
  /// body [m].
  KnownSitePlanner(const InspectionSettings& s, const InspectionSite& site,
                   const Configuration& start, double density, double margin);
  CoverageTour plan(const CoverageTourOptions& options);

 private:
  const InspectionSite* site_;
  Configuration start_;
  Pose mount_;
  std::vector<double> pitches_;
  TsdfMap map_;
  VoxelStateMap states_;
  FreeSpace space_;
  LazyPrmStar roadmap_;
  std::vector<Point3> points_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> areas_;
};

/// A tour that was flown: its images, and the surface they show.
struct FlownTour {
  std::vector<std::pair<double, Configuration>> images;  ///< Times [s] and bodies' poses.
  TriangleMesh reconstruction;
  ReconstructionEvaluation evaluation;  ///< By the yardstick of missions.
};
/// Flies `tour` in simulation at the nominal speed, with a mission's camera, noise, images and map,
/// and a hold at every viewpoint [s].
FlownTour fly_known_tour(const CoverageTour& tour, const InspectionSettings& s,
                         const InspectionSite& site, const Configuration& start, double hold);
/// How long images from one place take to make surface known that is `depth` away [m]: W_th over
/// the weight of each.
inline double hold_for(const InspectionSettings& s, double depth) {
  return s.known_weight / s.integrator().weight(0.0, depth) / s.rate;
}
}  // namespace surfleet::examples
