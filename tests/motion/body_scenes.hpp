// SPDX-License-Identifier: MIT
/// @file
/// @brief What bodies of any shape are held to in the tests of the motion room.
#pragma once

#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/swept_body.hpp>

#include "check.hpp"
#include "motion_scenes.hpp"

namespace motion_scenes {
/// Whether the body fits at `p` with every one of many headings, `more` [m] away from obstacles
/// beyond the margin.
template <typename Body>
bool fits_turned(const FreeSpace& plain, const Body& body, const Point3& p, double more = 0.0,
                 int headings = 64) {
  const double reach = body.bounding_radius() + plain.obstacle_margin() + more;
  const VoxelIndex lo = plain.grid().index_of(p - Point3::Constant(reach));
  const VoxelIndex hi = plain.grid().index_of(p + Point3::Constant(reach));
  bool fits = true;
  for_each_index(lo, hi, [&](const VoxelIndex& v) {
    if (!fits || !plain.is_obstacle(v)) return;
    const Sphere ball{plain.grid().center(v), plain.obstacle_margin() + more};
    if ((ball.center - p).norm() > reach) return;
    for (int k = 0; fits && k < headings; ++k)
      fits = !body.touches({p, 2.0 * kPi * k / headings}, ball);
  });
  return fits;
}

/// A flat slot, `gap` [m] high, through a wall.
struct Slot {
  TsdfMap tsdf{{.voxel_size = 0.1}};
  Box3 bounds = box(-3, -2, -1.5, 3, 2, 1.5);
  explicit Slot(double gap) {
    const double z = 0.5 * gap;
    observe(tsdf, box(-4, -3, -2.5, 4, 3, 2.5),
            Boxes{{box(-0.4, -3, z, 0.4, 3, 3), box(-0.4, -3, -3, 0.4, 3, -z)}});
  }
};
/// Of a free space for the body.
template <typename Body>
FreeSpaceOptions options_for(const Body& body, const Box3& bounds) {
  const SweptBody shape = SweptBody::of(body);
  FreeSpaceOptions o{.radius = shape.radius(), .bounds = bounds};
  o.shape = shape;
  return o;
}
/// That the body goes through a slot where its ball finds no path, and touches nothing on it, by
/// testing all obstacles at every `step` [m] with every heading.
template <typename Body>
void check_slot(const Body& body, int headings, double step) {
  const Slot slot(0.9);
  const VoxelStateMap states(slot.tsdf);
  const FreeSpaceOptions shaped = options_for(body, slot.bounds);
  FreeSpaceOptions ball = shaped;
  ball.shape.reset();
  const FreeSpace space(states, shaped), around(states, ball);
  LazyPrmStar roadmap(space), wide(around);
  const Point3 a(-2.2, 0.7, 0.6), b(2.2, -0.4, -0.5);
  CHECK(around.is_free(a) && around.is_free(b) && !wide.query(a, b));
  const auto path = roadmap.query(a, b);
  CHECK(path.has_value());
  if (!path) return;
  bool inside = false;
  for (std::size_t i = 1; i < path->points.size(); ++i) {
    const Point3 p = path->points[i - 1], q = path->points[i];
    const int n = static_cast<int>((q - p).norm() / step) + 1;
    for (int k = 0; k <= n; ++k) {
      const Point3 at = p + (q - p) * (static_cast<double>(k) / n);
      CHECK(fits_turned(around, body, at, 0.0, headings));
      inside = inside || std::abs(at.x()) < 0.1;
    }
  }
  CHECK(inside);
}
}  // namespace motion_scenes
