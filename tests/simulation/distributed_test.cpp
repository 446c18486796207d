// SPDX-License-Identifier: MIT
#include <surfleet/simulation/distributed_simulation.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "box_world.hpp"
#include "check.hpp"

#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/planning/named_planners.hpp>

namespace {
using namespace surfleet;

DistributedResult fly(int robots, const DistributedOptions& d, int threads = 1) {
  box_world::World world;
  MissionOptions o = box_world::options(world);
  o.threads = threads;
  DistributedSimulation<box_world::World> simulation(
      o, d, world, box_world::starts(robots),
      [&](RobotId) { return make_planner("tsga", {.standoff = 2.0}); });
  DistributedResult result = simulation.run();
  // Nothing that honest robots say is disbelieved.
  for (int r = 0; r < robots; ++r) {
    const MessageDrops drops = simulation.robot(static_cast<RobotId>(r)).drops();
    for (std::size_t why = 0; why < kMessageDrops; ++why)
      if (const auto reason = static_cast<MessageDrop>(why);
          reason != MessageDrop::replayed && reason != MessageDrop::outdated)
        CHECK(drops[reason] == 0);
  }
  double least = 1e9;
  const auto& all = result.mission.trajectories;
  for (std::size_t r = 0; r < all.size(); ++r)
    for (std::size_t k = 0; k < all[r].size(); ++k) {
      CHECK(world.bvh.distance(all[r][k].configuration.position) > 0.4);
      for (std::size_t s = 0; s < r; ++s)
        if (k < all[s].size())
          least = std::min(
              least, (all[r][k].configuration.position - all[s][k].configuration.position).norm());
    }
  CHECK(least > 0.8);
  return result;
}

TEST(a_distributed_fleet_ends_with_equal_maps) {
  for (const char* name : {"perfect", "wifi", "poor"}) {
    const DistributedResult r = fly(3, {.network = NetworkConditions::named(name)});
    CHECK(r.mission.complete && r.maps_equal && r.lost.empty());
    CHECK(r.mission.coverage.share() > 0.9);
    CHECK(r.mission.total_path_length() > 5.0);
    for (const std::uint64_t bytes : r.bytes_sent) CHECK(bytes > 1000);
    CHECK((r.dropped[static_cast<std::size_t>(NetworkDrop::loss)] > 0) ==
          (std::string(name) != "perfect"));
  }
}
TEST(one_robot_of_a_distributed_fleet_works_alone) {
  const DistributedResult r = fly(1, {});
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
}
/// A robot that plans for itself as `CentralPlanning` has it, on a map in the numbers of patches.
std::vector<Configuration> flown_alone(const MissionOptions& o, box_world::World& world) {
  std::vector<Configuration> fleet = box_world::starts(1), path = fleet;
  using Body = SimulatedDrone<box_world::World>;
  Body body(world, 0, fleet, o.kind.limits, o.neighbours);
  const AnyPlanner planner = make_planner("tsga", {.standoff = 2.0});
  const SurfaceBeliefOptions b = SurfaceBelief::checked(belief_for(planner, o.belief));
  PatchRecorder recorder({.voxel_size = b.voxel_size}, *b.integrator);
  PatchFusion fusion({.voxel_size = b.voxel_size, .truncation = b.tsdf.truncation});
  SurfaceBelief belief(b, std::span<const RobotKind>(&o.kind, 1), &fusion.map());
  belief.add_known_free(0, {body.estimate().position, o.start_clearance});
  belief.update();
  std::array<std::unique_ptr<Agent<Body>>, 1> agents{
      std::make_unique<Agent<Body>>(0, 0, body, belief, o.agent)};
  CentralPlanning<AnyPlanner> planning(planner);
  for (int step = 0; step < 10000; ++step) {
    const double now = step * o.agent.image_period;
    Agent<Body>& agent = *agents[0];
    agent.sense();
    if (!agent.at_rest()) {
      recorder.integrate(agent.reading(), o.kind.sensor(), agent.sensor_pose());
      fusion.show_open(recorder.open());
    }
    // At rest what is open is told, as nothing will be added soon.
    if (recorder.due() || (agent.at_rest() && recorder.images() > 0)) {
      const MapPatch patch = recorder.close();
      fusion.close_open({&patch, 1});
    }
    belief.update();
    agent.check_stop();
    planning(agents, belief, now);
    if (planning.finished(agents, belief)) break;
    agent.move(now);
    path.push_back(fleet[0]);
  }
  return path;
}
TEST(one_robot_is_the_single_architecture_bit_by_bit) {
  box_world::World world;
  const std::vector<Configuration> single = flown_alone(box_world::options(world), world);
  const DistributedResult r = fly(1, {});
  CHECK(r.mission.complete && single.size() == r.mission.trajectories[0].size());
  std::size_t different = 0;
  for (std::size_t k = 0; k < std::min(single.size(), r.mission.trajectories[0].size()); ++k) {
    const Configuration& c = r.mission.trajectories[0][k].configuration;
    different += c.position == single[k].position && c.yaw == single[k].yaw ? 0 : 1;
  }
  CHECK(different == 0 && single.size() > 100);
}
TEST(what_one_robot_viewed_in_vain_no_other_views) {
  box_world::Glass world;
  for (const char* name : {"perfect", "wifi"}) {
    MissionOptions o = box_world::options(world);
    o.max_time = 2000.0;
    DistributedSimulation<box_world::Glass> simulation(
        o, {.network = NetworkConditions::named(name)}, world, box_world::starts(3),
        [&](RobotId) { return make_planner("tsga", {.standoff = 2.0}); });
    const DistributedResult r = simulation.run();
    CHECK(r.mission.complete && r.maps_equal);
    std::map<VoxelKey, std::set<RobotId>> viewers;
    ViewLedger all(o.belief.ledger);
    const auto& patches = simulation.robot(0).patches();
    patches.held().for_each_beyond({}, [&](const PatchKey& key) {
      const ViewNotes notes = patches.patch(key).notes;
      all.add(notes);
      for (const auto& view : notes.views) viewers[view.place].insert(key.robot);
      return true;
    });
    const auto again = std::count_if(viewers.begin(), viewers.end(),
                                     [](const auto& place) { return place.second.size() > 1; });
    CHECK(!viewers.empty() && again == 0);
    for (RobotId id = 0; id < 3; ++id) CHECK(simulation.robot(id).belief().ledger() == all);
  }
}
/// Finds nothing, and notes when it was asked while a mate had work.
struct FindsNothing {
  std::vector<double>* asked;
  Plan operator()(const SurfaceSituation& s) const {
    if (std::any_of(s.team.begin(), s.team.end(), [](const RobotState& r) { return !r.idle; }))
      asked->push_back(s.time);
    Plan plan;
    for (const RobotId id : s.asked) plan.routes[id];
    return plan;
  }
};
TEST(a_robot_without_work_asks_now_and_then_while_others_work) {
  box_world::World world;
  std::vector<double> asked;
  DistributedSimulation<box_world::World> simulation(
      box_world::options(world), {}, world, box_world::starts(2), [&](RobotId id) -> AnyPlanner {
        if (id == 1) return FindsNothing{&asked};
        return make_planner("surfleet", {.standoff = 2.0});
      });
  const DistributedResult r = simulation.run();
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
  CHECK(asked.size() > 3);
  for (std::size_t k = 1; k < asked.size(); ++k) CHECK(asked[k] - asked[k - 1] > 1.99);
}
TEST(patches_close_by_distance_too) {
  const auto patch_bytes = [](std::optional<double> distance) {
    DistributedOptions d;
    d.agent.patch_images = 1000;
    d.agent.patch_distance = distance;
    const DistributedResult r = fly(2, d);
    CHECK(r.mission.complete && r.maps_equal);
    return r.bytes_by_kind[static_cast<std::size_t>(MessageKind::patch)];
  };
  CHECK(patch_bytes(0.3) > patch_bytes({}));
}
TEST(a_fleet_that_hears_along_lines_of_sight_ends_with_equal_maps) {
  const DistributedResult r = fly(3, {.network = {.line_of_sight = true}});
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
  CHECK(r.dropped[static_cast<std::size_t>(NetworkDrop::out_of_range)] > 0);
}
TEST(threads_change_nothing_of_a_distributed_fleet) {
  const DistributedOptions d{.network = NetworkConditions::named("poor")};
  const DistributedResult a = fly(2, d, 1), b = fly(2, d, 2);
  CHECK(a.mission.completion_time == b.mission.completion_time);
  CHECK(a.bytes_sent == b.bytes_sent);
  for (std::size_t r = 0; r < 2; ++r)
    CHECK(a.mission.trajectories[r].back().configuration.position ==
          b.mission.trajectories[r].back().configuration.position);
}
TEST(a_fleet_goes_on_without_who_is_lost) {
  for (const auto kind : {FleetEvent::Kind::killed, FleetEvent::Kind::vanished})
    for (const double time : {3.0, 20.0}) {
      DistributedOptions d;
      d.events = {{.time = time, .robot = 1, .kind = kind}};
      const DistributedResult r = fly(3, d);
      CHECK(r.mission.complete && r.maps_equal && r.lost.size() == 1);
      CHECK(r.mission.coverage.share() > 0.9);
    }
}
TEST(a_parted_fleet_comes_together) {
  DistributedOptions d;
  d.network.partitions = {{.from = 2.0, .until = 30.0, .groups = {{0}, {1, 2}}}};
  const DistributedResult r = fly(3, d);
  CHECK(r.mission.complete && r.maps_equal && r.mission.coverage.share() > 0.9);
  CHECK(r.dropped[static_cast<std::size_t>(NetworkDrop::partition)] > 0);
  CHECK(r.catch_ups.size() == 1 && r.catch_ups[0].took);
  CHECK_NEAR(r.catch_ups[0].from, 30.0, 0.5);
  CHECK(*r.catch_ups[0].took > 0.0 && *r.catch_ups[0].took < 20.0);
}
TEST(a_robot_that_begins_anew_catches_up) {
  for (const bool hovered : {false, true}) {
    DistributedOptions d;
    d.network = NetworkConditions::named("wifi");
    d.events = {{.time = 20.0, .robot = 1, .kind = FleetEvent::Kind::restarted}};
    if (hovered) d.events.push_back({.time = 8.0, .robot = 1});
    const DistributedResult r = fly(3, d);
    CHECK(r.mission.complete && r.maps_equal && r.lost.empty());
    CHECK(r.mission.coverage.share() > 0.9);
    CHECK(r.catch_ups.size() == 1 && r.catch_ups[0].took && *r.catch_ups[0].took > 0.0);
    CHECK(*r.catch_ups[0].took < 20.0);
  }
}
/// Two robots, and one that says what none should.
TEST(a_liar_ends_no_mission_and_is_counted) {
  box_world::World world;
  const MissionOptions o = box_world::options(world);
  std::vector<Configuration> fleet = box_world::starts(2);
  using Body = SimulatedDrone<box_world::World>;
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::unique_ptr<DistributedAgent<Body>>> robots;
  for (RobotId r = 0; r < 2; ++r) {
    bodies.push_back(std::make_unique<Body>(world, r, fleet, o.kind.limits, o.neighbours));
    DistributedAgentOptions own;
    own.sync.robots = own.relay.robots = 3;
    robots.push_back(std::make_unique<DistributedAgent<Body>>(
        r, o.kind, *bodies[r], o.belief, o.agent, o.start_clearance,
        make_planner("tsga", {.standoff = 2.0}), own));
  }
  PerfectTransport<Packet> air(3);
  std::uint32_t number = 0;
  const auto lie = [&](double now, MessageKind kind, const Bytes& body,
                       std::optional<RobotId> to = {}) {
    air.send({.time = now,
              .from = 2,
              .to = to,
              .payload = seal({.kind = kind, .sender = 2, .number = number++, .body = body})});
  };
  const auto state = [&](auto&& spoil) {
    StateMessage m;
    m.news.push_back({{2, 0, number, 0, 0.0}, {}});
    spoil(m.news[0]);
    return encode_states(m);
  };
  const auto patch = [&](const PatchKey& key, int far, std::uint32_t weight, int blocks) {
    MapPatch p;
    p.id.key = key;
    p.voxel_size = o.belief.voxel_size;
    p.truncation = SurfaceBelief::checked(o.belief).tsdf.truncation;
    p.images = 1;
    for (int i = 0; i < blocks; ++i) {
      PatchBlock b;
      b.index = {far + i % 20, i / 20 % 20, i / 400};
      b.weight[0] = weight;
      p.blocks.push_back(b);
    }
    return encode_patch(p).bytes;
  };
  bool over = false;
  for (int step = 0; step < 3000 && !over; ++step) {
    const double now = step * o.agent.image_period;
    if (step % 4 == 0) {
      const auto n = static_cast<std::uint32_t>(step);
      lie(now, MessageKind::state, state([](StateNews& s) { s.state.kind = 1u << 30; }));
      lie(now, MessageKind::state, state([](StateNews& s) { s.state.at.position.z() = 1e6; }));
      lie(now, MessageKind::state, state([](StateNews& s) { s.head.robot = 1; }));
      for (RobotId r = 0; r < 2; ++r)  // as it will name its own
        lie(now, MessageKind::patch, patch({r, 0, n / 4}, 0, 1, 1), r);
      lie(now, MessageKind::patch, patch({2, 0, n}, 0, 1, 8000));
      lie(now, MessageKind::patch, patch({2, 0, n}, 1000, 1, 1));
      lie(now, MessageKind::patch, patch({2, 0, n}, 0, 1u << 30, 1));
      lie(now, MessageKind::route, Bytes(30, std::byte{0xFF}));
      air.send({.time = now,
                .from = 2,
                .payload = {MessageKind::state, std::make_shared<const Bytes>(7)}});
    }
    for (auto& robot : robots) robot->observe(now, air.receive(robot->id()));
    over = robots[0]->finished() && robots[1]->finished();
    std::vector<Message<Packet>> said;
    for (auto& robot : robots)
      for (Message<Packet>& m : robot->act(now)) said.push_back(std::move(m));
    for (Message<Packet>& m : said) air.send(std::move(m));
  }
  CHECK(over && equal_maps(robots[0]->map(), robots[1]->map()));
  CHECK(robots[0]->belief().estimate_coverage().share() > 0.9);
  for (const auto& robot : robots) {
    const MessageDrops drops = robot->drops();
    for (const MessageDrop why :
         {MessageDrop::unknown_kind, MessageDrop::out_of_bounds, MessageDrop::impostor,
          MessageDrop::bomb, MessageDrop::out_of_reach, MessageDrop::impossible_weight,
          MessageDrop::malformed, MessageDrop::truncated})
      CHECK(drops[why] > 10);
    CHECK(!robot->team().last_of(2, 0.0));
  }
}
TEST(a_fleet_has_caught_up_when_all_hold_what_anybody_held) {
  const auto set = [](std::initializer_list<std::uint32_t> numbers) {
    PatchIdSet s;
    for (const std::uint32_t n : numbers) s.insert({.robot = 0, .incarnation = 0, .number = n});
    return s;
  };
  CatchUpWatch watch(
      {.partitions = {{.from = 1.0, .until = 4.0, .groups = {}}}, .cuts = {{.until = 6.0}}});
  const auto observe = [&](double now, const PatchIdSet& a, const PatchIdSet& b) {
    watch.observe(now, std::array{&a, &b});
  };
  observe(3.0, set({1}), set({2}));
  CHECK(watch.catch_ups().empty());
  observe(4.0, set({1, 2}), set({2, 3}));
  observe(5.0, set({1, 2, 3}), set({2, 3, 4}));
  CHECK(watch.catch_ups().size() == 1 && !watch.catch_ups()[0].took);
  observe(6.0, set({1, 2, 3}), set({1, 2, 3}));  // what came later is not asked for
  CHECK(watch.catch_ups().size() == 2);
  CHECK(watch.catch_ups()[0].took == 2.0 && watch.catch_ups()[1].took == 0.0);
}
}  // namespace
