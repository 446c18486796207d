// SPDX-License-Identifier: MIT
// Raw clouds: normals, edges, dense paths over them and the time they take, and meshes simplified.
// Prints JSON.
//
//   surface_clouds [--seeds 20] [--first-seed 101] [--pairs 50] [--only PART]
//
// PART: orientation, cube, edges, paths, time, simplify, or paths:SCENE.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "support/cloud_navigation.hpp"
#include "support/scanned_surface.hpp"
#include "support/stopwatch.hpp"
#include "surface_figures.hpp"

#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/geometry/mesh_borders.hpp>
#include <surfleet/geometry/simplify.hpp>
#include <surfleet/surface/dense_planner.hpp>
#include <surfleet/surface/smooth_path.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;
constexpr double kScale = 0.06, kVoxel = 0.035, kDensity = 3600.0;

using benchmarks::Figure;
benchmarks::Seeds g_seeds;
int g_pairs = 50;
bool g_begun = false;

void begin_row(const char* kind, const std::string& name) {
  std::printf("%s{\"%s\": \"%s\"", g_begun ? ",\n" : "", kind, name.c_str());
  g_begun = true;
}
void end_row() {
  std::printf("}");
  std::fflush(stdout);
}
double between_lines(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), std::abs(a.dot(b))));
}
double median(const std::vector<double>& values) { return summarize(values).median; }
template <typename Use>
void for_each_seed(const Use& use) {
  for (int k = 0; k < g_seeds.count; ++k) use(g_seeds.first + static_cast<std::uint64_t>(k));
}

/// The normal of least variance of the points within `radius` of a place.
Eigen::Vector3d plane_normal(const KdTree& tree, const std::vector<Point3>& points,
                             const Point3& at, double radius) {
  PointMoments moments;
  tree.for_each_within(at, radius, [&](const Neighbor& n) {
    moments.add(points[static_cast<std::size_t>(n.index)] - at);
  });
  return PrincipalAxes(moments.covariance()).vectors.col(0);
}
std::vector<Token> reduced_tokens(const TensorVoting<>& vote, const std::vector<Token>& tokens) {
  std::vector<Token> kept;
  for (const std::size_t i : vote.reduced(tokens)) kept.push_back(tokens[i]);
  return kept;
}

/// Random points on a tube about z of length 1.2 m, and the same moved by noise along each axis.
struct NoisyTube {
  std::vector<Point3> exact, points;
  double radius;
  NoisyTube(std::uint64_t seed, double r, double noise) : radius(r) {
    Random random(mix64(seed) ^ 0x70beULL);
    const auto count = static_cast<std::size_t>(kDensity * 2.0 * kPi * r * 1.2);
    for (std::size_t i = 0; i < count; ++i) {
      const double a = random.uniform(-kPi, kPi);
      exact.emplace_back(r * std::cos(a), r * std::sin(a), random.uniform(-0.6, 0.6));
    }
    points = exact;
    add_noise(points, noise, seed);
  }
  bool inside(const Point3& p) const { return std::abs(p.z()) < 0.4; }  // past reach of the ends
  static Eigen::Vector3d normal(const Point3& p) { return {p.x(), p.y(), 0.0}; }
};

/// Median angles to the true normals [deg]: of votes and planes at points of the true tube, of
/// sheet tokens where they have moved to.
void orientation(double noise) {
  Figure once, balls, sheets, dense, planes, wide;
  for_each_seed([&](std::uint64_t seed) {
    const NoisyTube tube(seed, 0.35, noise);
    std::vector<Point3> places;
    for (std::size_t i = 0; i < tube.exact.size(); i += 5)
      if (tube.inside(tube.exact[i])) places.push_back(tube.exact[i]);
    const TensorVoting<> vote{{.scale = kScale}, {}};
    const KdTree tree(tube.points);
    const auto error = [&](const std::vector<Token>& tokens) {
      std::vector<double> angles;
      for (const Token& t : tokens)
        if (tube.inside(t.position))
          angles.push_back(between_lines(t.normal, NoisyTube::normal(t.position)));
      return median(angles);
    };
    std::vector<Token> plain, plane(places.size()), wider(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Point3& p = places[i];
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      tree.for_each_within(p, vote.decay.reach() * kScale, [&](const Neighbor& n) {
        const Eigen::Vector3d u = p - tube.points[static_cast<std::size_t>(n.index)];
        if (n.distance2 > 0.0)
          sum += ball_vote(vote.decay, u / n.distance(), n.distance() / kScale);
      });
      plain.push_back(decomposed(p, sum));
      plane[i].position = wider[i].position = p;
      plane[i].normal = plane_normal(tree, tube.points, p, SheetTokens{}.reach * kScale);
      wider[i].normal = plane_normal(tree, tube.points, p, vote.decay.reach() * kScale);
    }
    once.add(error(plain));
    planes.add(error(plane));
    wide.add(error(wider));
    balls.add(error(vote.sticks_and_plates(reduced_tokens(vote, vote.balls(tube.points)), places)));
    sheets.add(error(SheetTokens{.scale = kScale}(tube.points)));
    dense.add(error(vote.sticks_and_plates(cloud_tokens(tube.points).tokens, places)));
  });
  char name[64];
  std::snprintf(name, sizeof name, "tube, noise %.1f cm", 100.0 * noise);
  begin_row("orientation_deg", name);
  once.print("balls_plain");
  balls.print("balls_refined");
  sheets.print("sheet_tokens");
  dense.print("votes_of_sheet_tokens");
  planes.print("pca_radius_of_sheets");
  wide.print("pca_radius_of_votes");
  end_row();
}

/// 50 000 points on the unit cube with 5 mm of noise, neighbourhoods of about 50 points: median
/// errors and microseconds a point. `inner`: points farther than a neighbourhood from all edges.
void cube() {
  constexpr std::size_t kCount = 50000;
  // Of a plane with this density, 50 points lie so near.
  const double radius = std::sqrt(50.0 * 6.0 / (kPi * static_cast<double>(kCount)));
  struct Method {
    Figure all, inner, time;
  };
  Method planes, sheets, balls, raised;
  for_each_seed([&](std::uint64_t seed) {
    Random random(mix64(seed) ^ 0xcbeULL);
    std::vector<Point3> points;
    std::vector<Eigen::Vector3d> normals;
    std::vector<std::uint8_t> inner;
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto axis = static_cast<Eigen::Index>(random.below(3));
      Point3 p(random.uniform(), random.uniform(), random.uniform());
      p[axis] = random.below(2) == 0 ? 0.0 : 1.0;
      const auto off = [&](Eigen::Index k) {
        return std::min(p[(axis + k) % 3], 1.0 - p[(axis + k) % 3]);
      };
      inner.push_back(off(1) > radius && off(2) > radius ? 1 : 0);
      points.push_back(p);
      normals.push_back(Eigen::Vector3d::Unit(axis));
    }
    add_noise(points, 0.005, seed);
    const KdTree index(points);  // which point a token was
    const auto take = [&](Method& m, double seconds, std::size_t count, const auto& normal,
                          const auto& of) {
      m.time.add(1e6 * seconds / static_cast<double>(kCount));
      std::vector<double> all, within;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t source = of(i);
        const double angle = between_lines(normal(i), normals[source]);
        all.push_back(angle);
        if (inner[source] != 0) within.push_back(angle);
      }
      m.all.add(median(all));
      m.inner.add(median(within));
    };
    const auto itself = [](std::size_t i) { return i; };
    auto begin = Clock::now();
    const auto plane = plane_normals(points, {.neighbors = 50});
    take(
        planes, seconds_since(begin), kCount,
        [&](std::size_t i) { return Eigen::Vector3d(plane[i].cast<double>()); }, itself);
    // The same points in reach, and the same in the middle of the weight.
    begin = Clock::now();
    const auto moved = SheetTokens{.scale = radius / 2.5}(points);
    take(
        sheets, seconds_since(begin), kCount, [&](std::size_t i) { return moved[i].normal; },
        itself);
    begin = Clock::now();
    const auto wide = SheetTokens{.scale = std::sqrt(2.0) * radius / 2.5}(points);
    take(
        raised, seconds_since(begin), kCount, [&](std::size_t i) { return wide[i].normal; },
        itself);
    begin = Clock::now();
    const TensorVoting<> vote{{.scale = radius / 3.0}, {}};
    const auto tokens = vote.refined(points);
    take(
        balls, seconds_since(begin), tokens.size(), [&](std::size_t i) { return tokens[i].normal; },
        [&](std::size_t i) {
          return static_cast<std::size_t>(index.nearest(tokens[i].position)->index);
        });
  });
  const auto print = [&](const char* name, const Method& m) {
    begin_row("cube", name);
    m.all.print("median_all_deg");
    m.inner.print("median_inner_deg");
    m.time.print("us_a_point");
    end_row();
  };
  print("PCA, k = 50", planes);
  print("sheets, 50 in reach", sheets);
  print("sheets, 100 in reach, 50 by weight", raised);
  print("balls and second round, 50 in reach", balls);
}

void folds() {
  for (const double share : {0.1, 0.2, 0.3}) {
    Figure f1, precision, recall, tangent;
    for_each_seed([&](std::uint64_t seed) {
      const TriangleMesh l = l_shape(0.05);
      std::vector<Point3> points =
          sample_surface(l, {.density = kDensity, .seed = seed}).cloud.points;
      add_noise(points, share * kScale, seed);
      const CloudTokens cloud = cloud_tokens(points);
      double hits = 0.0, false_alarms = 0.0, missed = 0.0;
      std::vector<double> askew;
      for (std::size_t i = 0; i < cloud.tokens.size(); ++i) {
        const Point3& p = cloud.tokens[i].position;
        const bool truth = std::hypot(p.x(), p.z()) < 0.5 * kScale, edge = cloud.edge[i] != 0;
        hits += truth && edge ? 1.0 : 0.0;
        false_alarms += !truth && edge ? 1.0 : 0.0;
        missed += truth && !edge ? 1.0 : 0.0;
        if (truth && edge)
          askew.push_back(between_lines(cloud.tokens[i].tangent, Eigen::Vector3d::UnitY()));
      }
      f1.add(2.0 * hits / (2.0 * hits + false_alarms + missed));
      precision.add(hits / (hits + false_alarms));
      recall.add(hits / (hits + missed));
      tangent.add(median(askew));
    });
    char name[64];
    std::snprintf(name, sizeof name, "90 degree L, noise %.1f scales", share);
    begin_row("edges", name);
    f1.print("f1");
    precision.print("precision");
    recall.print("recall");
    tangent.print("tangent_median_deg");
    std::printf(", \"least_f1\": %.4f", *std::min_element(f1.values.begin(), f1.values.end()));
    end_row();
  }
  Figure share, with_ends;
  for_each_seed([&](std::uint64_t seed) {
    const NoisyTube tube(seed, 0.2, 0.2 * kScale);
    const CloudTokens cloud = cloud_tokens(tube.points);
    double edges = 0.0, tokens = 0.0, all = 0.0;
    for (std::size_t i = 0; i < cloud.tokens.size(); ++i) {
      all += cloud.edge[i];
      if (!tube.inside(cloud.tokens[i].position)) continue;
      tokens += 1.0;
      edges += cloud.edge[i];
    }
    share.add(100.0 * edges / tokens);
    with_ends.add(100.0 * all / static_cast<double>(cloud.tokens.size()));
  });
  begin_row("edges", "tube of 0.2 m, noise 0.2 scales");
  share.print("false_percent");
  with_ends.print("false_percent_with_open_ends");
  end_row();
}

/// Angles off the square [deg] at which paths pass over folds of the true surface: edges of more
/// than 75 degrees, and gentler ones of more than 45.
struct TrueCrossings {
  Figure convex, concave, gentle;
  std::size_t unseen = 0;  ///< Edges within a scale of which the path knows of none.
};
void true_crossings(const cloud_navigation::Truth& truth, const SmoothPath& path,
                    TrueCrossings& found) {
  std::vector<Point3> line;
  for (const OrientedPoint& p : path.points) line.push_back(p.position);
  line = detail::divided(line, 0.005);
  constexpr std::size_t kBeside = 4;  // 2 cm of path on either side
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto near = truth.bvh.closest_point(line[i]);
    const Eigen::Vector3d n =
        truth.mesh.area_vector(static_cast<std::size_t>(near->triangle)).normalized();
    if (i > kBeside && i + kBeside < line.size() && last.dot(n) < std::cos(radians(45.0))) {
      const Eigen::Vector3d t = last.cross(n).normalized();
      const Eigen::Vector3d before = line[i - 1] - line[i - 1 - kBeside],
                            after = line[i + kBeside] - line[i];
      const auto off = [&](const Eigen::Vector3d& step) {
        return step.norm() > 0.0
                   ? degrees(std::asin(std::min(1.0, std::abs(step.normalized().dot(t)))))
                   : 0.0;
      };
      const double angle = std::max(off(before), off(after));
      if (last.dot(n) > std::cos(radians(75.0))) {
        found.gentle.add(angle);
      } else {
        ((n - last).dot(before + after) > 0.0 ? found.convex : found.concave).add(angle);
        const bool seen =
            std::any_of(path.crossings.begin(), path.crossings.end(), [&](const EdgeCrossing& c) {
              return (path.points[c.point].position - line[i]).norm() < kScale;
            });
        found.unseen += seen ? 0U : 1U;
      }
    }
    last = n;
  }
}
/// The length of a path's shadow on the true surface, and how far it lies from that [m].
double shadow_length(const cloud_navigation::Truth& truth, const SmoothPath& path, Figure& off) {
  std::vector<Point3> line;
  for (const OrientedPoint& p : path.points) line.push_back(p.position);
  line = detail::divided(line, 0.005);
  double length = 0.0;
  Point3 last = Point3::Zero();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Point3 on = truth.bvh.closest_point(line[i])->point;
    off.add((on - line[i]).norm());
    if (i > 0) length += (on - last).norm();
    last = on;
  }
  return length;
}

struct CloudScene {
  std::string name;
  const char* surface;
  double edge;               ///< Of the mesh [m].
  std::vector<double> from;  ///< Stations of the rotating lidar; none: samples.
};

void paths(const CloudScene& scene) {
  Figure plain, smooth, shadow, off, search, voting, cells_held;
  TrueCrossings met;
  std::size_t asked = 0, found_both = 0, differ = 0, compared = 0, no_path = 0, low = 0, steps = 0,
              crossings = 0;
  double dearer = 0.0;
  for_each_seed([&](std::uint64_t seed) {
    CloudNavigation s;
    s.scene = scene.surface;
    s.edge = scene.edge;
    s.seed = seed;
    s.cloud_noise = 0.1 * kScale;
    s.scan_from = scene.from;
    if (!scene.from.empty()) s.spacing = 0.0167;
    const auto in = cloud_navigation::usable_input(s);
    const auto begin = Clock::now();
    const CloudTokens tokens = cloud_tokens(in.cloud.points);
    const FeatureMaps maps(tokens, kScale);
    voting.add(seconds_since(begin));
    cells_held.add(static_cast<double>(maps.cells().size()));
    DensePlannerOptions near;
    near.costs = {1.0, 0.0, 0.0, 0.0};
    const DensePlanner planner(maps), shortest(maps, near);
    Random random(mix64(seed) ^ 0x9a17ULL);
    const auto anywhere = [&] {  // but on an edge
      for (;;) {
        const Token& t = tokens.tokens[random.below(tokens.tokens.size())];
        const auto cell = planner.cell_at(t.position, kVoxel);
        if (cell && !maps[*cell].edge) return *cell;
      }
    };
    constexpr int kGoals = 10;
    for (int begun = 0; begun < g_pairs; begun += kGoals) {
      const std::int32_t start = anywhere();
      std::vector<std::int32_t> goals;
      while (goals.size() < kGoals) {
        const std::int32_t g = anywhere();
        if ((maps[g].position - maps[start].position).norm() > 10.0 * kVoxel) goals.push_back(g);
      }
      // Dijkstra over the same graph, once a seed: what it reaches and at what cost.
      std::vector<double> least(maps.cells().size(), 1e300);
      if (begun == 0) {
        std::vector<Source> sources;
        for (int h = 0; h < DensePlanner::kHeadings; ++h)
          sources.push_back({start * DensePlanner::kHeadings + h, 0.0});
        shortest_paths(planner, std::span<const Source>(sources), NoHeuristic{},
                       [&](std::int32_t node, double cost) {
                         double& c =
                             least[static_cast<std::size_t>(node / DensePlanner::kHeadings)];
                         c = std::min(c, cost);
                         return false;
                       });
      }
      for (const std::int32_t goal : goals) {
        ++asked;
        const auto searching = Clock::now();
        const auto path = planner(start, goal);
        search.add(seconds_since(searching));
        if (begun == 0) {
          ++compared;
          const double cost = least[static_cast<std::size_t>(goal)];
          differ += path.has_value() != (cost < 1e200) ? 1U : 0U;
          if (path) dearer = std::max(dearer, std::abs(path->cost - cost) / (1.0 + cost));
        }
        const auto straight = shortest(start, goal);
        if (!path || !straight) {
          ++no_path;
          continue;
        }
        for (const std::int32_t c : path->cells) low += planner.is_surface(c) ? 0U : 1U;
        steps += path->cells.size();
        const auto direct = in.truth->distance(maps[start].position, maps[goal].position);
        const SmoothPath shortened = smoothed(planner, tokens, *path);
        const auto exact =
            in.truth->distance(shortened.points.front().position, shortened.points.back().position);
        if (!direct || !exact || *direct < 5.0 * kVoxel || *exact < 5.0 * kVoxel) continue;
        ++found_both;
        plain.add(straight->length / *direct);
        smooth.add(shortened.length() / *exact);
        shadow.add(shadow_length(*in.truth, shortened, off) / *exact);
        true_crossings(*in.truth, shortened, met);
        crossings += shortened.crossings.size();
      }
    }
  });
  begin_row("paths", scene.name);
  std::printf(
      ", \"pairs\": %zu, \"measured\": %zu, \"no_path\": %zu, \"compared_with_dijkstra\": %zu, "
      "\"found_otherwise\": %zu, \"cost_off_most\": %.3g, \"low_cells\": %zu, \"cells_entered\": "
      "%zu, \"edge_crossings\": %zu, \"unseen_edges_crossed\": %zu",
      asked, found_both, no_path, compared, differ, dearer, low, steps, crossings, met.unseen);
  plain.print("distance_only_over_exact");
  smooth.print("smoothed_over_exact");
  shadow.print("shadow_on_surface_over_exact");
  for (double& v : off.values) v *= 1000.0;
  off.print("off_surface_mm");
  met.convex.print("attack_convex_deg");
  met.concave.print("attack_concave_deg");
  met.gentle.print("attack_folds_45_to_75_deg");
  search.print("search_s");
  voting.print("voting_s");
  cells_held.print("cells");
  end_row();
}

/// 32 000 points of the mock-up to the smoothed path from its one end to the other.
void whole_time() {
  const TriangleMesh mesh = mock_up();
  const double density = 32000.0 / mesh.area();
  Figure one, two, ratio, length;
  std::size_t points = 0, tokens = 0, cells = 0;
  for_each_seed([&](std::uint64_t seed) {
    PointCloud cloud = sample_surface(mesh, {.density = density, .seed = seed}).cloud;
    add_noise(cloud.points, 0.1 * kScale, seed);
    const auto run = [&](int threads) {
      const auto begin = Clock::now();
      CloudTokenOptions voting;
      voting.threads = threads;
      const CloudTokens found = cloud_tokens(cloud.points, voting);
      FeatureMapOptions mapping;
      mapping.threads = threads;
      const FeatureMaps maps(found, kScale, mapping);
      DensePlannerOptions planning;
      planning.threads = threads;
      const DensePlanner planner(maps, planning);
      const auto from = planner.cell_at({0.1, 0.0, -0.4}, 0.1),
                 to = planner.cell_at({2.3, 0.0, 0.5}, 0.1);
      require(from && to, "time: no surface at the mock-up's ends");
      const auto path = planner(*from, *to);
      require(path.has_value(), "time: no path from one end of the mock-up to the other");
      length.add(smoothed(planner, found, *path).length());
      points = cloud.size();
      tokens = found.tokens.size();
      cells = maps.cells().size();
      return seconds_since(begin);
    };
    one.add(run(1));
    two.add(run(2));
    ratio.add(one.values.back() / two.values.back());
  });
  begin_row("time", "mock-up, cells of 3.5 cm");
  std::printf(", \"points\": %zu, \"tokens\": %zu, \"cells\": %zu", points, tokens, cells);
  one.print("one_thread_s");
  two.print("two_threads_s");
  ratio.print("one_over_two");
  length.print("path_m");
  end_row();
}

/// From about 25 000 triangles to 1 000.
void simplification(const char* name, const TriangleMesh& mesh) {
  Figure time;
  TriangleMesh less;
  for (int k = 0; k < std::min(5, g_seeds.count); ++k) {
    const auto begin = Clock::now();
    less = simplified(mesh, {.triangles = 1000});
    time.add(seconds_since(begin));
  }
  const Bvh bvh(mesh);
  std::size_t flips = 0;
  Figure error;
  for (std::size_t t = 0; t < less.triangles.size(); ++t) {
    const auto near = bvh.closest_point(less.centroid(t));
    error.add(1000.0 * near->distance);
    flips +=
        less.area_vector(t).dot(mesh.area_vector(static_cast<std::size_t>(near->triangle))) < 0.0
            ? 1U
            : 0U;
  }
  begin_row("simplify", name);
  std::printf(
      ", \"from\": %zu, \"to\": %zu, \"flips\": %zu, \"borders_before\": %zu, \"borders_after\": "
      "%zu, \"non_manifold\": %zu",
      mesh.triangles.size(), less.triangles.size(), flips, mesh_borders(mesh).size(),
      mesh_borders(less).size(), MeshAdjacency(less).non_manifold_edges().size());
  time.print("time_s");
  error.print("error_mm");
  end_row();
}

int run(int argc, char** argv) {
  cli::Options app("Normals, edges, paths and simplification of raw clouds. Prints JSON.");
  std::string only;
  g_seeds.declare(app);
  app.add("--pairs", g_pairs, "starts and goals for each seed");
  app.add("--only", only,
          "orientation, cube, edges, paths, time, simplify, or paths:SCENE, as \"paths:torus, "
          "samples\"");
  app.parse(argc, argv);
  g_seeds.check();
  require(g_pairs >= 10, "--pairs: expected at least 10");
  const auto wanted = [&](const std::string& part) { return only.empty() || only == part; };
  std::vector<double> inside_chest;
  for (const Point3& p : scanned_surface::steam_chest_stations())
    inside_chest.insert(inside_chest.end(), p.data(), p.data() + 3);
  const std::vector<CloudScene> scenes{
      {"slope, samples", "bumpy_slope", 0.02, {}},
      {"torus, samples", "torus", 0.03, {}},
      {"steam chest, samples", "steam_chest", 0.04, {}},
      {"mock-up, samples", "mock_up", 0.03, {}},
      {"slope, scans",
       "bumpy_slope",
       0.02,
       {-0.3, 0.6, 1.2, 1.5, 0.6, 1.4, 0.6, -0.3, 1.2, 0.6, 1.5, 1.2}},
      {"mock-up, scans", "mock_up", 0.03, {0.4, 0, 0, 1.4, 0, 0, 2.15, 0, 0, 0.95, 0, 0.3}},
      {"steam chest, scans", "steam_chest", 0.04, inside_chest}};
  std::vector<std::string> parts{"orientation", "cube", "edges", "paths", "time", "simplify"};
  for (const CloudScene& scene : scenes) parts.push_back("paths:" + scene.name);
  require(only.empty() || std::find(parts.begin(), parts.end(), only) != parts.end(),
          "--only " + only + ": not known; expected one of those that --help tells");
  std::printf("[");
  if (wanted("orientation"))
    for (const double noise : {0.005, 0.018, 0.028}) orientation(noise);
  if (wanted("cube")) cube();
  if (wanted("edges")) folds();
  for (const CloudScene& scene : scenes)
    if (wanted("paths") || only == "paths:" + scene.name) paths(scene);
  if (wanted("time")) whole_time();
  if (wanted("simplify")) {
    simplification("sphere", make_sphere(Point3::Zero(), 1.0, 5));
    simplification("steam chest", clean_surface(steam_chest(0.036)));
  }
  std::printf("]\n");
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return cli::run("surface_clouds", [&] { return run(argc, argv); });
}
