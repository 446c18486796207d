// SPDX-License-Identifier: MIT
#include <surfleet/fleet/patch_sync.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <set>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/mapping/patch_fusion.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
/// One voxel: there is nothing smaller.
MapPatch small_patch(const PatchKey& key, std::uint32_t content = 1) {
  MapPatch patch;
  patch.id.key = key;
  patch.images = 1;
  PatchBlock block;
  block.index = {static_cast<int>(key.number % 7), static_cast<int>(key.robot), 0};
  block.weight[key.number % 512] = content;
  block.distance[key.number % 512] = 5;
  patch.blocks.push_back(block);
  return patch;
}
Envelope from(RobotId sender, const Outgoing& o) {
  return {.kind = o.kind, .sender = sender, .body = o.body};
}
using Team = std::vector<PatchSync<>>;
Team team_of(std::size_t n, PatchSyncOptions options = {}) {
  Team team;
  for (RobotId r = 0; r < n; ++r) team.emplace_back(r, options);
  return team;
}
bool all_equal(const Team& team) {
  return std::all_of(team.begin(), team.end(), [&](const PatchSync<>& s) {
    return s.digest() == team[0].digest() && s.held() == team[0].held();
  });
}
std::size_t count_kind(const std::vector<Outgoing>& out, MessageKind kind) {
  return static_cast<std::size_t>(
      std::count_if(out.begin(), out.end(), [&](const Outgoing& o) { return o.kind == kind; }));
}

/// What may go wrong for a while: loss, duplicates, delay by ticks, robots that start late, and
/// requests for nothing. Ends with digests equal, or not.
bool schedule_converges(std::uint64_t seed) {
  Random random(seed);
  const std::size_t robots = 2 + random.below(3);
  Team team = team_of(robots, {.digest_period = 1.0, .first_timeout = 1.0});
  struct InTransit {
    std::uint64_t due;
    RobotId from, to;
    std::shared_ptr<const Outgoing> message;
  };
  std::vector<InTransit> air;
  const double loss = random.uniform(0.0, 0.7), twice = random.uniform(0.0, 0.3);
  const std::uint64_t delay = 1 + random.below(6);
  std::vector<std::uint64_t> starts, closes(robots, 0);
  std::vector<std::uint32_t> next(robots, 0);
  for (std::size_t r = 0; r < robots; ++r)
    starts.push_back(random.below(3) == 0 ? random.below(12) : 0);
  std::uint64_t tick = 0;
  for (; tick < 400; ++tick) {
    const bool rough = tick < 14;
    const double now = 0.5 * static_cast<double>(tick);
    for (std::size_t i = 0; i < air.size();) {
      if (air[i].due > tick) {
        ++i;
        continue;
      }
      if (tick >= starts[air[i].to]) team[air[i].to].hear(from(air[i].from, *air[i].message), now);
      air[i] = std::move(air.back());
      air.pop_back();
    }
    for (RobotId r = 0; r < robots; ++r) {
      if (tick < starts[r]) continue;
      if (rough && random.below(5) == 0) team[r].publish(small_patch({r, 0, next[r]++}));
      std::vector<Outgoing> out = team[r].speak(now);
      if (rough && random.below(12) == 0) {
        ByteWriter body;
        PatchIdSet none;
        none.insert({static_cast<RobotId>(random.below(4)), 3,
                     static_cast<std::uint32_t>(random.below(9))});
        none.put(body);
        out.push_back({MessageKind::request, std::nullopt, body.take()});
      }
      for (Outgoing& o : out) {
        const auto shared = std::make_shared<const Outgoing>(std::move(o));
        for (RobotId to = 0; to < robots; ++to) {
          if (to == r || (shared->to && *shared->to != to)) continue;
          if (rough && random.uniform() < loss) continue;
          const int copies = rough && random.uniform() < twice ? 2 : 1;
          for (int c = 0; c < copies; ++c)
            air.push_back({tick + 1 + (rough ? random.below(delay) : 0), r, to, shared});
        }
      }
    }
    if (tick > 14 && all_equal(team)) break;
  }
  const std::uint64_t made = std::accumulate(next.begin(), next.end(), std::uint64_t{0});
  return all_equal(team) && team[0].held().size() == made;
}
}  // namespace

TEST(sets_of_patches_are_sets) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::set<PatchKey> truth, other_truth;
    PatchIdSet set, other;
    for (int i = 0; i < 60; ++i) {
      const PatchKey key{
          static_cast<RobotId>(random.below(3)), static_cast<std::uint32_t>(random.below(2)),
          random.below(8) == 0 ? 0xFFFFFFFFU - static_cast<std::uint32_t>(random.below(3))
                               : static_cast<std::uint32_t>(random.below(25))};
      if (random.below(3) != 0)
        CHECK(set.insert(key) == truth.insert(key).second);
      else
        CHECK(other.insert(key) == other_truth.insert(key).second);
      CHECK(set.contains(key) == truth.contains(key));
    }
    CHECK(set.size() == truth.size());
    std::vector<PatchKey> beyond, expected;
    set.for_each_beyond(other, [&](const PatchKey& k) {
      beyond.push_back(k);
      return true;
    });
    std::set_difference(truth.begin(), truth.end(), other_truth.begin(), other_truth.end(),
                        std::back_inserter(expected));
    CHECK(beyond == expected);
    ByteWriter out;
    set.put(out);
    ByteReader in(out.bytes(), "set");
    const PatchIdSet back = PatchIdSet::get(in, "set");
    CHECK(back == set && back.size() == set.size() && in.remaining() == 0);
    for (std::size_t n = 0; n < out.bytes().size(); ++n) {
      ByteReader cut(std::span(out.bytes()).first(n), "set");
      CHECK_THROWS(Error, PatchIdSet::get(cut, "set"));
    }
  }
}

TEST(ten_thousand_schedules_end_with_equal_digests) {
  std::size_t failed = 0;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) failed += schedule_converges(seed) ? 0 : 1;
  CHECK(failed == 0);
}

TEST(nothing_is_asked_for_when_nothing_is_lost) {
  Team team = team_of(3);
  std::size_t requests = 0, patches = 0;
  for (int tick = 0; tick < 200; ++tick) {
    std::vector<std::pair<RobotId, Outgoing>> said;
    for (RobotId r = 0; r < 3; ++r) {
      if (tick % 10 == 5 && tick < 100)
        team[r].publish(small_patch({r, 0, static_cast<std::uint32_t>(tick / 10)}));
      std::vector<Outgoing> out = team[r].speak(0.1 * tick);
      requests += count_kind(out, MessageKind::request);
      patches += count_kind(out, MessageKind::patch);
      for (Outgoing& o : out) said.emplace_back(r, std::move(o));
    }
    for (const auto& [r, o] : said)
      for (RobotId to = 0; to < 3; ++to)
        if (to != r) team[to].hear(from(r, o), 0.1 * tick);
  }
  CHECK(requests == 0 && patches == 30 && all_equal(team) && team[0].held().size() == 30);
  CHECK(team[0].take_arrived().size() == 20 && team[0].take_arrived().empty());
  CHECK(team[1].digest_of(0, 20.0) == team[0].digest());
  CHECK(!team[1].digest_of(0, 60.0) && !team[1].digest_of(7, 20.0));
  CHECK(team[0].patch({1, 0, 3}).blocks == small_patch({1, 0, 3}).blocks);
  CHECK_THROWS(Error, team[0].patch({1, 0, 30}));
  CHECK_THROWS(Error, team[0].publish(small_patch({0, 0, 0})));
}

TEST(the_nearest_holder_is_asked_then_the_next_then_after_a_pause_again) {
  PatchSync<> robot(0, {.first_timeout = 1.0});
  robot.distance = [](RobotId mate) { return mate == 2 ? 1.0 : 10.0 * mate; };
  const PatchKey key{4, 0, 0};
  std::vector<PatchSync<>> mates;
  for (RobotId r = 1; r <= 3; ++r) {
    mates.emplace_back(r);
    mates.back().hear(from(9, {MessageKind::patch, {}, encode_patch(small_patch(key)).bytes}), 0.0);
  }
  std::vector<RobotId> asked;
  std::vector<double> when;
  for (int tick = 0; tick < 200; ++tick) {
    const double now = 0.05 * tick;
    for (RobotId r = 1; r <= 3; ++r)
      for (const Outgoing& o : mates[r - 1].speak(now))
        if (o.kind == MessageKind::digest) robot.hear(from(r, o), now);
    for (const Outgoing& o : robot.speak(now))
      if (o.kind == MessageKind::request) {
        asked.push_back(*o.to);
        when.push_back(now);
      }
  }
  CHECK(robot.missing() == 1);
  CHECK(asked.size() >= 4 && asked[0] == 2 && asked[1] == 1 && asked[2] == 3 && asked[3] == 2);
  // One request at a time, at intervals that do not shrink.
  for (std::size_t i = 1; i < when.size(); ++i) CHECK(when[i] - when[i - 1] >= 1.0 - 0.06);
  // An answer ends it.
  robot.hear(from(2, {MessageKind::patch, {}, *mates[1].bytes(key)}), 10.0);
  CHECK(robot.missing() == 0 && robot.holds(key) && robot.take_arrived().size() == 1);
}

TEST(one_that_misses_much_is_served_by_all_that_have_it) {
  constexpr std::size_t kPatches = 400, kMates = 4;
  const PatchSyncOptions options{.requests = 8, .answer_bytes = 1};  // one patch a `speak`
  Team team = team_of(kMates + 1, options);
  team[0].distance = [](RobotId mate) { return 1.0 + mate; };
  for (std::uint32_t k = 0; k < kPatches; ++k)
    for (RobotId r = 1; r <= kMates; ++r)
      team[r].hear(from(9, {MessageKind::patch, {}, encode_patch(small_patch({9, 0, k})).bytes}),
                   0.0);
  std::array<std::size_t, kMates + 1> sent{};
  int tick = 0;
  for (; tick < 1000 && team[0].held().size() < kPatches; ++tick) {
    std::vector<std::pair<RobotId, Outgoing>> said;
    for (RobotId r = 0; r <= kMates; ++r)
      for (Outgoing& o : team[r].speak(0.25 * tick)) {
        if (o.kind == MessageKind::patch) ++sent[r];
        said.emplace_back(r, std::move(o));
      }
    for (const auto& [r, o] : said)
      for (RobotId to = 0; to <= kMates; ++to)
        if (to != r && (!o.to || *o.to == to)) team[to].hear(from(r, o), 0.25 * tick);
  }
  CHECK(all_equal(team) && team[0].held().size() == kPatches);
  for (RobotId r = 1; r <= kMates; ++r) CHECK(sent[r] >= kPatches / kMates / 2);
  CHECK(tick <= 3 * static_cast<int>(kPatches / kMates) / 2);
  CHECK(team[0].duplicates() <= kPatches / 20);
}

TEST(the_first_content_of_a_name_stays) {
  PatchSync<> robot(0);
  const auto patch = [](std::uint32_t content) {
    return Outgoing{MessageKind::patch, {}, encode_patch(small_patch({1, 0, 4}, content)).bytes};
  };
  robot.hear(from(1, patch(7)), 0.0);
  const std::uint64_t digest = robot.digest();
  robot.hear(from(1, patch(8)), 0.0);
  robot.hear(from(2, patch(7)), 0.0);
  CHECK(robot.drops()[MessageDrop::conflict] == 1 && robot.duplicates() == 1);
  CHECK(robot.digest() == digest && robot.take_arrived().size() == 1);
  CHECK(robot.patch({1, 0, 4}).blocks[0].weight[4] == 7);
  PatchSync<> other(5);
  other.hear(from(1, patch(8)), 0.0);
  CHECK(other.held() == robot.held() && other.digest() != robot.digest());
}

TEST(a_robot_that_is_started_again_gets_its_earlier_patches_and_makes_its_own) {
  PatchSync<> mate(1), robot(0, {.incarnation = 7});
  for (std::uint32_t n = 0; n < 4; ++n)  // of its earlier self
    mate.hear(from(0, {MessageKind::patch, {}, encode_patch(small_patch({0, 3, n})).bytes}), 0.0);
  mate.publish(small_patch({1, 0, 0}));
  // What only it can make is not taken from others, and none waits for it.
  for (const std::uint32_t n : {0U, 1U, 900U})
    robot.hear(from(1, {MessageKind::patch, {}, encode_patch(small_patch({0, 7, n}, 9)).bytes}),
               0.0);
  CHECK(robot.drops()[MessageDrop::impostor] == 3 && robot.held().size() == 0);
  ByteWriter claim;
  claim.put(std::uint64_t{1});
  for (const std::uint64_t v : {1U, 0U, 7U, 1U, 0U}) detail::put_varint(claim, v);
  detail::put_varint(claim, 0xFFFFFFFFU);
  robot.hear(from(1, {MessageKind::digest, {}, claim.take()}), 0.0);
  CHECK(robot.missing() == 0 && robot.drops()[MessageDrop::impostor] == 4);
  robot.publish(small_patch({0, 7, 0}));
  robot.publish(small_patch({0, 7, 1}));
  for (int tick = 1; tick < 40; ++tick) {
    const double now = 0.25 * tick;
    for (const Outgoing& o : robot.speak(now)) mate.hear(from(0, o), now);
    for (const Outgoing& o : mate.speak(now)) robot.hear(from(1, o), now);
  }
  CHECK(robot.held().size() == 7 && robot.digest() == mate.digest() && robot.missing() == 0);
  CHECK(robot.patch({0, 7, 0}).blocks[0].weight[0] == 1 && robot.holds({0, 3, 3}));
}

TEST(hostile_patches_are_refused_by_reason) {
  PatchLimits limits = patch_limits(
      PinholeCamera::from_fov(radians(90.0), radians(60.0), 80, 60, 0.1, 1.0), 0.3, 0.9);
  limits.image_weight = 1.0;
  PatchSync<> robot(0, {}, limits);
  const auto refused = [&](MessageDrop why, const MapPatch& patch, auto&& spoil) {
    Bytes bytes = encode_patch(patch).bytes;
    spoil(bytes);
    const std::uint64_t before = robot.drops()[why], all = robot.drops().total();
    robot.hear(from(1, {MessageKind::patch, {}, std::move(bytes)}), 0.0);
    return robot.drops()[why] == before + 1 && robot.drops().total() == all + 1;
  };
  const auto as_it_is = [](Bytes&) {};
  const MapPatch good = small_patch({1, 0, 0});
  CHECK(!refused(MessageDrop::conflict, good, as_it_is) && robot.drops().total() == 0);
  CHECK(refused(MessageDrop::conflict, small_patch({1, 0, 0}, 2), as_it_is));
  CHECK(refused(MessageDrop::checksum, good, [](Bytes& b) { b[50] ^= std::byte{1}; }));
  CHECK(refused(MessageDrop::malformed, good, [](Bytes& b) { b.resize(80); }));
  CHECK(refused(MessageDrop::impossible_weight, small_patch({1, 0, 1}, 4097), as_it_is));
  CHECK(!refused(MessageDrop::impossible_weight, small_patch({1, 0, 1}, 4096), as_it_is));
  MapPatch far = small_patch({1, 0, 2});
  far.blocks[0].index.x() = 1000;
  CHECK(refused(MessageDrop::out_of_reach, far, as_it_is));
  MapPatch wide = small_patch({1, 0, 3});
  wide.blocks.clear();
  for (int i = 0; i < 200; ++i) {
    PatchBlock b;
    b.index = {i % 10, 0, i / 10};
    b.weight[0] = 1;
    wide.blocks.push_back(b);
  }
  CHECK(refused(MessageDrop::bomb, wide, as_it_is));
  wide.images = 5;
  CHECK(!refused(MessageDrop::bomb, wide, as_it_is));
  MapPatch nobodys = small_patch({256, 0, 0});
  nobodys.blocks[0].index.y() = 0;
  CHECK(refused(MessageDrop::beyond_limits, nobodys, as_it_is));
  CHECK(robot.held().size() == 3 && robot.take_arrived().size() == 3);
}

TEST(liars_are_counted_and_bounded) {
  PatchSync<> robot(0, {.first_timeout = 1.0, .patches = 20, .robots = 50});
  PatchSync<> honest(2);
  for (std::uint32_t n = 0; n < 5; ++n) honest.publish(small_patch({2, 0, n}));
  // A mate that claims four thousand million patches, other ones each time.
  std::size_t requests = 0;
  for (int tick = 0; tick < 100; ++tick) {
    const double now = 0.25 * tick;
    ByteWriter body;
    body.put(std::uint64_t{1});
    for (const std::uint64_t v : {1U, 1U, static_cast<unsigned>(tick), 1U, 0U})
      detail::put_varint(body, v);
    detail::put_varint(body, 0xFFFFFFFFU);
    robot.hear(from(1, {MessageKind::digest, {}, body.take()}), now);
    CHECK(robot.missing() <= 1200);
    for (const Outgoing& o : honest.speak(now))
      if (o.kind == MessageKind::digest || o.to) robot.hear(from(2, o), now);
    for (const Outgoing& o : robot.speak(now)) {
      if (o.kind != MessageKind::request) continue;
      requests += *o.to == 1 ? 1 : 0;
      if (*o.to == 2) honest.hear(from(0, o), now);
    }
  }
  CHECK(robot.held().size() == 5 && requests < 150);
  CHECK(robot.drops()[MessageDrop::malformed] == 0);
  // Requests for nothing, and for everything.
  ByteWriter all;
  for (const std::uint64_t v : {1U, 2U, 0U, 1U, 0U}) detail::put_varint(all, v);
  detail::put_varint(all, 0xFFFFFFFFU);
  const Bytes everything = all.take();
  for (int i = 0; i < 50; ++i) honest.hear(from(1, {MessageKind::request, {}, everything}), 30.0);
  const std::uint64_t in_vain = honest.drops()[MessageDrop::in_vain];
  CHECK(in_vain > 0 && in_vain <= 50 * 64);
  CHECK(count_kind(honest.speak(30.0), MessageKind::patch) == 5);
  // Ids and amounts beyond what there can be.
  robot.hear(from(1, {MessageKind::patch, {}, encode_patch(small_patch({60, 0, 0})).bytes}), 31.0);
  for (std::uint32_t n = 0; n < 40; ++n)
    robot.hear(from(1, {MessageKind::patch, {}, encode_patch(small_patch({1, 0, n})).bytes}), 31.0);
  CHECK(robot.held().size() == 20 && robot.drops()[MessageDrop::beyond_limits] == 1 + 25);
  // Bytes that are nothing.
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    Bytes junk(random.below(60));
    for (std::byte& b : junk) b = static_cast<std::byte>(random.below(256));
    robot.hear(from(3, {static_cast<MessageKind>(random.below(5)), {}, junk}), 32.0);
  }
  CHECK(robot.drops()[MessageDrop::malformed] > 1000 && robot.held().size() == 20);
}

TEST(a_parted_team_holds_the_same_and_maps_the_same_when_it_meets) {
  SimulatedNetwork<Packet> network(
      4, {.loss = 0.2,
          .duplication = 0.1,
          .reordering = 0.1,
          .latency = 0.05,
          .jitter = 0.03,
          .bandwidth = 2e5,
          .partitions = {{.from = 2.0, .until = 20.0, .groups = {{0, 1}, {2, 3}}}}});
  Team team = team_of(4);
  std::vector<PatchFusion> maps(4);
  std::array<std::uint32_t, 4> number{};
  double equal_at = -1.0;
  for (int tick = 0; tick < 800; ++tick) {
    const double now = 0.1 * tick;
    network.advance(now);
    for (RobotId r = 0; r < 4; ++r) {
      for (const Message<Packet>& m : network.receive(r))
        team[r].hear(open_packet(*m.payload.bytes), now);
      for (const MapPatch& p : team[r].take_arrived()) maps[r].add(p);
      if (tick % 8 == static_cast<int>(r) && now < 20.0) {
        MapPatch p = small_patch({r, 0, number[r]++}, 1 + r);
        p.id = team[r].publish(p);
        maps[r].add(p);
      }
      for (Outgoing& o : team[r].speak(now))
        network.send({.time = now,
                      .from = r,
                      .to = o.to,
                      .payload = seal({.kind = o.kind, .sender = r, .body = o.body})});
    }
    if (now > 19.0 && now < 20.0) CHECK(!all_equal(team));
    if (now >= 20.0 && equal_at < 0.0 && all_equal(team)) equal_at = now;
  }
  CHECK(equal_at > 20.0 && equal_at < 35.0);
  CHECK(team[0].held().size() == 100);
  for (const PatchFusion& m : maps) {
    CHECK(m.size() == 100);
    m.map().for_each_block([&](const TsdfMap::Block& b) {
      const TsdfMap::Block* o = maps[0].map().find_block(b.index);
      bool same = o != nullptr;
      for (std::size_t i = 0; same && i < 512; ++i)
        same = o->voxels[i].weight == b.voxels[i].weight &&
               o->voxels[i].distance == b.voxels[i].distance;
      CHECK(same);
    });
  }
}
