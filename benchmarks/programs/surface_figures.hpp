// SPDX-License-Identifier: MIT
/// @file
/// @brief What the benchmarks of surfaces share: seeds, figures as JSON, places on meshes.
#pragma once

#include <cstdint>
#include <cstdio>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/surface/surface_point.hpp>

#include "support/cli.hpp"

namespace surfleet::benchmarks {
/// Values of one figure; printed as a member of a JSON object.
struct Figure {
  std::vector<double> values;
  void add(double v) { values.push_back(v); }
  void print(const char* name) const {
    if (values.empty()) return;
    const Summary s = summarize(values);
    std::printf(", \"%s\": {\"mean\": %.5g, \"median\": %.5g, \"p95\": %.5g, \"worst\": %.5g}",
                name, s.mean, s.median, s.percentile_95, s.maximum);
  }
};

/// The seeds of a run, from the first on; those reported are from 101 on.
struct Seeds {
  std::uint64_t first = 101;
  int count = 20;

  void declare(cli::Options& app) {
    app.add("--seeds", count, "how many");
    app.add("--first-seed", first, "the others follow it");
  }
  /// Throws `Error`.
  void check() const { require(count >= 1, "--seeds: expected at least 1"); }
};

/// Anywhere but at the rim of a random triangle.
inline SurfacePoint random_point(const TriangleMesh& mesh, Random& random) {
  Eigen::Vector3d w(random.uniform(0.02, 1), random.uniform(0.02, 1), random.uniform(0.02, 1));
  return {static_cast<std::int32_t>(random.below(mesh.triangles.size())), w / w.sum()};
}
}  // namespace surfleet::benchmarks
