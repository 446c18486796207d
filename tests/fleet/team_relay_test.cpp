// SPDX-License-Identifier: MIT
#include <surfleet/fleet/team_relay.hpp>

#include <cmath>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
RobotState relay_state(RobotId id, double time, bool idle = false) {
  RobotState s;
  s.id = id;
  s.kind = 1;
  s.at = {Point3(10.0 * id, 0.6 * time, 2.0), 0.5};
  s.ahead = {s.at.position, s.at.position + Point3(0, 3, 0)};
  s.idle = idle;
  s.done = true;
  s.holds = 77 + id;
  if (!idle) s.route = {{s.at, {{1, -2, static_cast<int>(id)}}}, {{Point3(1, 2, 3), -1.0}, {}}};
  return s;
}
/// A team whose clocks are all wrong, over a network whose links are told.
struct RelayTeam {
  std::size_t robots;
  std::function<bool(RobotId, RobotId)> linked = [](RobotId, RobotId) { return true; };
  SimulatedNetwork<Packet> network;
  std::vector<TeamRelay> relays;
  std::vector<MessageGuard> guards;
  std::vector<std::uint32_t> number;
  std::vector<char> mute;
  bool idle = false;
  double time = 0.0;

  explicit RelayTeam(std::size_t n, NetworkConditions conditions = {})
      : robots(n), network(n, along_links(std::move(conditions))), number(n, 0), mute(n, 0) {
    network.position = [](RobotId r) { return Point3(r, 0, 0); };
    network.line_of_sight = [this](const Point3& a, const Point3& b) {
      return linked(static_cast<RobotId>(a.x()), static_cast<RobotId>(b.x()));
    };
    for (RobotId r = 0; r < n; ++r) {
      relays.emplace_back(r, 0, TeamRelayOptions{.kinds = 2});
      guards.emplace_back(r);
    }
  }
  static NetworkConditions along_links(NetworkConditions conditions) {
    conditions.line_of_sight = true;
    return conditions;
  }
  double clock(RobotId r) const { return time + 3600.0 * r; }
  void run(double until) {
    for (; time < until - 1e-9; time += 0.125) {
      network.advance(time);
      for (RobotId r = 0; r < robots; ++r) {
        for (const auto& m : network.receive(r))
          if (const auto e = guards[r].admit(m.from, *m.payload.bytes, clock(r)))
            relays[r].hear(*e, clock(r));
        if (mute[r] != 0) continue;
        relays[r].set_own(relay_state(r, time, idle));
        for (const Outgoing& o : relays[r].speak(clock(r)))
          network.send({.time = time,
                        .from = r,
                        .to = o.to,
                        .payload = seal({.kind = o.kind,
                                         .sender = r,
                                         .incarnation = 0,
                                         .number = number[r]++,
                                         .body = o.body})});
      }
    }
  }
  std::vector<RobotId> team_of(RobotId r) const {
    std::vector<RobotId> ids;
    for (const RobotState& s : relays[r].mates(clock(r))) ids.push_back(s.id);
    return ids;
  }
};
using Ids = std::vector<RobotId>;
}  // namespace

TEST(the_graphs_of_a_team_in_and_out_of_touch) {
  // [000 Fig. 4.2]: complete, connected, in two parts, apart; and healed.
  RelayTeam team(3);
  team.run(5.0);
  for (RobotId r = 0; r < 3; ++r) {
    CHECK(team.team_of(r).size() == 2 && !team.relays[r].alone(team.clock(r)));
    CHECK(team.relays[r].relayed() <= 6);  // at first none knows which others are heard
  }
  const std::uint64_t before = team.relays[0].relayed();
  team.linked = [](RobotId a, RobotId b) { return a == 0 || b == 0; };
  team.run(12.0);
  CHECK(team.team_of(1) == Ids({0, 2}) && team.team_of(2) == Ids({0, 1}));
  CHECK(team.relays[0].relayed() > before + 10);
  CHECK(team.relays[1].hops_of(2) == 1 && team.relays[1].hops_of(0) == 0);
  const RobotState far = team.relays[1].mates(team.clock(1))[1];
  CHECK(far.id == 2 && far.kind == 1 && far.route.size() == 2 && far.ahead.size() == 2);
  CHECK(far.route[0].targets.size() == 1 && far.route[0].targets[0] == VoxelIndex(1, -2, 2));
  CHECK((far.at.position - relay_state(2, team.time - far.age).at.position).norm() < 0.4);
  team.linked = [](RobotId a, RobotId b) { return a + b == 1; };
  team.run(20.0);
  CHECK(team.team_of(0) == Ids({1}) && team.team_of(1) == Ids({0}) && team.team_of(2).empty());
  CHECK(team.relays[2].alone(team.clock(2)));
  CHECK_NEAR(team.relays[2].last_of(0, team.clock(2))->age, 8.0, 0.6);
  team.linked = [](RobotId, RobotId) { return false; };
  team.run(28.0);
  for (RobotId r = 0; r < 3; ++r) CHECK(team.team_of(r).empty());
  team.linked = [](RobotId, RobotId) { return true; };
  team.run(30.0);
  for (RobotId r = 0; r < 3; ++r) CHECK(team.team_of(r).size() == 2);
  CHECK(team.relays[2].drops().total() == 0);
}

TEST(who_stands_at_the_corner_of_a_wall_tells_either_side_of_the_other) {
  const TriangleMesh wall = make_box({Point3(-0.1, -4.0, -1.0), Point3(0.1, 4.0, 5.0)});
  const Bvh bvh(wall);
  RelayTeam team(3);
  std::vector<Point3> at{{-3, 0, 1}, {3, 0, 1}, {0, 6, 1}};
  team.network.position = [&](RobotId r) { return at[r]; };
  team.network.line_of_sight = [&](const Point3& a, const Point3& b) {
    return is_clear_segment(bvh, a, b);
  };
  team.run(6.0);
  CHECK(team.team_of(0) == Ids({1, 2}) && team.team_of(1) == Ids({0, 2}));
  CHECK(team.relays[0].hops_of(1) == 1 && team.relays[1].hops_of(0) == 1);
  CHECK(team.relays[0].hops_of(2) == 0 && team.relays[2].hops_of(0) == 0);
  for (const RobotState& mate : team.relays[0].mates(team.clock(0)))
    CHECK(mate.done && mate.holds == 77 + mate.id && team.relays[0].is_current(mate));
  RobotState old = *team.relays[0].last_of(1, team.clock(0));
  for (const double age : {3.5, 6.5}) {  // one hop away, it may be twice as late
    old.age = age;
    CHECK(team.relays[0].is_current(old) == (age < 6.0));
  }
  CHECK(team.network.dropped(NetworkDrop::out_of_range) > 20);
  at[2] = {3, 2, 1};  // behind the wall, too
  team.run(12.0);
  CHECK(team.team_of(0).empty() && team.team_of(1) == Ids({2}) && team.team_of(2) == Ids({1}));
  at[2] = {0, 6, 1};
  team.run(18.0);
  CHECK(team.team_of(0) == Ids({1, 2}) && team.team_of(1) == Ids({0, 2}));
}

TEST(news_travel_along_a_chain_and_grow_older) {
  RelayTeam team(6, {.latency = 0.1});
  team.linked = [](RobotId a, RobotId b) { return (a < b ? b - a : a - b) == 1; };
  team.run(15.0);
  for (RobotId r = 0; r < 6; ++r) CHECK(team.team_of(r).size() == 5);
  double last = -1.0;
  for (RobotId r = 1; r < 6; ++r) {
    CHECK(team.relays[0].hops_of(r) == static_cast<int>(r) - 1);
    const double age = team.relays[0].last_of(r, team.clock(0))->age;
    CHECK(age < 3.0 && age > last - 0.3);
    last = age;
  }
  CHECK(last > 0.2);
  // One falls silent: none keeps it alive by passing old news on.
  team.mute[3] = 1;
  team.run(25.0);
  CHECK(team.team_of(0) == Ids({1, 2}) && team.team_of(5) == Ids({4}));
}

TEST(a_cut_in_one_direction_is_gone_around) {
  RelayTeam team(3);
  team.linked = [](RobotId a, RobotId b) { return !(a == 0 && b == 1); };
  team.run(8.0);
  CHECK(team.team_of(1) == Ids({0, 2}) && team.relays[1].hops_of(0) == 1);
  CHECK(team.team_of(0) == Ids({1, 2}) && team.relays[0].hops_of(1) == 0);
}

TEST(idle_robots_stay_of_the_team_and_say_little) {
  RelayTeam team(8);
  team.idle = true;
  team.run(10.0);
  const std::uint64_t before = team.network.bytes_sent(3);
  team.run(110.0);
  CHECK(team.team_of(5).size() == 7);
  CHECK(static_cast<double>(team.network.bytes_sent(3) - before) / 100.0 < 1000.0);
}

TEST(pitches_of_gimbals_are_told) {
  for (const double pitch : {0.0, -0.7, 1.2}) {
    StateMessage m;
    m.news.push_back({{1, 1, 900, 0, 0.5}, relay_state(1, 0.0)});
    m.news[0].state.at.pitch = pitch;
    const StateMessage told = decode_states(encode_states(m));
    CHECK(told.news[0].state.at.pitch == pitch && told.news[0].state.at.yaw == 0.5);
    RouteNews news{{1, 1, 900, 0, 0.5}, relay_state(1, 0.0).route};
    news.route[1].configuration.pitch = pitch;
    const Stops route = decode_routes(encode_routes({news, news}))[1].route;
    CHECK(route[0].configuration.pitch == 0.0 && route[1].configuration.pitch == pitch);
    CHECK(route[0].targets == news.route[0].targets && route[1].configuration.yaw == -1.0);
  }
}
TEST(news_that_cannot_be_are_not_believed) {
  TeamRelay relay(0, 0, {.robots = 10, .kinds = 2, .speed = 5.0, .slack = 2.0});
  std::uint32_t number = 0;
  const auto say = [&](RobotId sender, RobotId about, double x, double now, std::uint8_t hops = 0,
                       std::uint32_t incarnation = 0) {
    StateMessage m;
    m.news.push_back({{about, incarnation, number++, hops, 0.0}, {}});
    m.news[0].state.at.position = Point3(x, 0, 0);
    const Bytes body = encode_states(m);
    relay.hear({.kind = MessageKind::state,
                .sender = sender,
                .incarnation = sender == about ? incarnation : 0,
                .body = body},
               now);
  };
  const auto x_of = [&](RobotId id) { return relay.last_of(id, 0.0)->at.position.x(); };
  say(1, 1, 0.0, 0.0);
  say(1, 1, 4.0, 1.0);
  CHECK(x_of(1) == 4.0);
  say(1, 1, 100.0, 2.0);
  CHECK(x_of(1) == 4.0 && relay.drops()[MessageDrop::jump] == 1);
  say(1, 1, 100.0, 30.0);  // by now it may be there
  CHECK(x_of(1) == 100.0);
  say(1, 1, 0.0, 30.5, 0, 1);  // started again
  CHECK(x_of(1) == 0.0);
  say(1, 1, 0.5, 30.6, 0, 0);  // its earlier self comes too late
  CHECK(x_of(1) == 0.0);
  say(2, 1, 0.5, 31.0, 0, 1);  // another speaks for it as itself
  CHECK(x_of(1) == 0.0);
  say(2, 1, 0.5, 31.0, 1, 1);
  CHECK(x_of(1) == 0.5);
  say(2, 0, 7.0, 31.0, 1);  // of ourselves we know better
  CHECK(!relay.last_of(0, 31.0));
  say(2, 77, 7.0, 31.0, 1);
  say(2, 3, 7.0, 31.0, 200);
  CHECK(relay.drops()[MessageDrop::beyond_limits] == 2 && !relay.last_of(77, 31.0) &&
        !relay.last_of(3, 31.0));
  Random random(5);
  StateMessage m;
  m.hears = {1, 2};
  m.news.push_back({{1, 1, 900, 0, 0.5}, relay_state(1, 0.0)});
  const Bytes states = encode_states(m);
  const Bytes routes = encode_routes({{{1, 1, 900, 0, 0.5}, relay_state(1, 0.0).route}});
  m.news[0].state.at.pitch = 0.7;
  RouteNews tilted{{1, 1, 900, 0, 0.5}, relay_state(1, 0.0).route};
  tilted.route[1].configuration.pitch = -0.7;
  const Bytes tilted_states = encode_states(m), tilted_routes = encode_routes({tilted});
  CHECK(tilted_states.size() == states.size() + 8);
  CHECK(tilted_routes.size() == routes.size() + 2 * 8 + 2);  // and a longer number of news
  for (const auto& [kind, good] :
       {std::pair(MessageKind::state, states), std::pair(MessageKind::route, routes),
        std::pair(MessageKind::state, tilted_states),
        std::pair(MessageKind::route, tilted_routes)}) {
    for (std::size_t n = 0; n < good.size(); ++n) {
      const std::uint64_t before = relay.drops().total();
      relay.hear({.kind = kind, .sender = 1, .body = std::span(good).first(n)}, 32.0);
      CHECK(relay.drops().total() == before + 1);
    }
    for (int i = 0; i < 2000; ++i) {
      Bytes bad = good;
      for (int k = 0; k < 3; ++k)
        bad[random.below(bad.size())] = static_cast<std::byte>(random.below(256));
      relay.hear({.kind = kind, .sender = 1, .body = bad}, 32.0);
    }
  }
  for (const RobotState& s : relay.mates(32.0)) CHECK(s.at.position.allFinite() && s.id < 10);
}

TEST(hostile_news_are_refused_by_reason) {
  TeamRelay relay(0, 0,
                  {.robots = 10,
                   .kinds = 2,
                   .bounds = Box3(Point3(-10, -10, 0), Point3(10, 10, 20)),
                   .slack = 5.0});
  std::uint32_t number = 0;
  const auto refused = [&](MessageDrop why, MessageKind kind, const Bytes& body) {
    const std::uint64_t before = relay.drops()[why], all = relay.drops().total();
    relay.hear({.kind = kind, .sender = 1, .incarnation = 3, .body = body}, 0.1 * number);
    return relay.drops()[why] == before + 1 && relay.drops().total() == all + 1;
  };
  const auto state = [&](auto&& spoil) {
    StateMessage m;
    m.news.push_back({{1, 3, number++, 0, 0.0}, {}});
    m.news[0].state.at.position = Point3(1, 2, 3);
    m.news[0].state.ahead = {Point3(1, 2, 3), Point3(4, 2, 3)};
    spoil(m.news[0]);
    return encode_states(m);
  };
  const auto route = [&](auto&& spoil) {
    RouteNews n{{1, 3, number++, 0, 0.0}, {{{Point3(1, 2, 3), 0.0}, {{1, 2, 3}}}}};
    spoil(n);
    return encode_routes({n});
  };
  const auto refuses_state = [&](MessageDrop why, auto&& spoil) {
    return refused(why, MessageKind::state, state(spoil));
  };
  const auto refuses_route = [&](MessageDrop why, auto&& spoil) {
    return refused(why, MessageKind::route, route(spoil));
  };
  const double none = std::nan("");
  CHECK(!refuses_state(MessageDrop::unknown_kind, [](StateNews& n) { n.state.kind = 1; }));
  CHECK(relay.drops().total() == 0 && relay.last_of(1, 0.0)->kind == 1);
  for (const RobotKindId kind : {2U, 77U, 0xFFFFFFFFU})
    CHECK(refuses_state(MessageDrop::unknown_kind, [&](StateNews& n) { n.state.kind = kind; }));
  CHECK(relay.last_of(1, 0.0)->kind == 1);
  constexpr MessageDrop kOut = MessageDrop::out_of_bounds;
  for (const double v : {none, 1e30, HUGE_VAL, 100.0, -15.5}) {
    CHECK(refuses_state(kOut, [&](StateNews& n) { n.state.at.position.x() = v; }));
    CHECK(refuses_state(kOut, [&](StateNews& n) { n.state.ahead[1].y() = v; }));
    CHECK(refuses_route(kOut, [&](RouteNews& n) { n.route[0].configuration.position.x() = v; }));
  }
  CHECK(!refuses_state(kOut, [](StateNews& n) { n.state.ahead[1].y() = -14.5; }));
  for (const double v : {none, HUGE_VAL, 1e5}) {
    CHECK(refuses_state(kOut, [&](StateNews& n) { n.state.at.yaw = v; }));
    CHECK(refuses_state(kOut, [&](StateNews& n) { n.state.at.pitch = v; }));
    CHECK(refuses_route(kOut, [&](RouteNews& n) { n.route[0].configuration.yaw = v; }));
  }
  CHECK(refuses_route(kOut, [](RouteNews& n) { n.route[0].targets[0].z() = 1 << 30; }));
  CHECK(refuses_state(kOut, [&](StateNews& n) { n.head.age = none; }));
  // Of ids, and by others.
  CHECK(refuses_state(MessageDrop::beyond_limits, [](StateNews& n) { n.head.robot = 10; }));
  CHECK(refuses_state(MessageDrop::beyond_limits, [](StateNews& n) { n.head.hops = 9; }));
  CHECK(refuses_state(MessageDrop::impostor, [](StateNews& n) { n.head.robot = 2; }));
  CHECK(refuses_state(MessageDrop::impostor, [](StateNews& n) { n.head.hops = 1; }));
  CHECK(refuses_state(MessageDrop::impostor, [](StateNews& n) { n.head.incarnation = 4; }));
  CHECK(refuses_route(MessageDrop::impostor, [](RouteNews& n) { n.head.incarnation = 4; }));
  // Millions of news, points, stops and targets, declared or there.
  constexpr MessageDrop kMany = MessageDrop::beyond_limits;
  ByteWriter many;
  detail::put_varint(many, 0);
  detail::put_varint(many, 5'000'000);
  CHECK(refused(kMany, MessageKind::state, many.take()));
  detail::put_varint(many, 5'000'000);
  CHECK(refused(kMany, MessageKind::route, many.take()));
  const auto long_route = [&](std::uint64_t stops, std::uint64_t targets, std::uint64_t of_each) {
    ByteWriter out;
    detail::put_varint(out, 1);
    detail::put_head(out, {1, 3, number++, 0, 0.0});
    detail::put_varint(out, stops);
    for (std::uint64_t s = 0; s < stops; ++s) {
      detail::put_configuration(out, {});
      detail::put_varint(out, targets);
      for (std::uint64_t t = 0; t < 3 * of_each; ++t) detail::put_varint(out, 0);
    }
    return out.take();
  };
  CHECK(refused(kMany, MessageKind::route, long_route(1025, 0, 0)));
  CHECK(!refused(kMany, MessageKind::route, long_route(1024, 64, 64)));
  CHECK(refused(kMany, MessageKind::route, long_route(1024, 65, 65)));
  CHECK(refused(kMany, MessageKind::route, long_route(1, 1'000'000, 0)));
  // A robot's own route is cut to what its mates take.
  RouteNews own{{1, 3, number++, 0, 0.0}, Stops(1100)};
  for (Stop& stop : own.route) stop.targets.assign(100, VoxelIndex(1, 2, 3));
  CHECK(!refused(kMany, MessageKind::route, encode_routes({own})));
  CHECK(relay.last_of(1, 0.0)->route.size() == 1024);
  CHECK(relay.mates(0.1 * number).size() == 1);
}

TEST(what_others_tell_of_a_mate_gives_way_to_its_own_word) {
  TeamRelay relay(0);
  const auto say = [&](RobotId sender, RobotId about, std::uint32_t number, double x, double now,
                       std::uint32_t incarnation = 0) {
    const NewsHead head{about, incarnation, number,
                        sender == about ? std::uint8_t{0} : std::uint8_t{1}, 0.0};
    StateMessage m;
    m.news.push_back({head, {}});
    m.news[0].state.at.position = Point3(x, 0, 0);
    const Bytes state = encode_states(m), route = encode_routes({{head, Stops(1 + number % 7)}});
    for (const auto& [kind, body] :
         {std::pair(MessageKind::state, &state), std::pair(MessageKind::route, &route)})
      relay.hear({.kind = kind,
                  .sender = sender,
                  .incarnation = sender == about ? incarnation : 0,
                  .body = *body},
                 now);
  };
  const auto x_of = [&] { return relay.last_of(1, 0.0)->at.position.x(); };
  const auto stops = [&] { return relay.last_of(1, 0.0)->route.size(); };
  say(1, 1, 10, 1.0, 0.0);
  say(2, 1, 14, 2.0, 0.2);  // some of its news were lost
  CHECK(x_of() == 2.0 && stops() == 1 && relay.drops().total() == 0);
  say(2, 1, 4000000000U, 3.0, 0.3);  // it cannot have said so much, nor have been started again
  say(2, 1, 3, 3.0, 0.3, 1);
  CHECK(x_of() == 2.0 && stops() == 1 && relay.drops()[MessageDrop::impostor] == 4);
  say(1, 1, 13, 4.0, 0.4);  // overtaken
  CHECK(x_of() == 2.0);
  // Not heard itself it may be told of anew, until it is.
  say(2, 1, 4000000001U, 9.0, 10.0);
  CHECK(x_of() == 9.0 && stops() == 4000000001U % 7 + 1);
  say(1, 1, 40, 5.0, 10.5);
  CHECK(x_of() == 5.0 && stops() == 40 % 7 + 1);
  say(2, 1, 4000000002U, 9.0, 10.6);
  CHECK(x_of() == 5.0 && stops() == 40 % 7 + 1);
  // Nor does one that was never heard itself stay what others made of it.
  TeamRelay late(0);
  std::swap(relay, late);
  say(2, 1, 4000000000U, 90.0, 0.0, 77);
  say(1, 1, 0, 1.0, 0.5, 5);
  CHECK(x_of() == 1.0 && stops() == 1);
}
TEST(a_mate_that_is_started_again_is_its_new_self) {
  TeamRelay relay(0);
  const auto say = [&](std::uint32_t incarnation, std::uint32_t number, MessageKind kind) {
    const NewsHead head{1, incarnation, number, 0, 0.0};
    StateMessage m;
    m.news.push_back({head, {}});
    m.news[0].state.at.position = Point3(50.0 * incarnation, 0, 0);
    const Bytes body =
        kind == MessageKind::state ? encode_states(m) : encode_routes({{head, Stops(3)}});
    relay.hear({.kind = kind, .sender = 1, .incarnation = incarnation, .body = body}, 1.0);
  };
  say(4, 900, MessageKind::state);
  say(4, 900, MessageKind::route);
  CHECK(relay.last_of(1, 1.0)->route.size() == 3);
  say(5, 0, MessageKind::state);  // elsewhere, and its numbers begin anew
  CHECK(relay.last_of(1, 1.0)->at.position.x() == 250.0);
  CHECK(relay.last_of(1, 1.0)->route.empty() && relay.drops().total() == 0);
  say(4, 901, MessageKind::route);
  say(4, 901, MessageKind::state);
  CHECK(relay.last_of(1, 1.0)->at.position.x() == 250.0 && relay.last_of(1, 1.0)->route.empty());
  say(5, 0, MessageKind::route);
  CHECK(relay.last_of(1, 1.0)->route.size() == 3);
}

TEST(mail_is_read_once_of_the_team_and_in_measure) {
  MessageGuard guard(0, {.team = 7, .messages_rate = 10.0, .messages_burst = 50.0});
  const auto packet = [](std::uint32_t number, std::uint32_t incarnation = 0,
                         std::uint32_t team = 7, RobotId sender = 1) {
    return *seal({.kind = MessageKind::digest,
                  .team = team,
                  .sender = sender,
                  .incarnation = incarnation,
                  .number = number,
                  .body = {}})
                .bytes;
  };
  CHECK(guard.admit(1, packet(5), 0.0)->number == 5);
  CHECK(!guard.admit(1, packet(5), 0.0) && guard.drops()[MessageDrop::replayed] == 1);
  CHECK(guard.admit(1, packet(3), 0.0) && guard.admit(1, packet(2000), 0.0));
  CHECK(!guard.admit(1, packet(900), 0.0));  // out of the window
  CHECK(guard.admit(1, packet(1500), 0.0) && !guard.admit(1, packet(1500), 0.0));
  CHECK(!guard.admit(1, packet(3000, 0, 8), 0.0) && !guard.admit(2, packet(3000), 0.0) &&
        !guard.admit(0, packet(1, 0, 7, 0), 0.0));
  CHECK(guard.drops()[MessageDrop::foreign] == 3);
  CHECK(guard.admit(1, packet(0, 1), 0.0) && !guard.admit(1, packet(4000), 0.0));
  CHECK(guard.drops()[MessageDrop::outdated] == 1);
  Bytes bad = packet(9, 1);
  for (std::size_t n = 0; n < bad.size(); n += 5) {
    Bytes b = bad;
    b[n] ^= std::byte{16};
    CHECK(!guard.admit(1, b, 0.0));
  }
  CHECK(guard.drops()[MessageDrop::checksum] == 5);
  CHECK(!guard.admit(1, std::span(bad).first(20), 0.0) && !guard.admit(1, {}, 0.0));
  CHECK(guard.drops()[MessageDrop::truncated] == 2);
  bad[3] = std::byte{9};  // no kind of message, with its checksum put right
  const std::uint32_t sum = crc32(std::span(bad).first(bad.size() - 4));
  std::memcpy(bad.data() + bad.size() - 4, &sum, sizeof(sum));
  CHECK(!guard.admit(1, bad, 0.0) && guard.drops()[MessageDrop::malformed] == 1);
  int read = 0;
  for (std::uint32_t n = 100; n < 400; ++n) read += guard.admit(1, packet(n, 1), 1.0) ? 1 : 0;
  CHECK(read > 30 && read < 60 && guard.drops()[MessageDrop::flood] > 200);
  read = 0;
  for (std::uint32_t n = 400; n < 500; ++n)
    read += guard.admit(1, packet(n, 1), 2.0 + 0.1 * (n - 400)) ? 1 : 0;
  CHECK(read > 95);
  // Every number of a long run once, whatever the order within the window.
  ReplayWindow window;
  Random random(2);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t base = 0; base < 20000; base += 500) {
    for (std::uint32_t n = 0; n < 500; ++n) numbers.push_back(base + n);
    for (std::size_t i = numbers.size(); i > numbers.size() - 499; --i)
      std::swap(numbers[i - 1],
                numbers[numbers.size() - 500 + random.below(500 - (numbers.size() - i))]);
  }
  std::size_t accepted = 0, again = 0;
  for (const std::uint32_t n : numbers) {
    accepted += window.accept(n) ? 1 : 0;
    again += window.accept(n) ? 1 : 0;
  }
  CHECK(accepted == 20000 && again == 0);
}
