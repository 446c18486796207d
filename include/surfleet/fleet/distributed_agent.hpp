// SPDX-License-Identifier: MIT
/// @file
/// @brief One robot of a distributed fleet: a map, a planner and a voice of its own [000 ch. 4].
///
///     agent.look(now, inbox);               // receive, sense, map, check stops, plan
///     for (auto& m : agent.act(now)) …      // give way, move, and what there is to tell
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/distributed_options.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/redundancy.hpp>
#include <surfleet/fleet/team_relay.hpp>
#include <surfleet/mapping/patch_fusion.hpp>
#include <surfleet/mapping/patch_recorder.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// The agent of one robot with its own belief, made of its own and others' patches. It plans for
/// itself and for mates without work, and takes its own route of that plan (dist-TSGA [000 Alg. 5],
/// or any other planner by the same rule); mates under way keep the routes they told. Alone, for as
/// long as nobody is heard, it is the single architecture.
template <RobotBody Body, FleetPlanner Planner = AnyPlanner, BytePacker Packer = PlainPacker>
class DistributedAgent {
 public:
  /// The body must outlive it. What is within `start_clearance` of it is taken for free [m]. Throws
  /// `Error` on options out of range.
  DistributedAgent(RobotId id, const RobotKind& kind, Body& body, SurfaceBeliefOptions belief,
                   AgentOptions agent, double start_clearance, Planner planner,
                   DistributedAgentOptions options = {}, Packer packer = {})
      : DistributedAgent(Settled{}, id, kind, body, settled(std::move(belief)), agent,
                         start_clearance, std::move(planner), options, std::move(packer)) {}
  DistributedAgent(const DistributedAgent&) = delete;
  DistributedAgent& operator=(const DistributedAgent&) = delete;

 private:
  struct Settled {};
  static SurfaceBeliefOptions settled(SurfaceBeliefOptions o) {
    if (o.tsdf.truncation <= 0.0) o.tsdf.truncation = 3.0 * o.voxel_size;
    return o;
  }
  DistributedAgent(Settled, RobotId id, const RobotKind& kind, Body& body,
                   const SurfaceBeliefOptions& belief, AgentOptions agent, double start_clearance,
                   Planner planner, const DistributedAgentOptions& options, Packer packer)
      : id_(id),
        options_(options),
        planner_(std::move(planner)),
        recorder_({.robot = id,
                   .incarnation = options.incarnation,
                   .voxel_size = belief.voxel_size,
                   .images = options.patch_images},
                  belief.tsdf,
                  DropOffWeight<>{.full = belief.voxel_size, .zero = 1.5 * belief.voxel_size}),
        fusion_({.voxel_size = belief.voxel_size, .truncation = belief.tsdf.truncation}),
        belief_(belief, std::span<const RobotKind>(&kind, 1), &fusion_.map()),
        agent_(id, 0, body, belief_, agent),
        sync_(id, options.sync,
              {.voxel_size = belief.voxel_size, .truncation = belief.tsdf.truncation},
              std::move(packer)),
        relay_(id, options.incarnation, options.relay),
        guard_(id, {.team = options.team}),
        redundant_(RedundancyCheck{options.redundancy}) {
    belief_.add_known_free(0, {body.estimate().position, start_clearance});
    belief_.update();
    sync_.distance = [this](RobotId mate) {
      const auto last = relay_.last_of(mate, now_);
      return last ? (last->at.position - agent_.state(now_).at.position).norm() : 1e9;
    };
  }

 public:
  /// Hears what has come in, takes an image and maps it, checks its stop, and plans if that is due.
  /// Different agents at once.
  void look(double now, std::span<const Message<Packet>> inbox) {
    now_ = now;
    receive(inbox);
    agent_.sense();
    // Who is at rest sees nothing new, and patches without end would let nobody come to an end.
    const bool works = !agent_.at_rest();
    if (works) {
      recorder_.integrate(agent_.image(), belief_.space(0).kind.camera, agent_.camera_pose());
      fusion_.show_open(recorder_.open());
    }
    if (recorder_.due() || (!works && recorder_.images() > 0)) close_patch();
    belief_.update();
    agent_.check_stop();
    plan();
    agent_.set_out(now);
  }
  /// Gives way, moves, and says what there is to say. Different agents at once.
  std::vector<Message<Packet>> act(double now) {
    agent_.forget_traffic();
    for (const RobotState& mate : recent_) agent_.hear(as_traffic(mate));
    belief_.goals();
    agent_.move(now);
    relay_.set_own(agent_.state(now));
    std::vector<Message<Packet>> out;
    const auto tell = [&](const std::vector<Outgoing>& list) {
      for (const Outgoing& o : list)
        out.push_back({.time = now,
                       .from = id_,
                       .to = o.to,
                       .payload = seal({.kind = o.kind,
                                        .team = options_.team,
                                        .sender = id_,
                                        .incarnation = options_.incarnation,
                                        .number = said_++,
                                        .body = o.body})});
    };
    tell(relay_.speak(now));
    tell(sync_.speak(now));
    return out;
  }

  /// Whether it has nothing to do by its own map, and its open patch is told: what mates need to
  /// hear of it before they end.
  bool is_done() const {
    return agent_.at_rest() && planned_revision_ == belief_.known().grid().revision() &&
           (nothing_planned_ || vain_plans_ > belief_.options().looks.max_failures);
  }
  /// Whether all is over: it is done, and so is every mate of late, with the same patches.
  bool finished(double now) const {
    if (!is_done() || sync_.missing() > 0) return false;
    return std::all_of(recent_.begin(), recent_.end(), [&](const RobotState& mate) {
      const auto theirs = sync_.digest_of(mate.id, now);
      return mate.idle && theirs && *theirs == sync_.digest();
    });
  }

  RobotId id() const { return id_; }
  const Agent<Body>& agent() const { return agent_; }
  const SurfaceBelief& belief() const { return belief_; }
  const TsdfMap& map() const { return fusion_.map(); }
  const PatchSync<Packer>& patches() const { return sync_; }
  const TeamRelay& team() const { return relay_; }
  const MessageGuard& guard() const { return guard_; }
  std::size_t plans() const { return plans_; }
  std::size_t redundant_stops() const { return redundant_stops_; }  ///< Left to mates.
  double planning_time() const { return planning_time_; }           ///< Of the machine [s].
  const std::vector<std::pair<VoxelIndex, LeftReason>>& impossible() const { return impossible_; }

 private:
  void receive(std::span<const Message<Packet>> inbox) {
    for (const Message<Packet>& m : inbox) {
      const auto envelope = guard_.admit(m.from, *m.payload.bytes, now_);
      if (!envelope) continue;
      sync_.hear(*envelope, now_);
      relay_.hear(*envelope, now_);
    }
    for (const MapPatch& patch : sync_.take_arrived()) fusion_.add(patch);
    team_ = relay_.mates(now_);
    recent_.clear();
    for (RobotId mate = 0; mate < options_.relay.robots; ++mate)
      if (const auto last = relay_.last_of(mate, now_);
          last && last->age <= options_.memory_of_lost)
        recent_.push_back(*last);
  }
  void close_patch() {
    MapPatch patch = recorder_.close();
    if (patch.blocks.empty()) {
      fusion_.close_open(nullptr);
      return;
    }
    patch.id = sync_.publish(patch);
    fusion_.close_open(&patch);
  }
  void plan() {
    if (agent_.scanning()) return;
    const RobotState self = agent_.state(now_);
    if (redundant_(self, team_)) {
      ++redundant_stops_;
      agent_.give_up_to_others(now_);
    }
    if (!agent_.asks(now_) && !agent_.at_rest()) return;
    if (agent_.at_rest() && !agent_.asks(now_) &&
        planned_revision_ == belief_.known().grid().revision())
      return;
    std::vector<RobotState> team = team_;
    team.push_back(agent_.state(now_));
    std::sort(team.begin(), team.end(),
              [](const RobotState& a, const RobotState& b) { return a.id < b.id; });
    std::vector<RobotId> asked;
    for (const RobotState& r : team)
      if (r.id == id_ || r.idle) asked.push_back(r.id);
    if (std::exchange(departures_, agent_.departures()) != agent_.departures()) vain_plans_ = 0;
    if (agent_.at_rest()) ++vain_plans_;
    const SurfaceSituation situation{.belief = belief_,
                                     .goals = belief_.goals(),
                                     .asked = asked,
                                     .team = team,
                                     .time = now_,
                                     .seed = plans_};
    const auto before = std::chrono::steady_clock::now();
    Plan plan = ask(planner_, situation);
    planning_time_ +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    ++plans_;
    planned_revision_ = belief_.known().grid().revision();
    Stops& own = plan.routes[id_];
    nothing_planned_ = own.empty() && plan.nothing();
    impossible_ = std::move(plan.impossible);
    agent_.accept(std::move(own), plan.replan, now_);
  }
  /// A mate not heard of late is anywhere near its path, as far as it may have come.
  TrafficAgent as_traffic(const RobotState& mate) const {
    const RobotKind& kind = belief_.space(0).kind;
    TrafficAgent t;
    t.id = static_cast<int>(mate.id);
    t.priority = mate.first ? 1.0 : 0.0;
    t.position = mate.at.position;
    t.path = mate.ahead;
    t.radius = kind.body_radius + std::min(kMostSwollen, kind.limits.speed * mate.age);
    t.speed = kind.limits.speed;
    t.idle = mate.idle;
    t.cornered = mate.cornered;
    t.held = mate.held;
    return t;
  }

  static constexpr double kMostSwollen = 5.0;  ///< [m]

  RobotId id_;
  DistributedAgentOptions options_;
  Planner planner_;
  PatchRecorder<DropOffWeight<>> recorder_;
  PatchFusion fusion_;
  SurfaceBelief belief_;
  Agent<Body> agent_;
  PatchSync<Packer> sync_;
  TeamRelay relay_;
  MessageGuard guard_;
  RedundancyCheck redundant_;
  std::vector<RobotState> team_;    // heard of late enough to plan for
  std::vector<RobotState> recent_;  // and to keep clear of
  double now_ = 0.0;
  std::uint32_t said_ = 0;
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible_;
  std::uint64_t planned_revision_ = ~std::uint64_t{0};
  bool nothing_planned_ = false;
  int vain_plans_ = 0;
  std::size_t departures_ = 0, plans_ = 0, redundant_stops_ = 0;
  double planning_time_ = 0.0;
};
}  // namespace surfleet
