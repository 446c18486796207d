// SPDX-License-Identifier: MIT
#include <surfleet/viewpoint/view_ledger.hpp>

#include <algorithm>
#include <vector>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}
VoxelIndex random_voxel(Random& random) {
  const auto coordinate = [&] { return static_cast<int>(random.below(6)) - 3; };
  const int x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}
/// What robots note that go on from what they have noted before.
std::vector<ViewNotes> notes_of_robots(Random& random, int robots, int patches) {
  std::vector<ViewNotes> all;
  for (int r = 0; r < robots; ++r) {
    ViewLedger own({.max_views = 4});
    for (int p = 0; p < patches; ++p) {
      for (int i = 0; i < 6; ++i) {
        own.viewed_in_vain(random_voxel(random), random_direction(random));
        const VoxelIndex v = random_voxel(random);
        own.not_reached(std::span<const VoxelIndex>(&v, 1));
      }
      CHECK(own.has_news());
      all.push_back(own.take_news());
      CHECK(!own.has_news() && own.take_news().empty());
    }
  }
  return all;
}
}  // namespace

TEST(equal_notes_are_equal_ledgers_in_any_order_and_after_removal) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<ViewNotes> notes = notes_of_robots(random, 3, 5);
    ViewLedger whole({.max_views = 2});
    for (const ViewNotes& n : notes) whole.add(n);
    std::reverse(notes.begin(), notes.end());
    const std::size_t kept = random.below(notes.size());
    ViewLedger part({.max_views = 2}), rest({.max_views = 2});
    for (const ViewNotes& n : notes) rest.add(n);
    CHECK(rest == whole);
    for (std::size_t i = 0; i < notes.size(); ++i)
      if (i < kept)
        part.add(notes[i]);
      else
        rest.remove(notes[i]);
    CHECK(part == rest && !(part == whole));
    for (int i = 0; i < 50; ++i) {
      const VoxelIndex v = random_voxel(random);
      const Eigen::Vector3d d = random_direction(random);
      CHECK(part.reason(v) == rest.reason(v) && part.views_in_vain(v) == rest.views_in_vain(v));
      CHECK(part.promises(v, d) == rest.promises(v, d));
    }
  }
}

TEST(what_others_viewed_in_vain_is_given_up_here) {
  const VoxelIndex v(1, 2, 3);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), side = Eigen::Vector3d::UnitX();
  ViewLedger a({.max_views = 2}), b({.max_views = 2});
  a.viewed_in_vain(v, up);
  const ViewNotes first = a.take_news();
  b.add(first);
  CHECK(!b.has_news());  // theirs is theirs to tell
  CHECK(!b.fresh(v) && !b.given_up(v) && !b.promises(v, up) && b.promises(v, side));
  // Nearly the same view is none more, whichever robot takes it.
  b.viewed_in_vain(v, (up + 0.05 * side).normalized());
  CHECK(!b.has_news() && b.views_in_vain(v) == 1);
  ViewLedger c({.max_views = 2});
  c.viewed_in_vain(v, (up + 0.05 * side).normalized());
  b.add(c.take_news());
  CHECK(!b.given_up(v));
  b.viewed_in_vain(v, side);
  CHECK(b.reason(v) == LeftReason::seen_incomplete);
  b.remove(first);
  CHECK(b.given_up(v));  // c viewed from there, too
  CHECK_THROWS(Error, b.remove(first));

  ViewLedger twice({.max_views = 1});
  twice.add(first);
  twice.add(first);
  twice.remove(first);
  CHECK(twice.given_up(v));  // another said so, too
  twice.remove(first);
  CHECK(!twice.given_up(v) && twice == ViewLedger());

  ViewLedger lost({.max_failures = 3}), found({.max_failures = 3});
  for (int i = 0; i < 2; ++i) lost.not_reached(std::span<const VoxelIndex>(&v, 1));
  const ViewNotes failures = lost.take_news();
  CHECK(failures.failures.size() == 1 && failures.failures[0].count == 2);
  found.add(failures);
  CHECK(!found.given_up(v));
  found.not_reached(std::span<const VoxelIndex>(&v, 1));
  CHECK(found.reason(v) == LeftReason::unreachable);
  // One that has given up notes no more of it: no patches without end.
  static_cast<void>(found.take_news());
  found.not_reached(std::span<const VoxelIndex>(&v, 1));
  CHECK(!found.has_news());
  found.remove(failures);
  CHECK(!found.given_up(v));
}
