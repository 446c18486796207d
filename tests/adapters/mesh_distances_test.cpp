// SPDX-License-Identifier: MIT
// Four that measure how far a mesh is, on meshes as people have them: FCL, Embree, our own tree,
// and every triangle one by one in long double.
#include <surfleet/adapters/embree_ray_caster.hpp>
#include <surfleet/adapters/fcl_mesh_judge.hpp>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/ellipsoid.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
using Long = long double;
using LongVector = Eigen::Matrix<Long, 3, 1>;

Long to_segment(const LongVector& p, const LongVector& a, const LongVector& b) {
  const LongVector ab = b - a;
  const Long l2 = ab.dot(ab);
  const Long t = l2 > 0 ? std::min<Long>(1, std::max<Long>(0, (p - a).dot(ab) / l2)) : 0;
  const LongVector d = a + t * ab - p;
  return std::sqrt(d.dot(d));
}
double brute_distance(const TriangleMesh& mesh, const Point3& at) {
  Long least = std::numeric_limits<Long>::infinity();
  const LongVector p = at.cast<Long>();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const LongVector a = mesh.corner(t, 0).cast<Long>(), b = mesh.corner(t, 1).cast<Long>(),
                     c = mesh.corner(t, 2).cast<Long>();
    if (!(a.allFinite() && b.allFinite() && c.allFinite())) continue;
    least = std::min({least, to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
    const LongVector ab = b - a, ac = c - a, ap = p - a, n = ab.cross(ac);
    const Long n2 = n.dot(n);
    if (!(n2 > 0)) continue;
    const Long v = n.dot(ap.cross(ac)) / n2, w = n.dot(ab.cross(ap)) / n2;
    if (v >= 0 && w >= 0 && v + w <= 1)
      least = std::min(least, std::abs(n.dot(ap)) / std::sqrt(n2));
  }
  return static_cast<double>(least);
}

/// What Embree's own search finds, in single precision about the mesh's centre.
class EmbreeDistance {
 public:
  explicit EmbreeDistance(const TriangleMesh& mesh) : device_(rtcNewDevice("threads=1")) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<Point3, 3> c{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
      if (c[0].allFinite() && c[1].allFinite() && c[2].allFinite()) triangles_.push_back(c);
    }
    Box3 box;
    for (const auto& c : triangles_)
      for (const Point3& p : c) box.extend(p);
    center_ = box.center();
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(triangles_.size()));
    rtcSetGeometryUserData(g, this);
    rtcSetGeometryBoundsFunction(g, bounds_of, nullptr);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene_, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene_);
  }
  EmbreeDistance(const EmbreeDistance&) = delete;
  ~EmbreeDistance() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  /// Embree finds the candidates; each is measured in long double.
  double operator()(const Point3& at) const {
    RTCPointQuery query{};
    const Eigen::Vector3f p = (at - center_).cast<float>();
    query.x = p.x();
    query.y = p.y();
    query.z = p.z();
    query.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Search search{this, at, std::numeric_limits<double>::infinity()};
    rtcPointQuery(scene_, &query, &context, closer, &search);
    return search.least;
  }

 private:
  struct Search {
    const EmbreeDistance* self;
    Point3 at;
    double least;
  };
  static void bounds_of(const RTCBoundsFunctionArguments* args) {
    const auto& self = *static_cast<const EmbreeDistance*>(args->geometryUserPtr);
    Box3 box;
    for (const Point3& p : self.triangles_[args->primID]) box.extend(p - self.center_);
    const auto low = [](double x) { return std::nextafter(static_cast<float>(x), -1e30F); };
    const auto high = [](double x) { return std::nextafter(static_cast<float>(x), 1e30F); };
    args->bounds_o->lower_x = low(box.min().x());
    args->bounds_o->lower_y = low(box.min().y());
    args->bounds_o->lower_z = low(box.min().z());
    args->bounds_o->upper_x = high(box.max().x());
    args->bounds_o->upper_y = high(box.max().y());
    args->bounds_o->upper_z = high(box.max().z());
  }
  static bool closer(RTCPointQueryFunctionArguments* args) {
    auto& search = *static_cast<Search*>(args->userPtr);
    TriangleMesh one;
    const auto& c = search.self->triangles_[args->primID];
    one.vertices.assign(c.begin(), c.end());
    one.triangles = {{0, 1, 2}};
    const double d = brute_distance(one, search.at);
    if (d >= search.least) return false;
    search.least = d;
    args->query->radius = static_cast<float>(d * 1.00001);
    return true;
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<std::array<Point3, 3>> triangles_;
  Point3 center_ = Point3::Zero();
};

void add(TriangleMesh& mesh, const Point3& a, const Point3& b, const Point3& c) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}
Point3 draw(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Every measure within what it promises; `size` is that of the mesh.
void measures_agree(const std::string& name, const TriangleMesh& mesh, double size,
                    std::uint64_t seed, int queries = 250) {
  const MeshJudge judge(mesh);
  const Bvh bvh(mesh);
  const EmbreeDistance embree(mesh);
  const Point3 middle = bvh.bounds().center();
  Random random(seed);
  double fcl_off = 0.0, bvh_off = 0.0, embree_off = 0.0;
  for (int i = 0; i < queries; ++i) {
    // Far, near, and on the surface.
    Point3 p = middle + draw(random, i % 3 == 0 ? 3.0 * size : size);
    if (i % 3 == 2) p = bvh.closest_point(p)->point + draw(random, 1e-3 * size);
    const double exact = brute_distance(mesh, p);
    fcl_off = std::max(fcl_off, std::abs(judge.distance(p) - exact));
    bvh_off = std::max(bvh_off, std::abs(bvh.distance(p) - exact));
    embree_off = std::max(embree_off, std::abs(embree(p) - exact));
    const double radius = random.uniform(0.1, 1.0) * size;
    if (std::abs(exact - radius) > 1e-4 * size)
      CHECK(judge.collides(p, radius) == (exact < radius));
  }
  const double far = middle.norm() * 1e-14;  // the coordinates' own digits
  if (!(fcl_off < 1e-5 * size + 2.0 * MeshJudge::kRadius && bvh_off < 1e-7 * size + far &&
        embree_off < 1e-6 * size + far)) {
    const std::string said = name + ": off by FCL " + std::to_string(fcl_off) + ", own " +
                             std::to_string(bvh_off) + ", Embree " + std::to_string(embree_off);
    check::report(false, __FILE__, __LINE__, said.c_str());
  }
}

/// A triangle's third corner this share of its longest edge off that edge.
TriangleMesh slivers(double flatness, double size, std::uint64_t seed, int count = 60) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Point3 a = draw(random, size), b = draw(random, size);
    const Eigen::Vector3d off = (b - a).unitOrthogonal() * (b - a).norm() * flatness;
    const Point3 c = a + random.uniform(-0.2, 1.2) * (b - a) + off;
    if (i % 3 == 0) add(mesh, a, b, c);
    if (i % 3 == 1) add(mesh, b, c, a);
    if (i % 3 == 2) add(mesh, c, a, b);
  }
  return mesh;
}
TriangleMesh shifted(TriangleMesh mesh, const Eigen::Vector3d& by) {
  for (Point3& v : mesh.vertices) v += by;
  return mesh;
}
TriangleMesh scaled(TriangleMesh mesh, double by) {
  for (Point3& v : mesh.vertices) v *= by;
  return mesh;
}
/// Houses' worth of everything that is wrong with meshes.
TriangleMesh dirty_mesh(std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh = make_box({-4, -3, -2}, {1, 2, 3});
  append(mesh, make_box({-4, -3, -2}, {1, 2, 3}));  // all twice
  append(mesh, make_box({0, 1, -2}, {4, 4, 3}));    // through each other
  for (int i = 0; i < 12; ++i) {                    // overlapping in one plane
    const auto in_plane = [&] { return Point3(random.uniform(-5, 5), random.uniform(-5, 5), 3.0); };
    add(mesh, in_plane(), in_plane(), in_plane());
  }
  for (const double flatness : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
    append(mesh, slivers(flatness, 6.0, seed + 7, 6));
  const Point3 a = draw(random, 5), b = draw(random, 5);
  add(mesh, a, a, b);  // edges without length
  add(mesh, b, a, b);
  add(mesh, b, b, b);  // and nothing at all
  const double nan = std::numeric_limits<double>::quiet_NaN();
  add(mesh, {nan, 0, 0}, {0, 0, 9}, {0, 9, 9});
  add(mesh, {0, 0, std::numeric_limits<double>::infinity()}, {0, 0, 9}, {0, 9, 9});
  return mesh;
}
}  // namespace

TEST(a_ball_is_as_far_from_three_points_on_a_line_as_it_is) {
  TriangleMesh mesh;
  add(mesh, {29.3834228515625, -10.482277870178223, 0}, {29.3834228515625, -2.0642449855804443, 0},
      {29.3834228515625, -2.7347078323364258, 0});
  const Point3 p(31.5, 3.2, -0.1);
  const MeshJudge judge(mesh);
  CHECK(judge.triangle_count() == 1 && judge.sliver_count() == 1);
  CHECK_NEAR(brute_distance(mesh, p), 5.6747, 1e-3);
  CHECK_NEAR(judge.distance(p), brute_distance(mesh, p), 1e-5);
  CHECK_NEAR(Bvh(mesh).distance(p), brute_distance(mesh, p), 1e-12);
  CHECK(!judge.collides(p, 5.0) && judge.collides(p, 6.0));
}

TEST(distances_agree_on_slivers) {
  for (const double flatness :
       {0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-7, 1e-6, 5e-6, 2e-5, 1e-4, 1e-3, 1e-2})
    measures_agree("slivers of " + std::to_string(std::log10(flatness)), slivers(flatness, 10.0, 5),
                   10.0, 11);
}

TEST(distances_agree_on_dirty_meshes_of_any_size_anywhere) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TriangleMesh mesh = dirty_mesh(seed);
    CHECK(MeshJudge(mesh).triangle_count() == mesh.triangles.size() - 2);
    CHECK(Bvh(mesh).triangle_count() == mesh.triangles.size() - 2);
    measures_agree("dirty", mesh, 6.0, seed);
    measures_agree("dirty, far off", shifted(mesh, {1e5, -1e5, 5e4}), 6.0, seed);
    measures_agree("dirty, millimetres", scaled(mesh, 1e-3), 6e-3, seed);
    measures_agree("dirty, a county", scaled(mesh, 1e3), 6e3, seed);
  }
  // One triangle of each kind alone: the tree is a leaf.
  for (const double flatness : {0.0, 1e-13, 1e-6, 1e-4, 0.3})
    measures_agree("one", slivers(flatness, 2.0, 9, 1), 2.0, 3);
}

TEST(bodies_meet_dirty_meshes_where_balls_do) {
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e5, 1e5, 1e3)}) {
    const TriangleMesh mesh = shifted(dirty_mesh(4), by);
    const MeshJudge judge(mesh);
    Random random(8);
    int met = 0, asked = 0;
    for (int i = 0; i < 200; ++i) {
      const Point3 p = by + draw(random, 8.0);
      const double exact = brute_distance(mesh, p), radius = random.uniform(0.2, 3.0);
      if (std::abs(exact - radius) < 1e-3) continue;
      Pose at = Pose::Identity();
      at.translate(p);
      fcl::Sphered ball(radius);
      const fcl::Ellipsoidd round(radius, radius, radius);
      CHECK(judge.collides(ball, at) == (exact < radius));
      CHECK(judge.collides(round, at) == (exact < radius));
      ball.computeLocalAABB();
      CHECK(judge.collides(ball, at) == (exact < radius));
      // A box holds its inner ball and is held by its outer one.
      const fcl::Boxd box(radius, radius, radius);
      if (exact < 0.49 * radius) CHECK(judge.collides(box, at));
      if (exact > 0.87 * radius) CHECK(!judge.collides(box, at));
      met += exact < radius ? 1 : 0;
      ++asked;
    }
    CHECK(met > 20);
    CHECK(asked - met > 20);
  }
}
