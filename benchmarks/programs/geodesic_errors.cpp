// SPDX-License-Identifier: MIT
// requires: cgal
// Errors and times of the distances along a mesh against CGAL's exact geodesics, with CGAL's heat
// method beside them; and how many vertices fall below the straight line when there are many
// sources. Prints JSON.
//
//   geodesic_errors [--vertices 43000] [--sources 20] [--no-exact]
#include <CGAL/Heat_method_3/Surface_mesh_geodesic_distances_3.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "cgal_mesh.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
using Kernel = benchmarks::CgalKernel;
using Mesh = benchmarks::CgalMesh;

struct Errors {
  double mean = 0.0, worst = 0.0, below = 0.0;
};
Errors compare(const TriangleMesh& mesh, const std::vector<double>& exact,
               const std::vector<double>& found, const std::vector<std::int32_t>& sources) {
  Errors e;
  double count = 0.0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    double straight = 1e300;
    for (const std::int32_t s : sources)
      straight = std::min(straight,
                          (mesh.vertices[v] - mesh.vertices[static_cast<std::size_t>(s)]).norm());
    if (found[v] < straight * (1.0 - 1e-9)) e.below += 1.0 / static_cast<double>(found.size());
    if (exact.empty() || !(exact[v] > 0.0)) continue;
    const double error = std::abs(found[v] / exact[v] - 1.0);
    e.mean += error;
    e.worst = std::max(e.worst, error);
    count += 1.0;
  }
  if (count > 0.0) e.mean /= count;
  return e;
}

void measure(const char* name, const TriangleMesh& mesh, int many, bool exact_too, bool last) {
  const Mesh cgal = benchmarks::cgal_mesh(mesh);
  Random random(7);
  std::vector<std::int32_t> one{static_cast<std::int32_t>(mesh.vertices.size() / 3)}, several;
  for (int k = 0; k < many; ++k)
    several.push_back(static_cast<std::int32_t>(random.below(mesh.vertices.size())));
  const auto exact_from = [&](const std::vector<std::int32_t>& sources, double& took) {
    std::vector<double> exact;
    if (!exact_too) return exact;
    using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
    const auto begin = Clock::now();
    CGAL::Surface_mesh_shortest_path<Traits> paths(cgal);
    for (const std::int32_t s : sources)
      paths.add_source_point(Mesh::Vertex_index(static_cast<unsigned>(s)));
    for (const auto v : cgal.vertices())
      exact.push_back(paths.shortest_distance_to_source_points(v).first);
    took = seconds_since(begin);
    return exact;
  };
  double exact_time = 0.0, exact_time_many = 0.0;
  const auto exact_one = exact_from(one, exact_time),
             exact_many = exact_from(several, exact_time_many);
  std::printf("  {\"mesh\": \"%s\", \"vertices\": %zu, \"exact_s\": %.3f,\n   \"methods\": [\n",
              name, mesh.vertices.size(), exact_time);
  const auto print = [&](const char* method, double setup, double search,
                         const std::vector<double>& a, const std::vector<double>& b, bool end) {
    const Errors e = compare(mesh, exact_one, a, one), f = compare(mesh, exact_many, b, several);
    std::printf(
        "    {\"method\": \"%s\", \"setup_ms\": %.2f, \"search_ms\": %.2f, "
        "\"mean_error\": %.4f, \"max_error\": %.4f, \"below_straight\": %.4f, "
        "\"many_mean_error\": %.4f, \"many_below_straight\": %.4f}%s\n",
        method, 1e3 * setup, 1e3 * search, e.mean, e.worst, e.below, f.mean, f.below,
        end ? "" : ",");
  };
  const auto ours = [&](const char* method, const auto& policy) {
    auto begin = Clock::now();
    const Graph graph = policy(mesh, EuclideanMetric{});
    const double setup = seconds_since(begin);
    begin = Clock::now();
    const auto a = shortest_paths(graph, one[0]);
    const double search = seconds_since(begin);
    std::vector<Source> sources;
    for (const std::int32_t s : several) sources.push_back({s, 0.0});
    const auto b = shortest_paths(graph, std::span<const Source>(sources));
    print(method, setup, search, a.distance, b.distance, false);
  };
  ours("edges", EdgeGeodesic{});
  ours("faces 1", FaceGeodesic{1});
  ours("faces 2", FaceGeodesic{2});
  ours("faces 3", FaceGeodesic{3});
  auto begin = Clock::now();
  CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<Mesh> heat(cgal);
  const double setup = seconds_since(begin);
  auto map = cgal.property_map<Mesh::Vertex_index, double>("v:none").first;
  Mesh copy = cgal;
  map = copy.add_property_map<Mesh::Vertex_index, double>("v:distance", 0.0).first;
  const auto heat_from = [&](const std::vector<std::int32_t>& sources, double& took) {
    heat.clear_sources();
    for (const std::int32_t s : sources)
      heat.add_source(Mesh::Vertex_index(static_cast<unsigned>(s)));
    const auto start = Clock::now();
    heat.estimate_geodesic_distances(map);
    took = seconds_since(start);
    std::vector<double> d;
    for (const auto v : copy.vertices()) d.push_back(map[v]);
    return d;
  };
  double search = 0.0, ignored = 0.0;
  const auto a = heat_from(one, search), b = heat_from(several, ignored);
  print("heat (CGAL)", setup, search, a, b, true);
  std::printf("   ]}%s\n", last ? "" : ",");
}
}  // namespace

int main(int argc, char** argv) {
  int vertices = 43000, many = 20;
  bool exact = true;
  for (int k = 1; k < argc; ++k) {
    const std::string option = argv[k];
    if (option == "--vertices" && k + 1 < argc) vertices = std::max(1000, std::atoi(argv[++k]));
    if (option == "--sources" && k + 1 < argc) many = std::max(1, std::atoi(argv[++k]));
    if (option == "--no-exact") exact = false;
  }
  const double side = std::sqrt(vertices * std::sqrt(0.75));
  TriangleMesh slope = bumpy_slope({.edge = 1.2 / side});
  std::printf("[\n");
  measure("bumpy slope, regular", slope, many, exact, false);
  // Moving the vertices about in the plan takes away the six preferred directions.
  Random random(11);
  const Box3 box = slope.bounds();
  for (Point3& p : slope.vertices) {
    const bool border = p.x() <= box.min().x() || p.x() >= box.max().x() ||
                        p.y() <= box.min().y() || p.y() >= box.max().y();
    if (border) continue;
    p.x() += 0.25 * 1.2 / side * random.uniform(-1.0, 1.0);
    p.y() += 0.25 * 1.2 / side * random.uniform(-1.0, 1.0);
  }
  measure("bumpy slope, irregular", slope, many, exact, false);
  measure("sphere", make_sphere(Point3::Zero(), 1.0, vertices > 20000 ? 6 : 5), many, exact, true);
  std::printf("]\n");
  return 0;
}
