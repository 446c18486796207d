// SPDX-License-Identifier: MIT
#include <surfleet/surface/cloud_tokens.hpp>
#include <surfleet/surface/creases.hpp>
#include <surfleet/surface/feature_maps.hpp>

#include <surfleet/core/random.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

double between_lines(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), std::abs(a.dot(b))));
}
/// Two plates that meet at a right angle in the y axis, with noise along each axis.
std::vector<Point3> noisy_l(std::uint64_t seed, double noise, std::size_t count = 3000) {
  Random random(seed);
  std::vector<Point3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = random.uniform(0, 0.5), y = random.uniform(-0.4, 0.4);
    Eigen::Vector3d off;
    for (const int k : {2, 1, 0}) off[k] = random.normal();
    points.push_back((i % 2 == 0 ? Point3(s, y, 0) : Point3(0, y, -s)) + noise * off);
  }
  return points;
}
bool is_inside(const Point3& p) {  // away from the borders
  return std::abs(p.y()) < 0.25 && p.x() < 0.4 && p.z() > -0.4;
}

TEST(creases_are_where_planes_meet) {
  for (const double noise : {0.0, 0.006, 0.012}) {
    const std::vector<Point3> points = noisy_l(3, noise);
    std::vector<Eigen::Vector3d> normals;
    for (const Token& t : SheetTokens{.reach = 2.0, .rounds = 1}(points))
      normals.push_back(t.normal);
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (is_inside(points[i])) places.push_back(i);
    CreaseFinder finder;
    const std::vector<Crease> creases = finder(points, normals, places);
    finder.threads = 3;
    const std::vector<Crease> again = finder(points, normals, places);
    double error = 0.0;
    int near = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Point3& p = points[places[k]];
      const double d = std::hypot(p.x(), p.z());
      CHECK(again[k].distance == creases[k].distance && again[k].normal == creases[k].normal);
      if (d > 0.2) CHECK(creases[k].share < 0.05);
      if (d > 0.06) continue;
      if (d < 0.03) CHECK(creases[k].share > 0.06);
      CHECK(between_lines(creases[k].tangent, Eigen::Vector3d::UnitY()) < 4.0);
      error += std::abs(creases[k].distance - d);
      ++near;
    }
    CHECK(near > 100 && error / near < (noise == 0.0 ? 0.006 : 0.014));
  }
  CHECK_THROWS(Error, CreaseFinder{.scale = 0.0}({}, {}, {}));
  CHECK(CreaseFinder{}({}, {}, {}).empty());
}

TEST(edge_tokens_of_an_l_and_none_of_a_tube) {
  int hits = 0, false_alarms = 0, missed = 0, plain = 0, askew = 0;
  const CloudTokens l = cloud_tokens(noisy_l(5, 0.006));
  for (std::size_t i = 0; i < l.tokens.size(); ++i) {
    const Token& t = l.tokens[i];
    if (!is_inside(t.position)) continue;
    const bool truth = std::hypot(t.position.x(), t.position.z()) < 0.03, edge = l.edge[i] != 0;
    hits += truth && edge ? 1 : 0;
    false_alarms += !truth && edge ? 1 : 0;
    missed += truth && !edge ? 1 : 0;
    const Eigen::Vector3d normal =
        t.position.x() > -t.position.z() ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    if (std::hypot(t.position.x(), t.position.z()) < 0.045) continue;
    ++plain;
    askew += between_lines(t.normal, normal) > 15.0 ? 1 : 0;
  }
  CHECK(plain > 150 && askew <= plain / 30);
  CHECK(hits > 4 && 2.0 * hits / (2.0 * hits + false_alarms + missed) > 0.8);

  Random random(2);
  std::vector<Point3> tube;
  for (int i = 0; i < 3500; ++i) {
    const double a = random.uniform(-kPi, kPi);
    const Eigen::Vector3d off{random.normal(), random.normal(), random.normal()};
    tube.push_back(Point3(0.2 * std::cos(a), 0.2 * std::sin(a), random.uniform(0, 0.8)) +
                   0.012 * off);
  }
  CloudTokenOptions options;
  const CloudTokens bent = cloud_tokens(tube, options);
  int edges = 0;
  for (std::size_t i = 0; i < bent.tokens.size(); ++i)
    edges += bent.edge[i] != 0 && std::abs(bent.tokens[i].position.z() - 0.4) < 0.25 ? 1 : 0;
  CHECK(bent.tokens.size() > 400 && edges <= 4);
  options.threads = 3;
  const CloudTokens threaded = cloud_tokens(tube, options);
  CHECK(threaded.edge == bent.edge && threaded.tokens.size() == bent.tokens.size());
  for (std::size_t i = 0; i < bent.tokens.size(); ++i)
    CHECK(threaded.tokens[i].position == bent.tokens[i].position &&
          threaded.tokens[i].stick == bent.tokens[i].stick);
  options.first = FirstRound::balls;
  options.edge_threshold = 0.25;
  const CloudTokens printed = cloud_tokens(noisy_l(5, 0.003), options);
  int at_crease = 0, elsewhere = 0;
  for (std::size_t i = 0; i < printed.tokens.size(); ++i) {
    if (printed.edge[i] == 0 || !is_inside(printed.tokens[i].position)) continue;
    const double d = std::hypot(printed.tokens[i].position.x(), printed.tokens[i].position.z());
    (d < 0.05 ? at_crease : elsewhere) += 1;
  }
  CHECK(at_crease > 5 && elsewhere < at_crease / 4);
}

TEST(feature_maps_of_an_l) {
  const std::vector<Point3> points = noisy_l(7, 0.003);
  const CloudTokens tokens = cloud_tokens(points);
  const FeatureMaps maps(tokens, 0.06, {.voxel = 0.03});
  double best = 0.0, sticks = 0.0, saliencies = 0.0;
  int edges = 0, crossed = 0, flat = 0, off = 0;
  for (std::size_t i = 0; i < maps.cells().size(); ++i) {
    const FeatureCell& c = maps.cells()[i];
    CHECK(maps.find(c.index) == static_cast<std::int32_t>(i));
    CHECK((c.position - 0.03 * (c.index.cast<double>() + Point3(0.5, 0.5, 0.5))).norm() < 1e-12);
    best = std::max(best, c.surface);
    double nearest = 1e9;
    for (const Token& t : tokens.tokens)
      nearest = std::min(nearest, (t.position - c.position).norm());
    CHECK(nearest <= 0.045 + 1e-12);
    if (!is_inside(c.position)) continue;
    const double d = std::hypot(c.position.x(), c.position.z());
    if (d > 0.19) {  // cells at the rim of the band know less
      const bool level = c.position.x() > 0.07;
      ++flat;
      off += between_lines(c.normal, level ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()) >
                     10.0
                 ? 1
                 : 0;
    }
    if (d > 0.13) CHECK(!c.edge);
    if (d < 0.03) {
      sticks += c.surface;
      saliencies += c.saliency();
    }
    if (!c.edge) CHECK(c.saliency() == c.surface);
    if (!c.edge) continue;
    ++edges;
    crossed += between_lines(c.tangent, Eigen::Vector3d::UnitY()) < 6.0 ? 1 : 0;
  }
  CHECK(flat > 300 && off < flat / 20);
  CHECK(edges > 10 && crossed == edges);
  CHECK(saliencies > 2.0 * sticks);  // in the fold the votes of two sheets, not their difference
  CHECK(maps.greatest_saliency() == best && best > 0.0);
  CHECK(maps.find({1000, 0, 0}) == -1);
  CHECK(!maps.near({0.2, 0, 0}, 0.05).empty() && maps.near({0.2, 0, 5}, 0.05).empty());

  const FeatureMaps wide(tokens, 0.06, {.voxel = 0.03, .inflation = 0.1, .threads = 3});
  CHECK(wide.cells().size() == maps.cells().size());
  for (std::size_t i = 0; i < maps.cells().size(); ++i) {
    const FeatureCell &a = maps.cells()[i], &b = wide.cells()[i];
    CHECK(a.surface == b.surface && (!a.edge || b.edge));
    const double d = std::hypot(a.position.x(), a.position.z());
    if (is_inside(a.position) && d < 0.08) CHECK(b.edge);
    if (is_inside(a.position) && d > 0.15) CHECK(!b.edge);
  }
}

TEST(odd_clouds_have_feature_maps) {
  const FeatureMaps none(cloud_tokens(std::vector<Point3>{}), 0.06);
  CHECK(none.cells().empty() && none.greatest_saliency() == 0.0);
  const std::vector<Point3> one(3, Point3(1, 2, 3));
  CHECK(FeatureMaps(cloud_tokens(one), 0.06).cells().empty());
  std::vector<Point3> line;
  for (int i = 0; i < 40; ++i) line.push_back({0.02 * i, 0, 0});
  CHECK(!FeatureMaps(cloud_tokens(line), 0.06).cells().empty());
  const CloudTokens l = cloud_tokens(noisy_l(7, 0.003, 500));
  CHECK_THROWS(Error, FeatureMaps(l, 0.06, {.voxel = 0.0}));
  CHECK_THROWS(Error, FeatureMaps(l, 0.06, {.voxel = 1e-9}));
  CHECK_THROWS(Error, cloud_tokens(line, {.edge_threshold = 2.0}));
  line.push_back({std::nan(""), 0, 0});
  CHECK_THROWS(Error, cloud_tokens(line));
}
}  // namespace
