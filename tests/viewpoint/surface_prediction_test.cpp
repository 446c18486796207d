// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/surface_prediction.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include "check.hpp"
#include "state_scenes.hpp"

namespace {
using namespace surfleet;
using namespace view_test;

/// Known where `known(p)`: occupied up to three voxels behind the surface f = 0, empty before it.
TsdfMap implicit_scene(double voxel, int half, const std::function<double(const Point3&)>& f,
                       const std::function<bool(const Point3&)>& known) {
  TsdfMap map({.voxel_size = voxel});
  const VoxelIndex h = VoxelIndex::Constant(half);
  paint(map, -h, h, [&](const VoxelIndex& v) {
    const Point3 p = map.center(v);
    const double d = f(p);
    if (!known(p) || d < -3.0 * voxel) return VoxelState::unknown;
    return d > 0.0 ? VoxelState::empty : VoxelState::occupied;
  });
  return map;
}

TEST(frames_of_planes_of_any_slope) {
  Random random(2);
  const double voxel = 0.2;
  for (int n = 0; n < 12; ++n) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Vector3d border = normal.unitOrthogonal();
    const TsdfMap map = implicit_scene(
        voxel, 16, [&](const Point3& p) { return normal.dot(p); },
        [&](const Point3& p) { return border.dot(p) < 0.0 && p.norm() < 3.0; });
    const VoxelStateMap states(map);
    int inner = 0, framed = 0;
    for (const IncompleteElement& e : elements_of(map)) {
      if (e.position.norm() > 1.6) continue;  // the border of interest is the straight one
      ++inner;
      const auto frame = surface_frame(states, e, 2);
      if (!frame) continue;
      ++framed;
      CHECK_NEAR(frame->normal.norm(), 1.0, 1e-9);
      CHECK_NEAR(frame->tangent.norm(), 1.0, 1e-9);
      CHECK_NEAR(frame->normal.dot(frame->tangent), 0.0, 1e-6);
      CHECK(frame->normal.dot(normal) > std::cos(radians(30)));
      CHECK(frame->tangent.dot(border) > std::cos(radians(50)));
      CHECK(std::abs(normal.dot(frame->point)) < voxel);
    }
    CHECK(inner > 8 && framed > 0.8 * inner);
  }
}

TEST(no_frame_without_surface_or_unknown) {
  TsdfMap map = floor_scene(10, 8);
  const VoxelStateMap states(map);
  IncompleteElement e;
  e.voxel = {0, 0, 0};  // all around is known
  CHECK(!surface_frame(states, e));
  e.voxel = {0, 0, 6};  // no surface near by
  CHECK(!surface_frame(states, e));
  e.voxel = {900, 0, 6};
  CHECK(!surface_frame(states, e));
  CHECK_THROWS(Error, surface_frame(states, e, 9));
}

TEST(remembered_frames_are_those_of_the_map_as_it_is) {
  Random random(5);
  TsdfMap map = implicit_scene(
      0.2, 12, [&](const Point3& p) { return p.z() + 0.3 * std::sin(2.0 * p.x()); },
      [](const Point3& p) { return p.x() < 0.5 || p.y() < 0.0; });
  VoxelStateMap states(map);
  SurfaceFrameMemory remember;
  std::size_t framed = 0;
  for (int round = 0; round < 12; ++round) {
    const auto somewhere = [&](int half) {
      return static_cast<int>(random.below(static_cast<std::uint64_t>(2 * half))) - half;
    };
    const VoxelIndex spot(somewhere(11), somewhere(11), somewhere(3));
    paint(map, spot, spot + VoxelIndex::Constant(2), [&](const VoxelIndex& v) {
      return v.z() > 0 ? VoxelState::empty : VoxelState::occupied;
    });
    states.update(map);
    VoxelStateMap::Accessor state(states);
    for (int pass = 0; pass < 2; ++pass) {
      const std::vector<IncompleteElement> elements = elements_of(map);
      for (const IncompleteElement& e : elements) {
        const auto known = remember(states, state, e.voxel, 2);
        const auto fresh = surface_frame(states, e, 2);
        CHECK(known.has_value() == fresh.has_value());
        if (!known || !fresh) continue;
        ++framed;
        CHECK(known->point == fresh->point && known->normal == fresh->normal &&
              known->tangent == fresh->tangent);
      }
      remember.end_turn(elements.size());
    }
  }
  CHECK(framed > 100);
}

TEST(what_is_predicted_is_the_same_whatever_was_asked_before) {
  Random random(6);
  TsdfMap map = implicit_scene(
      0.2, 24, [](const Point3& p) { return p.z() + 0.3 * std::sin(2.0 * p.x()); },
      [](const Point3& p) { return p.x() < 0.5 || p.y() < 0.0; });
  VoxelStateMap states(map);
  SurfacePredictor predict;
  PredictionOptions options{.reach = 1.4};
  std::size_t patches = 0;
  for (int round = 0; round < 40; ++round) {
    const auto somewhere = [&](int half) {
      return static_cast<int>(random.below(static_cast<std::uint64_t>(2 * half))) - half;
    };
    const VoxelIndex spot(somewhere(23), somewhere(23), somewhere(3));
    paint(map, spot, spot + VoxelIndex::Constant(3), [&](const VoxelIndex& v) {
      return v.z() > 0 ? VoxelState::empty : VoxelState::occupied;
    });
    states.update(map);
    if (round == 30) options.spread = 0.0;
    std::vector<IncompleteElement> elements = elements_of(map);
    // Some are not asked for, and come back when the map has changed beside them.
    std::erase_if(elements, [&](const auto&) { return random.below(4) == 0; });
    const auto known = predict(elements, states, options);
    const auto fresh = predict_surface(elements, states, options);
    CHECK(known.size() == fresh.size());
    for (std::size_t i = 0; i < fresh.size() && known.size() == fresh.size(); ++i)
      CHECK(known[i].position == fresh[i].position && known[i].normal == fresh[i].normal &&
            known[i].area == fresh[i].area);
    patches += fresh.size();
  }
  CHECK(patches > 1000);
}

TEST(a_floor_goes_on_around_its_rim) {
  const double voxel = 0.25, reach = 2.0, step = 0.5;
  const TsdfMap map = floor_scene(11, 8, voxel);
  const VoxelStateMap states(map);
  const auto patches = predict_surface(elements_of(map), states, {.reach = reach, .step = step});
  const double low = -11 * voxel, high = 12 * voxel;
  double area = 0.0;
  for (const PredictedPatch& p : patches) {
    CHECK(p.normal.z() > 0.95);
    CHECK(std::abs(p.position.z()) < 0.6);
    CHECK(states.at(p.position) == VoxelState::unknown);
    const bool beside = p.position.x() < low || p.position.x() > high || p.position.y() < low ||
                        p.position.y() > high;
    CHECK(beside);
    CHECK(p.position.head<2>().cwiseAbs().maxCoeff() < high + reach + step);
    area += p.area;
  }
  // A frame of `reach` around the square, whose corners are filled at least in part.
  const double side = high - low;
  CHECK(area > 4.0 * side * reach * 0.85);
  CHECK(area < (side + 2 * reach + step) * (side + 2 * reach + step) - side * side + 1.0);
}

TEST(lanes_end_where_the_map_is_known) {
  TsdfMap map = floor_scene(8, 8, 0.25);
  paint(map, {13, -20, -8}, {14, 20, 8}, [](const VoxelIndex&) { return VoxelState::empty; });
  const VoxelStateMap states(map);
  for (const PredictedPatch& p : predict_surface(elements_of(map), states, {.reach = 4.0})) {
    CHECK(p.position.x() < 13 * 0.25 || std::abs(p.position.y()) > 20 * 0.25);
    CHECK(p.area > 0.0);
  }
}

TEST(the_region_bounds_patches) {
  const TsdfMap map = floor_scene(8, 8, 0.25);
  const VoxelStateMap states(map);
  const Box3 region(Point3(-2.5, -2.5, -1), Point3(9, 2.5, 1));
  const auto patches = predict_surface(elements_of(map), states, {.reach = 4.0, .region = region});
  CHECK(!patches.empty());
  for (const PredictedPatch& p : patches) CHECK(region.contains(p.position));
}

TEST(a_thin_wall_goes_on_on_both_sides) {
  TsdfMap map({.voxel_size = 0.25});
  paint(map, {-8, -8, -8}, {8, 8, 8},
        [](const VoxelIndex& v) { return v.x() == 0 ? VoxelState::occupied : VoxelState::empty; });
  const VoxelStateMap states(map);
  int forward = 0, backward = 0;
  for (const PredictedPatch& p : predict_surface(elements_of(map), states, {.reach = 2.0})) {
    forward += p.normal.x() > 0.9 ? 1 : 0;
    backward += p.normal.x() < -0.9 ? 1 : 0;
  }
  CHECK(forward > 20 && backward > 20);
}

TEST(nothing_predicts_nothing) {
  const TsdfMap map;
  const VoxelStateMap states(map);
  CHECK(predict_surface(IncompleteSurface(), states).empty());
  CHECK_THROWS(Error, predict_surface(IncompleteSurface(), states, {.reach = 0.0}));
  CHECK_THROWS(Error, predict_surface(IncompleteSurface(), states, {.reach = 1e9}));
}
}  // namespace
