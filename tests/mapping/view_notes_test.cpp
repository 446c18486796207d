// SPDX-License-Identifier: MIT
#include <surfleet/mapping/view_notes.hpp>

#include <array>
#include <cmath>

#include <surfleet/core/random.hpp>
#include <surfleet/mapping/moved_patch.hpp>

#include "check.hpp"
#include "patch_scenes.hpp"

using namespace surfleet;
using namespace surfleet::test;

TEST(view_directions_in_steps_are_nearly_what_they_were) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d d =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const ViewDirection q = quantised(d);
    CHECK(is_view_direction(q));
    CHECK(unit_vector(q).dot(d) > std::cos(radians(0.5)));
  }
  CHECK(!is_view_direction({0, 0, 0}) && !is_view_direction({-128, -128, 0}));
  CHECK(view_place({-1, 0, 3}) == (VoxelKey{-1, 0, 1}));
}

TEST(notes_merge_in_any_order_and_move_with_their_patch) {
  Random random(5);
  std::vector<ViewNotes> parts;
  for (int n = 0; n < 6; ++n) parts.push_back(random_notes(random, n));
  const ViewNotes whole = merged_notes(parts);
  std::reverse(parts.begin(), parts.end());
  CHECK(merged_notes(parts) == whole && !whole.empty());
  int failures = 0, of_parts = 0;
  for (const auto& f : whole.failures) failures += f.count;
  for (const ViewNotes& n : parts)
    for (const auto& f : n.failures) of_parts += f.count;
  CHECK(failures == of_parts);
  parts[0].kind = 3;
  CHECK_THROWS(Error, merged_notes(parts));

  MapPatch patch = random_patch(7, 3);
  CHECK(!patch.notes.views.empty() && !patch.notes.failures.empty());
  const double place = kViewPlaceVoxels * patch.voxel_size;
  Pose T = Pose::Identity();
  T.translation() = Point3(3 * place, -2 * place, place);
  ViewNotes moved = moved_patch(patch, T).notes;
  CHECK(moved.kind == patch.notes.kind && moved.views.size() == patch.notes.views.size());
  for (std::size_t i = 0; i < moved.views.size(); ++i) {
    const VoxelKey& p = patch.notes.views[i].place;
    CHECK(moved.views[i].place == (VoxelKey{p[0] + 3, p[1] - 2, p[2] + 1}));
  }
  // A quarter turn about z takes x to y, places and directions alike.
  T = Pose(Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ()));
  ViewNotes one;
  one.views = {{{4, 1, 0}, {127, 0, 0}}};
  one.failures = {{{4, 1, 0}, 2}};
  moved = moved_notes(one, T, patch.voxel_size);
  CHECK(moved.views.size() == 1 && moved.views[0].place == (VoxelKey{-2, 4, 0}));
  CHECK(moved.views[0].direction == (ViewDirection{0, 127, 0}));
  CHECK(moved.failures[0].place == (VoxelKey{-2, 4, 0}) && moved.failures[0].count == 2);

  const std::array<MapPatch, 2> both{patch, patch};
  const ViewNotes coalesced = coalesced_patch(both, {9, 0, 0}).notes;
  CHECK(coalesced.views == patch.notes.views && coalesced.kind == patch.notes.kind);
  for (std::size_t i = 0; i < coalesced.failures.size(); ++i)
    CHECK(coalesced.failures[i].count == 2 * patch.notes.failures[i].count);
}
