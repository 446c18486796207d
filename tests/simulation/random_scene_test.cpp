// SPDX-License-Identifier: MIT
#include <surfleet/simulation/random_scene.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include <surfleet/simulation/scenes.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// What makes a mesh dirty.
struct Dirt {
  int duplicates = 0, slivers = 0, lines = 0, twice = 0;
  std::size_t non_manifold = 0;
};
Dirt dirt_of(const TriangleMesh& mesh) {
  Dirt d;
  std::set<std::array<std::int32_t, 3>> seen;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle sorted = mesh.triangles[t];
    std::sort(sorted.begin(), sorted.end());
    if (!seen.insert(sorted).second) ++d.duplicates;
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      ++d.twice;
      continue;
    }
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm());
    const double height = 2.0 * mesh.area(t) / longest;
    if (height < 1e-12) {
      ++d.lines;
    } else if (height < 1e-3 && longest > 50.0 * height) {
      ++d.slivers;
    }
  }
  d.non_manifold = MeshAdjacency(mesh).non_manifold_edges().size();
  return d;
}

/// Six times the volume of each closed part of a mesh.
std::vector<double> volumes(const TriangleMesh& mesh) {
  const TriangleMesh closed = closed_parts(weld_vertices(mesh));
  const MeshComponents parts = connected_components(closed);
  std::vector<double> volume(parts.count, 0.0);
  for (std::size_t t = 0; t < closed.triangles.size(); ++t)
    volume[static_cast<std::size_t>(parts.of_triangle[t])] +=
        closed.corner(t, 0).dot(closed.corner(t, 1).cross(closed.corner(t, 2)));
  return volume;
}

/// The least distance from the axis of a long part that all of it keeps within, and its length; the
/// axis joins the means of the vertices at its two ends.
struct Slender {
  double length = 0.0, radius = 0.0;
};
Slender slender(const TriangleMesh& mesh, const std::vector<std::int32_t>& vertices) {
  const auto at = [&](std::size_t i) {
    return mesh.vertices[static_cast<std::size_t>(vertices[i])];
  };
  std::size_t far = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if ((at(i) - at(0)).norm() > (at(far) - at(0)).norm()) far = i;
  const Eigen::Vector3d rough = (at(far) - at(0)).normalized();
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    low = std::min(low, at(i).dot(rough));
    high = std::max(high, at(i).dot(rough));
  }
  Point3 a = Point3::Zero(), b = Point3::Zero();
  int near_low = 0, near_high = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (at(i).dot(rough) < 0.5 * (low + high)) {
      a += at(i);
      ++near_low;
    } else {
      b += at(i);
      ++near_high;
    }
  }
  Slender s;
  if (near_low == 0 || near_high == 0) return s;
  a /= near_low;
  b /= near_high;
  const Eigen::Vector3d axis = (b - a).normalized();
  s.length = (b - a).norm();
  for (std::size_t i = 0; i < vertices.size(); ++i)
    s.radius = std::max(s.radius, (at(i) - a).cross(axis).norm());
  return s;
}
}  // namespace

TEST(random_scene_names) {
  CHECK(is_random_scene("random:shell:3") && is_random_scene("random:") &&
        is_random_scene("random"));
  CHECK(!is_random_scene("randomised.ply") && !is_random_scene("statue"));
  CHECK((parse_random_scene("random:shell:3") == RandomSceneId{"shell", 3}));
  CHECK(parse_random_scene("random:shell:007").name() == "random:shell:7");
  // Seed N of `all` is kind N mod 7 in the listed order.
  constexpr std::array<std::string_view, 7> kOrder{"plant",  "tower", "lattice", "shell",
                                                   "bridge", "hall",  "hull"};
  for (const std::uint64_t seed : {0ULL, 1ULL, 6ULL, 7ULL, 99ULL, 1000ULL, 1019ULL, 999999999ULL}) {
    const RandomSceneId id = parse_random_scene("random:all:" + std::to_string(seed));
    CHECK(id.kind == kOrder[seed % 7] && id.seed == seed);
  }
  const auto many = parse_random_scenes("random:all:1000-1019");
  CHECK(many.size() == 20 && many.front().kind == "hull" && many.back().seed == 1019);
  CHECK(parse_random_scenes("random:hall:4-4").size() == 1);
  CHECK(parse_random_scenes("random:hall:1-1000").size() == 1000);
  for (const char* bad : {"random",
                          "random:",
                          "random::",
                          "random:shell",
                          "random:shell:",
                          "random::1",
                          "random:Shell:1",
                          "random:castle:1",
                          "random:shell:-1",
                          "random:shell:+1",
                          "random:shell: 1",
                          "random:shell:1 ",
                          "random:shell:1.0",
                          "random:shell:0x1",
                          "random:shell:1:2",
                          "random:shell:one",
                          "random:all:",
                          "random:shell:1000000000",
                          "random:shell:18446744073709551617",
                          "random:shell:1-",
                          "random:shell:-",
                          "random:shell:2-1",
                          "random:shell:1-1001",
                          "random:shell:1-2-3",
                          "random:shell:0-99999999999999999999",
                          "statue",
                          ""}) {
    CHECK_THROWS(Error, parse_random_scenes(bad));
    CHECK_THROWS(Error, parse_random_scene(bad));
  }
  CHECK_THROWS(Error, parse_random_scene("random:shell:1-2"));
  CHECK_THROWS(Error, scene_by_name("random:castle:1"));
  CHECK_THROWS(Error, random_mesh({"castle", 1}));
}

TEST(random_seeds_have_their_use) {
  for (const std::uint64_t s : {1U, 50U, 99U}) CHECK(random_seed_use(s) == "development");
  for (const std::uint64_t s : {1000U, 1001U, 123456U}) CHECK(random_seed_use(s) == "reported");
  for (const std::uint64_t s : {0U, 100U, 999U}) CHECK(random_seed_use(s) == "unassigned");
}

TEST(random_scenes_are_sound) {
  for (const RandomSceneSpec& spec : kRandomSceneKinds)
    for (const std::uint64_t seed : {1U, 2U, 5U, 17U}) {
      const Scene scene = random_scene({spec.kind, seed});
      CHECK(scene.name == RandomSceneId{spec.kind, seed}.name());
      for (const Point3& v : scene.mesh.vertices) CHECK(v.allFinite());
      const TriangleMesh structure = scene.structure();
      CHECK(structure.triangles.size() == scene.structure_triangles);
      CHECK(structure.triangles.size() > 500 && structure.triangles.size() < 40000);
      const Eigen::Vector3d size = structure.bounds().sizes();
      // A quarter of the seconds of flight at 1 m/s in range: minutes, not hours.
      const double most = spec.preset.voxel < 0.2 ? 26.0 : 46.0,
                   least = spec.preset.voxel < 0.2 ? 8.0 : 14.0;
      CHECK(size.maxCoeff() >= least && size.maxCoeff() <= most);
      CHECK(structure.area() < 3000.0);
      const bool indoors = spec.kind == "hall";
      CHECK(scene.has_ground == !indoors);
      if (!indoors) CHECK(structure.bounds().min().z() > -0.3);
      // Five robots find room, and what an image shows of their surroundings is free.
      const SceneSpace space(scene.mesh);
      const Bvh surface(structure);
      const auto starts = starting_places(
          scene, space, 5,
          {.radius = spec.preset.radius, .margin = spec.preset.margin, .spacing = spec.spacing()});
      for (const Configuration& q : starts) {
        CHECK(surface.distance(q.position) >= spec.start_clearance() - 1e-9);
        CHECK(!space.is_solid(q.position) && scene.bounds.contains(q.position));
        if (indoors && !random_seed_is_dirty(seed)) CHECK(space.is_room(q.position));
      }
      for (std::size_t i = 1; i < starts.size(); ++i)
        CHECK((starts[i].position - starts[0].position).norm() >
              2.0 * (spec.preset.radius + spec.preset.margin) - 1e-9);
      if (random_seed_is_dirty(seed)) continue;
      // Closed parts face outward, the air of rooms inward.
      const std::vector<double> volume = volumes(structure);
      const auto inward =
          std::count_if(volume.begin(), volume.end(), [](double v) { return v < 0; });
      CHECK(inward == (indoors ? 1 : 0));
    }
}

TEST(random_scenes_repeat_and_differ) {
  for (const RandomSceneSpec& spec : kRandomSceneKinds) {
    const TriangleMesh a = random_mesh({spec.kind, 3}), b = random_mesh({spec.kind, 3});
    CHECK(a.vertices == b.vertices && a.triangles == b.triangles);
    std::set<double> areas;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 1000U})
      areas.insert(random_mesh({spec.kind, seed}).area());
    CHECK(areas.size() == 5);
  }
  CHECK(random_mesh({"hull", 1000}).vertices ==
        random_mesh(parse_random_scene("random:all:1000")).vertices);
}

TEST(draws_by_name_do_not_shift_one_another) {
  using detail::random_scene::Draw;
  const Draw root{Random(7)};
  Draw greedy = root("first");
  for (int k = 0; k < 100; ++k) greedy.in(0.0, 1.0);
  Draw branch = greedy("inner"), other = root("first")("inner"), second = root("second");
  const double value = branch.in(0.0, 1.0);
  CHECK(value == other.in(0.0, 1.0) && value != second.in(0.0, 1.0));
  CHECK(root("part", 1).in(0.0, 1.0) != root("part", 2).in(0.0, 1.0));
  for (int k = 0; k < 200; ++k) {
    const int w = second.whole(2, 4);
    CHECK(w >= 2 && w <= 4);
  }
}

TEST(every_fifth_random_scene_is_dirty) {
  for (const RandomSceneSpec& spec : kRandomSceneKinds) {
    for (const std::uint64_t seed : {5U, 1010U}) {
      CHECK(random_seed_is_dirty(seed));
      const Dirt d = dirt_of(random_mesh({spec.kind, seed}));
      CHECK(d.duplicates >= 6 && d.slivers >= 6 && d.lines >= 1 && d.twice >= 1);
      CHECK(d.non_manifold >= 6);
    }
    for (const std::uint64_t seed : {4U, 1011U}) {
      const Dirt d = dirt_of(random_mesh({spec.kind, seed}));
      CHECK(d.duplicates == 0 && d.slivers == 0 && d.lines == 0 && d.twice == 0);
    }
  }
  // Slivers and lines lie in the surface: the dirty mesh is the clean one and the sheets on edges.
  const TriangleMesh box = make_box({0, 0, 0}, {4, 4, 4});
  TriangleMesh dirty = box;
  detail::random_scene::make_dirty(dirty, detail::random_scene::Draw(Random(3)), 0.0);
  const Bvh surface(dirty), clean(box);
  Random random(5);
  int apart = 0;
  for (int k = 0; k < 500; ++k) {
    const double x = random.uniform(0, 4), y = random.uniform(0, 4);
    CHECK(surface.distance({x, y, 4.0}) < 1e-9);  // no hole
  }
  for (const Point3& v : dirty.vertices) apart += clean.distance(v) > 1e-9 ? 1 : 0;
  CHECK(apart <= 8);
}

TEST(lattices_are_of_thin_members) {
  using detail::random_scene::lattice::kThickest;
  using detail::random_scene::lattice::kThinnest;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 6U, 7U, 8U, 9U}) {
    const TriangleMesh mesh = random_mesh({"lattice", seed});
    const MeshComponents parts = connected_components(mesh);
    std::vector<std::set<std::int32_t>> vertices(parts.count);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      vertices[static_cast<std::size_t>(parts.of_triangle[t])].insert(mesh.triangles[t].begin(),
                                                                      mesh.triangles[t].end());
    int members = 0;
    for (const auto& set : vertices) {
      const Slender s = slender(mesh, {set.begin(), set.end()});
      if (s.length < 0.9 || s.radius > 0.2 * s.length || set.size() > 40) continue;
      ++members;
      // Of a square bar the radius is half its diagonal; of an angle less than its width.
      CHECK(s.radius >= 0.5 * kThinnest - 1e-6 && s.radius <= kThickest / std::sqrt(2.0) + 1e-6);
    }
    CHECK(members > 40);
  }
}

TEST(shells_are_at_most_ten_centimetres_thick) {
  int sheets = 0, solids = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 6U, 7U, 8U, 9U, 11U, 12U}) {
    const TriangleMesh mesh = random_mesh({"shell", seed});
    // The shell is the first part; all its vertices have the other side within its thickness.
    const MeshComponents parts = connected_components(mesh);
    TriangleMesh shell = mesh;
    shell.triangles.clear();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (parts.of_triangle[t] == 0) shell.triangles.push_back(mesh.triangles[t]);
    CHECK(shell.area() > 40.0);
    if (!is_closed_and_oriented(shell)) {
      ++sheets;
      continue;
    }
    ++solids;
    const Bvh surface(shell);
    for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
      double longest = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, (shell.corner(t, k) - shell.corner(t, (k + 1) % 3)).norm());
      if (2.0 * shell.area(t) < 0.12 * longest) continue;  // along the rim
      const Eigen::Vector3d inward = -shell.area_vector(t).normalized();
      const auto hit = surface.cast(shell.centroid(t) + 1e-6 * inward, inward, 1.0);
      CHECK(hit.has_value());
      if (hit) CHECK(hit->t > 0.015 && hit->t < 0.13);
    }
  }
  CHECK(sheets >= 3 && solids >= 3);
}

TEST(thickened_sheets_are_closed) {
  using namespace detail::random_scene;
  const TriangleMesh flat = make_plane(Box2(Point2(0, 0), Point2(2, 3)), 1.0, 2, 3);
  const TriangleMesh slab = thickened(flat, 0.1);
  CHECK(is_closed_and_oriented(slab));
  CHECK_NEAR(volumes(slab)[0], 6.0 * 2.0 * 3.0 * 0.1, 1e-9);
  CHECK_NEAR(slab.bounds().min().z(), 0.9, 1e-12);
  CHECK(thickened(flat, 0.0).triangles == flat.triangles);
  const std::array<Point2, 2> wall{Point2(5, 0), Point2(5, 4)};
  const TriangleMesh ring = thickened(make_revolved_sheet(wall, 64), 0.05);
  CHECK(is_closed_and_oriented(ring));
  // A polygon of 64 corners has the area n/2 sin(2 pi/n) r^2.
  const double share = 32.0 * std::sin(2.0 * kPi / 64.0);
  CHECK_NEAR(volumes(ring)[0] / 6.0, share * (25.0 - 4.95 * 4.95) * 4.0, 1e-6);
}
