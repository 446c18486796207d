// SPDX-License-Identifier: MIT
/// @file
/// @brief What a planned coverage tour leaves behind: viewpoints, the tour, metrics, a report.
#pragma once

#include <filesystem>

#include "support/known_tour.hpp"

namespace surfleet::examples {
/// Writes `viewpoints.csv` (index, x, y, z [m], yaw and with a gimbal pitch [rad], in the order of
/// the visit), `tour.json` (start, viewpoints, the whole path and its length), `tour.tum` (the
/// body's pose at every image), `reconstruction.ply` (what the images show), `metrics.json` and
/// `report.html`.
void write_tour(const std::filesystem::path& out, const InspectionSettings& s,
                const InspectionSite& site, const CoverageTourOptions& plan,
                const CoverageTour& tour, const FlownTour& flown, const JudgeReport& path);
}  // namespace surfleet::examples
