// SPDX-License-Identifier: MIT
/// @file
/// @brief What every deployment must keep to, whatever its policies.
#pragma once

#include <surfleet/coverage/surface_coverage.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

/// Deploys to the end and returns the final cost of eq. 6.4.
template <typename Surface, typename Distance, typename Coordinator>
double run(const TriangleMesh& mesh, std::size_t robots, SurfaceCoverageOptions options,
           Coordinator coordinator = {}) {
  const SurfaceGraph sites = Surface{}(mesh, Distance{}, options.field);
  SurfaceCoverage<Surface, Distance, Coordinator> cover(
      mesh, random_robot_sites(sites, robots, options.seed), options, coordinator);
  double last = std::numeric_limits<double>::infinity();
  bool whole = false;
  while (!cover.converged() && cover.steps() < 5000) {
    cover.step();
    const auto& region = cover.partition().region;
    CHECK(regions_connected(cover.graph().links, region));
    const bool all = std::find(region.begin(), region.end(), -1) == region.end();
    CHECK(!whole || all || std::isfinite(options.sensing_range));
    if (whole && !std::isfinite(options.sensing_range)) CHECK(cover.cost() <= last * (1 + 1e-12));
    if (all) last = cover.cost();
    whole = all;
  }
  CHECK(cover.steps() < 5000);
  CHECK(whole);
  const SurfaceRegions regions = cover.regions();
  CHECK(regions_connected(regions.dual->links, regions.region));
  for (const std::int32_t r : regions.region) CHECK(r >= 0);
  return cover.deployment_cost();
}
}  // namespace
