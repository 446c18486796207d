// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/viewpoint_generation.hpp>
#include <surfleet/viewpoint/viewpoint_merging.hpp>

#include <algorithm>
#include <functional>
#include <set>

#include "check.hpp"
#include "state_scenes.hpp"

namespace {
using namespace surfleet;
using namespace view_test;

const PinholeCamera kCamera = PinholeCamera::from_fov(radians(90), radians(60), 320, 240, 1.0, 8.0);

/// One type for all predicates of the tests: generation is compiled twice, not for each.
using IsFree = std::function<bool(const Configuration&)>;

/// What every result owes its caller.
void check_promises(const ViewpointSet& set, std::span<const IncompleteElement> elements,
                    const VoxelStateMap& states, const ViewpointOptions& options,
                    const IsFree& is_free) {
  const ViewFrustum frustum(kCamera, options.T_body_camera);
  std::set<std::int32_t> accounted;
  for (const Viewpoint& v : set) {
    CHECK(v.targets.size() == 1);
    const IncompleteElement& e = elements[static_cast<std::size_t>(v.targets[0])];
    CHECK(accounted.insert(v.targets[0]).second);
    const auto placed = frustum.at(v.configuration);
    LineOfSight line(states, {.unknown_blocks = options.unknown_blocks});
    CHECK(placed.contains(e.position));
    CHECK(line.sees(placed.eye(), e.voxel));
    bool shown = false;
    e.any_unknown([&](const VoxelIndex& d) {
      shown |= placed.contains(e.position + states.voxel_size() * d.cast<double>()) &&
               line.sees(placed.eye(), e.voxel + d);
      return false;
    });
    CHECK(shown || e.unknown == 0);
    CHECK(is_free(v.configuration));
    CHECK(!options.known_eye || states.at(placed.eye()) == VoxelState::empty);
    CHECK_NEAR((placed.eye() - e.position).normalized().dot(v.direction), 1.0, 1e-9);
    CHECK(e.direction.isZero() ||
          e.direction.dot(v.direction) >= std::cos(options.max_angle) - 1e-9);
  }
  for (const UnseenElement& u : set.unseen) CHECK(accounted.insert(u.element).second);
  CHECK(accounted.size() == elements.size());
}

bool same(const ViewpointSet& a, const ViewpointSet& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Viewpoint& x, const Viewpoint& y) {
                      return x.configuration.position == y.configuration.position &&
                             x.configuration.yaw == y.configuration.yaw && x.targets == y.targets;
                    }) &&
         a.unseen.size() == b.unseen.size();
}

TEST(a_free_wall_gets_the_ideal_poses) {
  const TsdfMap map = wall_scene(10, 24);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  CHECK(elements.size() == 80);
  const EmptyBall is_free{&states, 0.0};
  ViewpointOptions options{.distance = 4.0};
  options.known_eye = false;  // the rim's directions lean outwards, to where nothing is known
  const ViewpointSet set =
      generate_viewpoints(std::span(elements), states, kCamera, options, AlwaysTrue{});
  check_promises(set, elements, states, options, AlwaysTrue{});
  CHECK(set.unseen.empty());
  for (const Viewpoint& v : set) {
    const IncompleteElement& e = elements[static_cast<std::size_t>(v.targets[0])];
    CHECK_NEAR((v.configuration.position - e.position).norm(), 4.0, 1e-9);
    CHECK(v.direction.dot(e.direction) > 0.999);
    CHECK(std::abs(wrap_angle(v.configuration.yaw - kPi)) < radians(50));
  }
  options.known_eye = true;
  const ViewpointSet inside =
      generate_viewpoints(std::span(elements), states, kCamera, options, is_free);
  check_promises(inside, elements, states, options, is_free);
  CHECK(inside.unseen.empty());
  CHECK(same(inside, generate_viewpoints(std::span(elements), states, kCamera, options, is_free)));
}

TEST(a_floor_is_viewed_from_the_side_within_the_image) {
  const TsdfMap map = floor_scene(30, 24);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  for (const double pitch : {0.0, 0.5, kPi / 2}) {
    const ViewpointOptions options{
        .distance = 4.0, .T_body_camera = forward_camera_mount(pitch, Point3(0.1, 0, 0.2))};
    const EmptyBall is_free{&states, 0.0};
    const ViewpointSet set =
        generate_viewpoints(std::span(elements), states, kCamera, options, is_free);
    check_promises(set, elements, states, options, is_free);
    CHECK(set.unseen.empty());
  }
  // A camera that faces up never sees a floor.
  const ViewpointOptions up{.distance = 4.0, .T_body_camera = forward_camera_mount(-1.4)};
  const ViewpointSet none =
      generate_viewpoints(std::span(elements), states, kCamera, up, AlwaysTrue{});
  CHECK(none.empty() && none.unseen.size() == elements.size());
  for (const UnseenElement& u : none.unseen) CHECK(u.reason == NoViewReason::outside_view);
}

TEST(elements_without_direction_and_vertical_ones_are_seen_too) {
  const TsdfMap map = floor_scene(30, 24);
  const VoxelStateMap states(map);
  std::vector<IncompleteElement> elements(2);
  for (IncompleteElement& e : elements) e.position = map.center(e.voxel);
  elements[1].direction = Eigen::Vector3d::UnitZ();
  const ViewpointOptions options{.distance = 4.0};
  const EmptyBall is_free{&states, 0.0};
  const ViewpointSet set = generate_viewpoints(std::span<const IncompleteElement>(elements), states,
                                               kCamera, options, is_free);
  check_promises(set, elements, states, options, is_free);
  CHECK(set.size() == 2);
}

TEST(a_blocked_ideal_pose_is_replaced) {
  const TsdfMap map = wall_scene(12, 30);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  const ViewpointOptions options{.distance = 4.0, .known_eye = false};
  // Taken: everything farther from the wall than three metres.
  const IsFree near_only = [&](const Configuration& q) {
    return q.position.x() < 3.0 && states.at(q.position) == VoxelState::empty;
  };
  const ViewpointSet nearer =
      generate_viewpoints(std::span(elements), states, kCamera, options, near_only);
  check_promises(nearer, elements, states, options, near_only);
  CHECK(nearer.unseen.empty());
  // Taken: all that is straight in front of where the elements are.
  const IsFree one_side = [&](const Configuration& q) { return q.position.y() < -4.0; };
  const ViewpointSet oblique =
      generate_viewpoints(std::span(elements), states, kCamera, options, one_side);
  check_promises(oblique, elements, states, options, one_side);
  CHECK(!oblique.empty());
  const IsFree nowhere = [](const Configuration&) { return false; };
  const ViewpointSet none =
      generate_viewpoints(std::span(elements), states, kCamera, options, nowhere);
  CHECK(none.empty() && none.unseen.size() == elements.size());
  for (const UnseenElement& u : none.unseen) CHECK(u.reason == NoViewReason::no_free_pose);
  const ViewpointSet far =
      generate_viewpoints(std::span(elements), states, kCamera, options, AlwaysTrue{}, nowhere);
  for (const UnseenElement& u : far.unseen) CHECK(u.reason == NoViewReason::unreachable);
  CHECK(far.empty());
}

TEST(what_is_walled_in_is_occluded) {
  TsdfMap map({.voxel_size = 0.25});
  paint(map, {-4, -4, -4}, {4, 4, 4}, [](const VoxelIndex& v) {
    return v.cwiseAbs().maxCoeff() < 2 ? VoxelState::empty : VoxelState::occupied;
  });
  set_state(map, {1, 1, 1}, VoxelState::unknown);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  CHECK(elements.size() == 3);
  const ViewpointSet set =
      generate_viewpoints(std::span(elements), states, kCamera, {.distance = 4.0}, AlwaysTrue{});
  CHECK(set.empty() && set.unseen.size() == 3);
  for (const UnseenElement& u : set.unseen) CHECK(u.reason == NoViewReason::occluded);
}

TEST(tries_are_bounded) {
  const TsdfMap map = wall_scene(12, 30);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  std::size_t asked = 0;
  const IsFree count = [&](const Configuration&) { return ++asked, false; };
  static_cast<void>(generate_viewpoints(std::span(elements), states, kCamera,
                                        {.distance = 4.0, .max_tries = 5}, count));
  CHECK(asked <= 5 * elements.size() && asked > elements.size());
}

TEST(odd_settings) {
  const TsdfMap map = floor_scene(5, 8);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  const auto run = [&](const ViewpointOptions& o) {
    return generate_viewpoints(std::span(elements), states, kCamera, o, AlwaysTrue{});
  };
  CHECK_THROWS(Error, run({.distance = 0.0}));
  CHECK_THROWS(Error, run({.distance = -1.0}));
  CHECK_THROWS(Error, run({.distance = 4.0, .distance_step = 0.0}));
  CHECK_THROWS(Error, run({.distance = 4.0, .max_tries = 0}));
  CHECK(run({.distance = 100.0}).size() == elements.size());  // out of range: nearer ones are tried
  CHECK(run({.distance = 4.0, .min_distance = 20.0, .max_distance = 30.0}).empty());
  IncompleteSurface incomplete;
  CHECK(generate_viewpoints(incomplete, states, kCamera).empty());
  const TsdfMap nothing;
  CHECK(generate_viewpoints(incomplete, nothing, kCamera).empty());
}

TEST(the_empty_ball_is_empty) {
  const TsdfMap map = floor_scene(8, 8, 0.25);
  const VoxelStateMap states(map);
  const EmptyBall half{&states, 0.5};
  CHECK(half({Point3(0, 0, 1.0), 0}));
  CHECK(!half({Point3(0, 0, 0.3), 0}));   // touches the floor
  CHECK(!half({Point3(0, 0, 2.2), 0}));   // reaches the unknown
  CHECK(!half({Point3(0, 0, 40.0), 0}));  // all unknown
}

Viewpoint view_at(const Point3& p, double yaw, std::int32_t target) {
  return {{p, yaw}, Eigen::Vector3d(-std::cos(yaw), -std::sin(yaw), 0), {target}};
}

TEST(near_views_merge_into_their_mean) {
  const std::vector<Viewpoint> views = {view_at({0, 0, 1}, kPi - 0.05, 4),
                                        view_at({0.2, 0, 1}, -kPi + 0.05, 2),
                                        view_at({0.1, 0.1, 1}, 0.0, 1),  // faces the other way
                                        view_at({3, 0, 1}, kPi, 0)};     // far away
  const auto merged = merge_viewpoints(views);
  CHECK(merged.size() == 3);
  CHECK_NEAR((merged[0].configuration.position - Point3(0.1, 0, 1)).norm(), 0.0, 1e-12);
  CHECK_NEAR(std::abs(merged[0].configuration.yaw), kPi, 1e-9);
  CHECK(merged[0].targets == std::vector<std::int32_t>({2, 4}));
  CHECK_NEAR(merged[0].direction.norm(), 1.0, 1e-12);
  CHECK(merge_viewpoints(std::span<const Viewpoint>()).empty());
  CHECK_THROWS(Error, merge_viewpoints(views, {.distance = -1.0}));
}

TEST(merging_keeps_every_target_and_only_acceptable_poses) {
  Random random(8);
  std::vector<Viewpoint> views;
  for (int i = 0; i < 600; ++i)
    views.push_back(view_at({random.uniform(0, 5), random.uniform(0, 5), random.uniform(0, 2)},
                            random.uniform(0, 1.0), i));
  const auto accept = [](const Viewpoint& v) {
    return std::abs(v.configuration.position.x() - 2.5) > 0.2;
  };
  std::erase_if(views, [&](const Viewpoint& v) { return !accept(v); });
  const auto merged = merge_viewpoints(views, {.distance = 1.0}, accept);
  CHECK(merged.size() < views.size() / 2);
  std::vector<std::int32_t> all, expected;
  for (const Viewpoint& v : views) expected.push_back(v.targets[0]);
  for (const Viewpoint& v : merged) {
    CHECK(accept(v));
    CHECK(std::is_sorted(v.targets.begin(), v.targets.end()));
    all.insert(all.end(), v.targets.begin(), v.targets.end());
  }
  std::sort(all.begin(), all.end());
  CHECK(all == expected);
}

TEST(merged_views_still_see_their_targets) {
  const TsdfMap map = wall_scene(16, 30);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  const ViewpointOptions options{.distance = 4.0};
  const EmptyBall is_free{&states, 0.3};
  const ViewpointSet set =
      generate_viewpoints(std::span(elements), states, kCamera, options, is_free);
  const SeesTargets accept{std::span<const IncompleteElement>(elements), &states,
                           ViewFrustum(kCamera), is_free};
  const auto merged = merge_viewpoints(set, {}, accept);
  CHECK(merged.size() < set.size());
  std::size_t targets = 0;
  for (const Viewpoint& v : merged) {
    CHECK(accept(v));
    targets += v.targets.size();
  }
  CHECK(targets == set.size());
}
/// A view along n̄_v was in vain for all elements.
struct OtherSides {
  bool operator()(const IncompleteElement& e, const Eigen::Vector3d& direction) const {
    return e.direction.dot(direction) < std::cos(radians(30));
  }
};
static_assert(ViewPredicate<OtherSides>);
TEST(views_come_from_sides_that_promise_something) {
  const TsdfMap map = wall_scene(10, 24);
  const VoxelStateMap states(map);
  const auto elements = elements_of(map);
  ViewpointOptions options{.distance = 4.0};
  options.known_eye = false;
  const OtherSides promises;
  const ViewpointSet set = generate_viewpoints(std::span(elements), states, kCamera, options,
                                               AlwaysTrue{}, AlwaysTrue{}, promises);
  check_promises(set, elements, states, options, AlwaysTrue{});
  CHECK(!set.empty());
  for (const Viewpoint& v : set)
    CHECK(promises(elements[static_cast<std::size_t>(v.targets[0])], v.direction));
  const auto none = [](const IncompleteElement&, const Eigen::Vector3d&) { return false; };
  const ViewpointSet refused = generate_viewpoints(std::span(elements), states, kCamera, options,
                                                   AlwaysTrue{}, AlwaysTrue{}, none);
  CHECK(refused.empty() && refused.unseen.size() == elements.size());
  for (const UnseenElement& u : refused.unseen) CHECK(u.reason == NoViewReason::viewed_in_vain);
}
TEST(what_is_unknown_round_a_corner_asks_for_another_place) {
  // A duct of one voxel into the wall, whose bottom has an unknown voxel at its side.
  const auto scene = [](int mouth) {
    TsdfMap map = wall_scene(10, 24);
    paint(map, {-3, -mouth, 0}, {-1, mouth, 0},
          [](const VoxelIndex&) { return VoxelState::empty; });
    paint(map, {-5, -10, -10}, {-4, 10, 10},
          [](const VoxelIndex&) { return VoxelState::occupied; });
    set_state(map, {-3, mouth + 1, 0}, VoxelState::unknown);
    return map;
  };
  ViewpointOptions options{.distance = 4.0};
  options.known_eye = false;
  for (const int mouth : {0, 3}) {
    const TsdfMap map = scene(mouth);
    const VoxelStateMap states(map);
    auto elements = elements_of(map);
    std::erase_if(elements,
                  [&](const IncompleteElement& e) { return e.voxel != VoxelIndex(-3, mouth, 0); });
    CHECK(elements.size() == 1);
    const ViewpointSet set =
        generate_viewpoints(std::span<const IncompleteElement>(elements), states, kCamera, options,
                            AlwaysTrue{}, AlwaysTrue{});
    check_promises(set, elements, states, options, AlwaysTrue{});
    // The bottom itself can be seen either way; what is beside it only where the duct is wide.
    const ViewFrustum frustum(kCamera, options.T_body_camera);
    LineOfSight line(states);
    const Configuration before{elements[0].position + Point3(4, 0, 0), kPi};
    CHECK(frustum.at(before).contains(elements[0].position));
    CHECK(line.sees(before.position, elements[0].voxel));
    CHECK(!reveals(frustum.at(before), elements[0], line));
    CHECK(set.size() == (mouth == 0 ? 0U : 1U));
    if (mouth == 0) CHECK(set.unseen[0].reason == NoViewReason::occluded);
    elements[0].unknown = 0;  // then it is enough to see the element itself
    CHECK(reveals(frustum.at(before), elements[0], line));
  }
}
}  // namespace
