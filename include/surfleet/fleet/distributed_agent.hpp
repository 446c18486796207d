// SPDX-License-Identifier: MIT
/// @file
/// @brief One robot of a distributed fleet: a map, a planner and a voice of its own [000 ch. 4].
///     agent.observe(now, inbox);            // receive, sense, map, check stops, plan
///     for (auto& m : agent.act(now)) …      // give way, move, and what there is to tell
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/as_traffic.hpp>
#include <surfleet/fleet/coverage_goal.hpp>
#include <surfleet/fleet/distributed_options.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/plan_requests.hpp>
#include <surfleet/fleet/redundancy.hpp>
#include <surfleet/fleet/team_relay.hpp>
#include <surfleet/mapping/patch_fusion.hpp>
#include <surfleet/mapping/patch_limits.hpp>
#include <surfleet/mapping/patch_recorder.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// The agent of one robot with its own belief, made of its own and others' patches. It plans for
/// itself and for mates without work, and takes its own route of that plan (dist-TSGA [000 Alg. 5],
/// or any other planner by the same rule); mates under way keep the routes they told. Alone, for as
/// long as no mate is heard, it is the single architecture.
template <RobotBody Body, FleetPlanner Planner = AnyPlanner, BytePacker Packer = AnyPacker>
class DistributedAgent {
 public:
  /// The body must outlive it. What is within `start_clearance` of its home is taken for free [m],
  /// as is the place that the body fills. Throws `Error` on options out of range.
  DistributedAgent(RobotId id, const RobotKind& kind, Body& body, SurfaceBeliefOptions belief,
                   AgentOptions agent, double start_clearance, Planner planner,
                   DistributedAgentOptions options = {}, Packer packer = {})
      : DistributedAgent(Checked{SurfaceBelief::checked(belief_for(planner, std::move(belief)))},
                         id, kind, body, agent, start_clearance, std::move(planner), options,
                         std::move(packer)) {}
  DistributedAgent(const DistributedAgent&) = delete;
  DistributedAgent& operator=(const DistributedAgent&) = delete;

 private:
  struct Checked {
    SurfaceBeliefOptions belief;
  };
  DistributedAgent(const Checked& checked, RobotId id, const RobotKind& kind, Body& body,
                   AgentOptions agent, double start_clearance, Planner&& planner,
                   const DistributedAgentOptions& options, Packer packer)
      : id_(id),
        kind_(kind_number(kind)),
        options_(options),
        limits_(options.patches.value_or(limits_of(checked.belief, kind, options.relay.slack))),
        requests_(std::move(planner)),
        recorder_({.robot = id,
                   .incarnation = options.incarnation,
                   .voxel_size = checked.belief.voxel_size,
                   .images = options.patch_images,
                   .distance = std::min(options.patch_distance.value_or(0.25 * limits_.reach),
                                        0.25 * limits_.reach),
                   .blocks = limits_.blocks / 2},
                  *checked.belief.integrator),
        fusion_({.voxel_size = checked.belief.voxel_size,
                 .truncation = checked.belief.tsdf.truncation}),
        belief_(checked.belief, std::span<const RobotKind>(&kind, 1), &fusion_.map()),
        agent_(id, 0, body, belief_, agent),
        sync_(id, own_sync(options), limits_, std::move(packer)),
        relay_(id, options.incarnation, of_the_team(options.relay)),
        guard_(id, {.team = options.team, .robots = options.relay.robots}),
        redundant_(RedundancyCheck{options.redundancy}),
        goal_(options.coverage_goal) {
    requests_.least_gain = options.least_gain;
    belief_.add_known_free(0, {agent.home.value_or(body.estimate()).position, start_clearance});
    belief_.add_known_free(0, {body.estimate().position, kind.inscribed_radius()});
    belief_.update();
    sync_.distance = [this, &body](RobotId mate) {
      const auto last = relay_.last_of(mate, now_);
      return last ? (last->at.position - body.estimate().position).norm() : 1e9;
    };
  }

 public:
  /// Hears what has come in, takes an image and maps it, checks its stop, and plans if that is due.
  /// Different agents at once.
  void observe(double now, std::span<const Message<Packet>> inbox) {
    now_ = now;
    receive(inbox);
    agent_.sense();
    // A robot at rest sees nothing new, and patches without end would let no mission end.
    const bool works = !agent_.at_rest() && !leaving_;
    if (works) {
      recorder_.integrate(agent_.reading(), belief_.space(0).kind.sensor(), agent_.sensor_pose());
      fusion_.show_open(recorder_.open());
    }
    if (recorder_.due() || (!works && has_untold())) close_patch();
    belief_.update();
    agent_.check_stop();
    plan();
    if (!agent_.stop_reason() && goal_.is_reached(belief_, now))
      agent_.retire(StopReason::coverage_goal);
    if (options_.returns_home && !leaving_ && is_agreed()) {
      leaving_ = true;
      agent_.retire(requests_.left_out() ? StopReason::enough : StopReason::complete);
    }
    agent_.set_out(now);
  }
  /// Gives way, moves, and says what there is to say. Different agents at once.
  std::vector<Message<Packet>> act(double now) {
    agent_.forget_traffic();
    for (const RobotState& mate : recent_) agent_.hear(as_traffic(mate, belief_.space(0).kind));
    belief_.goals();
    agent_.move(now);
    RobotState own = agent_.state(now);
    own.done = leaving_ || (is_done() && !has_untold());
    if (own.done) own.holds = sync_.digest();
    relay_.set_own(std::move(own));
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

  /// Whether it has nothing to do by its own map, or does no more.
  bool is_done() const {
    return agent_.at_rest() && (agent_.stop_reason() || requests_.exhausted(belief_));
  }
  /// Whether all is over: it is done, and so is every mate of late, with the same patches; and it
  /// is home, if it is to end there.
  bool finished() const { return options_.returns_home ? leaving_ && is_done() : is_agreed(); }

  RobotId id() const { return id_; }
  const Agent<Body>& agent() const { return agent_; }
  const SurfaceBelief& belief() const { return belief_; }
  const TsdfMap& map() const { return fusion_.map(); }
  const PatchSync<Packer>& patches() const { return sync_; }
  const TeamRelay& team() const { return relay_; }
  const PlanRequests<Planner>& plans() const { return requests_; }
  /// What of its mail it has not read or not believed, by reason.
  MessageDrops drops() const {
    MessageDrops all = guard_.drops();
    all += sync_.drops();
    all += relay_.drops();
    return all;
  }
  std::size_t redundant_stops() const { return redundant_stops_; }  ///< Left to mates.

 private:
  /// Where robots of the team, of which all have the same bounds, may be; empty: anywhere.
  static Box3 places_of_robots(const RobotKind& kind, const Box3& region) {
    return kind.bounds.isEmpty() ? Box3() : kind.bounds.merged(region);
  }
  /// What news may say of mates, whose plans are made with this robot's belief.
  TeamRelayOptions of_the_team(TeamRelayOptions o) const {
    o.kinds = static_cast<RobotKindId>(belief_.kinds());
    if (o.bounds.isEmpty()) o.bounds = places_of_robots(belief_.space(0).kind, belief_.region());
    return o;
  }
  static PatchSyncOptions own_sync(const DistributedAgentOptions& options) {
    PatchSyncOptions o = options.sync;
    o.incarnation = options.incarnation;
    return o;
  }
  void receive(std::span<const Message<Packet>> inbox) {
    for (const Message<Packet>& m : inbox) {
      const auto envelope = guard_.admit(m.from, *m.payload.bytes, now_);
      if (!envelope) continue;
      sync_.hear(*envelope, now_);
      relay_.hear(*envelope, now_);
    }
    for (const MapPatch& patch : sync_.take_arrived())
      if (fusion_.add(patch) && patch.notes.kind == kind_) belief_.add_notes(patch.notes);
    team_ = relay_.mates(now_);
    recent_ = relay_.mates(now_, options_.memory_of_lost);
  }
  void close_patch() {
    ViewNotes notes = belief_.take_notes();
    notes.kind = kind_;
    std::vector<MapPatch> parts = recorder_.close(std::move(notes), limits_);
    if (parts.front().blocks.empty() && parts.front().notes.empty()) parts.clear();
    for (MapPatch& part : parts) part.id = sync_.publish(part);
    fusion_.close_open(parts);
  }
  /// By what this robot's own sensor and integrator give; robots may be `slack` away from where
  /// they may be [m].
  static PatchLimits limits_of(const SurfaceBeliefOptions& belief, const RobotKind& kind,
                               double slack) {
    constexpr double kNear = 0.01;  // [m]
    PatchLimits limits = patch_limits(kind.sensor(), belief.voxel_size, belief.tsdf.truncation);
    limits.image_weight = std::max(limits.image_weight, belief.integrator->weight(0.0, kNear));
    const Box3 places = places_of_robots(kind, belief.region);
    if (!places.isEmpty())
      limits.places =
          Box3(places.min() - Point3::Constant(slack), places.max() + Point3::Constant(slack));
    return limits;
  }
  bool is_agreed() const {
    if (!is_done() || sync_.missing() > 0) return false;
    if (recent_.empty()) return true;
    if (has_untold()) return false;
    return std::all_of(recent_.begin(), recent_.end(), [&](const RobotState& mate) {
      return mate.done && mate.holds == sync_.digest() && relay_.is_current(mate);
    });
  }
  /// Whether it has seen, or viewed in vain, what is in no patch yet.
  bool has_untold() const { return recorder_.images() > 0 || belief_.ledger().has_news(); }
  void plan() {
    if (agent_.scanning() || agent_.stop_reason()) return;
    if (redundant_(agent_.state(now_), team_)) {
      ++redundant_stops_;
      agent_.give_up_to_others(now_);
    }
    const bool at_rest = agent_.at_rest();
    if (!agent_.asks(now_) && !requests_.is_due(belief_) && !(at_rest && finds_news())) return;
    std::vector<RobotState> team = team_;
    team.push_back(agent_.state(now_));
    std::sort(team.begin(), team.end(),
              [](const RobotState& a, const RobotState& b) { return a.id < b.id; });
    std::vector<RobotId> asked;
    for (const RobotState& r : team)
      if (r.id == id_ || (r.idle && !r.first)) asked.push_back(r.id);
    Plan plan = requests_(belief_, asked, team, agent_.departures(), at_rest, now_);
    agent_.accept(std::move(plan.routes[id_]), plan.replan, now_);
    planned_ = now_;
  }
  /// Whether a robot at rest should ask again, as mates have told of more: some time after it last
  /// did while they work, and at once when none does, as all may have come to the end.
  bool finds_news() const {
    if (requests_.up_to_date(belief_)) return false;
    return now_ >= planned_ + kNextQuestion ||
           std::all_of(team_.begin(), team_.end(),
                       [](const RobotState& mate) { return mate.idle; });
  }

  static constexpr double kNextQuestion = 2.0;  ///< Of a robot at rest whose mates work [s].

  RobotId id_;
  std::uint32_t kind_;  // as of `kind_number`
  DistributedAgentOptions options_;
  PatchLimits limits_;
  PlanRequests<Planner> requests_;
  PatchRecorder recorder_;
  PatchFusion fusion_;
  SurfaceBelief belief_;
  Agent<Body> agent_;
  PatchSync<Packer> sync_;
  TeamRelay relay_;
  MessageGuard guard_;
  RedundancyCheck redundant_;
  CoverageGoal goal_;
  std::vector<RobotState> team_;    // heard of late enough to plan for
  std::vector<RobotState> recent_;  // and to keep clear of
  double now_ = 0.0;
  std::uint32_t said_ = 0;
  std::size_t redundant_stops_ = 0;
  double planned_ = 0.0;  // when it last asked [s]
  bool leaving_ = false;  // as all have agreed that nothing is left
};
}  // namespace surfleet
