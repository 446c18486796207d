// SPDX-License-Identifier: MIT
#include <surfleet/fleet/path_around.hpp>

#include <algorithm>
#include <span>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

namespace {
using namespace surfleet;

/// Free space in a ball beside the box, as far as bounds go.
struct Ball {
  MissionOptions options = box_world::options(box_world::World{});
  SurfaceBelief belief{SurfaceBelief::checked(options.belief),
                       std::span<const RobotKind>(&options.kind, 1)};
  explicit Ball(double radius) {
    belief.add_known_free(0, {Point3(-3.5, 0.0, 1.0), radius});
    belief.update();
  }
};
double least_distance(const Path& path, const Point3& mate) {
  double least = 1e9;
  for (std::size_t i = 1; i < path.points.size(); ++i)
    least = std::min(least,
                     (closest_on_segment(mate, path.points[i - 1], path.points[i]) - mate).norm());
  return least;
}

TEST(paths_keep_clear_of_mates_that_stand) {
  const Ball ball(3.6);
  const KindSpace& space = ball.belief.space(0);
  const Point3 from(-3.5, -2.4, 1.0), to(-3.5, 2.4, 1.0), between(-3.5, 0.1, 1.0),
      apart(-3.5, 0.0, 3.0), at_end(-3.4, 2.0, 1.0);
  const auto straight = space.roadmap.query(from, to);
  CHECK(straight && straight->length < 5.0);
  for (const auto& standing :
       {std::vector<Point3>{}, std::vector<Point3>{apart}, std::vector<Point3>{at_end}}) {
    const auto path = path_around(space, from, to, standing, 1.0);
    CHECK(path && path->points == straight->points);
  }
  for (const auto& standing :
       {std::vector<Point3>{between}, std::vector<Point3>{between, apart},
        std::vector<Point3>{Point3(-3.5, -1.0, 1.0), Point3(-3.5, 1.2, 1.0)}}) {
    const auto path = path_around(space, from, to, standing, 1.0);
    CHECK(path && path->points.front() == from && path->points.back() == to);
    for (const Point3& mate : standing) CHECK(least_distance(*path, mate) >= 1.0);
    for (std::size_t i = 1; i < path->points.size(); ++i)
      CHECK(space.free.is_free_segment(path->points[i - 1], path->points[i]));
    CHECK_NEAR(path->length, polyline_length(path->points), 1e-9);
    CHECK(path->length < straight->length + 1.5 * static_cast<double>(standing.size()));
  }
}
TEST(where_no_path_leads_around_mates_paths_are_as_they_were) {
  const Ball ball(1.6);
  const KindSpace& space = ball.belief.space(0);
  const Point3 from(-3.5, -0.9, 1.0), to(-3.5, 0.9, 1.0), between(-3.5, 0.0, 1.0);
  const auto straight = space.roadmap.query(from, to);
  CHECK(straight);
  if (!straight) return;
  const auto path = path_around(space, from, to, std::vector<Point3>{between}, 0.8);
  CHECK(path && path->points == straight->points);
  CHECK(!path_around(space, from, Point3(3.5, 0.0, 1.0), std::vector<Point3>{between}, 0.8));
}
}  // namespace
