// SPDX-License-Identifier: MIT
/// @file
/// @brief Regions as sets of triangles, for robots that are to drive over all of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/coverage/mesh_graph.hpp>
#include <surfleet/coverage/surface_partition.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// Every triangle's robot, and where the robots stand.
struct SurfaceRegions {
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const SurfaceGraph> dual;  ///< `DualMeshGraph` of `mesh`.
  std::vector<std::int32_t> region;          ///< Robot of every triangle, or −1.
  std::vector<std::int32_t> start;           ///< Triangle of every robot, or −1 without a region.

  std::size_t robots() const { return start.size(); }
  std::vector<std::int32_t> triangles(std::size_t robot) const {
    std::vector<std::int32_t> list;
    for (std::size_t t = 0; t < region.size(); ++t)
      if (region[t] == static_cast<std::int32_t>(robot)) list.push_back(static_cast<int>(t));
    return list;
  }
};

/// Makes every region one piece over common edges: pieces without their robot's triangle go to
/// the neighbour they touch, nearest first. Pieces that touch no region stay. O(m log m).
inline void connect_regions(SurfaceRegions& regions) {
  const Graph& links = regions.dual->links;
  const std::size_t m = regions.region.size();
  std::vector<std::uint8_t> firm(m, 0);
  std::vector<std::int32_t> stack;
  for (std::size_t i = 0; i < regions.robots(); ++i) {
    if (regions.start[i] < 0) continue;
    regions.region[static_cast<std::size_t>(regions.start[i])] = static_cast<std::int32_t>(i);
    firm[static_cast<std::size_t>(regions.start[i])] = 1;
    stack.push_back(regions.start[i]);
  }
  while (!stack.empty()) {
    const auto t = static_cast<std::size_t>(stack.back());
    stack.pop_back();
    for (const Arc& arc : links.arcs(static_cast<std::int32_t>(t))) {
      const auto u = static_cast<std::size_t>(arc.to);
      if (firm[u] != 0 || regions.region[u] != regions.region[t]) continue;
      firm[u] = 1;
      stack.push_back(arc.to);
    }
  }
  std::vector<Source> sources;
  for (std::size_t t = 0; t < m; ++t)
    if (firm[t] != 0) sources.push_back({static_cast<std::int32_t>(t), 0.0});
  const auto keep = [&](std::int32_t t) {
    const auto u = static_cast<std::size_t>(t);
    return firm[u] == 0 && regions.region[u] >= 0;
  };
  std::vector<std::int32_t> order;
  const auto paths = shortest_paths(Restricted(links, keep), std::span<const Source>(sources),
                                    NoHeuristic{}, [&](std::int32_t t, double) {
                                      order.push_back(t);
                                      return false;
                                    });
  for (const std::int32_t t : order) {
    const std::int32_t from = paths.previous[static_cast<std::size_t>(t)];
    if (from >= 0)
      regions.region[static_cast<std::size_t>(t)] = regions.region[static_cast<std::size_t>(from)];
  }
}

/// The triangles of a partition of vertices (each to the robot of most of its corners, ties to the
/// nearest) or of triangles (as they are).
inline SurfaceRegions make_surface_regions(std::shared_ptr<const TriangleMesh> mesh,
                                           const SurfaceGraph& graph,
                                           const SurfacePartition& partition) {
  SurfaceRegions regions;
  const std::size_t m = mesh->triangles.size();
  regions.mesh = std::move(mesh);
  regions.dual =
      std::make_shared<const SurfaceGraph>(DualMeshGraph{}(*regions.mesh, EdgeGeodesic{}));
  regions.region.assign(m, SurfacePartition::kNone);
  regions.start.assign(partition.robots(), -1);
  const bool dual = graph.size() == m && (m == 0 || graph.position[0] == regions.mesh->centroid(0));
  if (dual) {
    regions.region = partition.region;
    regions.start = partition.generator;
    return regions;
  }
  require(graph.size() == regions.mesh->vertices.size(),
          "surface regions: the partition is not of this mesh");
  std::vector<double> best(partition.robots(), ShortestPaths::kUnreached);
  for (std::size_t t = 0; t < m; ++t) {
    const Triangle& corners = regions.mesh->triangles[t];
    double nearest = ShortestPaths::kUnreached;
    int most = 0;
    for (const std::int32_t v : corners) {
      const std::int32_t robot = partition.region[static_cast<std::size_t>(v)];
      if (robot < 0) continue;
      int votes = 0;
      for (const std::int32_t w : corners)
        votes += partition.region[static_cast<std::size_t>(w)] == robot ? 1 : 0;
      const double d = partition.distance[static_cast<std::size_t>(v)];
      if (votes < most || (votes == most && d >= nearest)) continue;
      most = votes;
      nearest = d;
      regions.region[t] = robot;
    }
  }
  // A robot stands on a triangle at its vertex: one of its own region, free of other robots.
  std::vector<std::uint8_t> taken(m, 0);
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t t = 0; t < m; ++t)
      for (const std::int32_t v : regions.mesh->triangles[t]) {
        const std::int32_t robot = partition.region[static_cast<std::size_t>(v)];
        if (robot < 0 || taken[t] != 0) continue;
        const auto i = static_cast<std::size_t>(robot);
        if (partition.generator[i] != v || regions.start[i] >= 0) continue;
        if (pass == 0 && regions.region[t] != robot) continue;
        regions.start[i] = static_cast<std::int32_t>(t);
        taken[t] = 1;
      }
  connect_regions(regions);
  return regions;
}

/// For every robot the vertex of its region's triangles that is nearest to the region's mass
/// centre: where a robot of a partition of triangles stands on the graph of vertices, for costs
/// that are to be compared (eq. 6.4). Distinct vertices. O(m).
inline std::vector<std::int32_t> centroid_vertices(const TriangleMesh& mesh,
                                                   const SurfaceGraph& dual,
                                                   const std::vector<std::int32_t>& region,
                                                   std::size_t robots) {
  std::vector<Eigen::Vector3d> centre(robots, Eigen::Vector3d::Zero());
  std::vector<double> mass(robots, 0.0);
  for (std::size_t t = 0; t < region.size(); ++t) {
    if (region[t] < 0) continue;
    centre[static_cast<std::size_t>(region[t])] += dual.mass[t] * dual.position[t];
    mass[static_cast<std::size_t>(region[t])] += dual.mass[t];
  }
  std::vector<std::int32_t> vertex(robots, SurfacePartition::kNone);
  std::vector<std::vector<std::pair<double, std::int32_t>>> offers(robots);
  for (std::size_t t = 0; t < region.size(); ++t) {
    if (region[t] < 0) continue;
    const auto i = static_cast<std::size_t>(region[t]);
    const Eigen::Vector3d c =
        mass[i] > 0.0 ? Eigen::Vector3d(centre[i] / mass[i]) : dual.position[t];
    for (const std::int32_t v : mesh.triangles[t])
      offers[i].push_back({(mesh.vertices[static_cast<std::size_t>(v)] - c).norm(), v});
  }
  std::vector<std::uint8_t> taken(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < robots; ++i) {
    std::sort(offers[i].begin(), offers[i].end());
    for (const auto& [d, v] : offers[i]) {
      if (taken[static_cast<std::size_t>(v)] != 0) continue;
      taken[static_cast<std::size_t>(v)] = 1;
      vertex[i] = v;
      break;
    }
  }
  return vertex;
}
}  // namespace surfleet
