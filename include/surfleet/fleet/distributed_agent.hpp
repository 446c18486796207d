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
#include <surfleet/fleet/distributed_options.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/plan_requests.hpp>
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
        requests_(std::move(planner)),
        recorder_({.robot = id,
                   .incarnation = options.incarnation,
                   .voxel_size = checked.belief.voxel_size,
                   .images = options.patch_images},
                  *checked.belief.integrator),
        fusion_({.voxel_size = checked.belief.voxel_size,
                 .truncation = checked.belief.tsdf.truncation}),
        belief_(checked.belief, std::span<const RobotKind>(&kind, 1), &fusion_.map()),
        agent_(id, 0, body, belief_, agent),
        sync_(
            id, options.sync,
            {.voxel_size = checked.belief.voxel_size, .truncation = checked.belief.tsdf.truncation},
            std::move(packer)),
        relay_(id, options.incarnation, options.relay),
        guard_(id, {.team = options.team}),
        redundant_(RedundancyCheck{options.redundancy}) {
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
    if (goal_is_reached()) agent_.retire(StopReason::coverage_goal);
    if (options_.returns_home && !leaving_ && is_agreed()) {
      leaving_ = true;
      agent_.retire(requests_.left_out() ? StopReason::enough : StopReason::complete);
    }
    agent_.set_out(now);
  }
  /// Gives way, moves, and says what there is to say. Different agents at once.
  std::vector<Message<Packet>> act(double now) {
    agent_.forget_traffic();
    for (const RobotState& mate : recent_) agent_.hear(swollen(mate));
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
  const MessageGuard& guard() const { return guard_; }
  const PlanRequests<Planner>& plans() const { return requests_; }
  std::size_t redundant_stops() const { return redundant_stops_; }  ///< Left to mates.

 private:
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
    MapPatch patch = recorder_.close();
    patch.notes = belief_.take_notes();
    patch.notes.kind = kind_;
    if (patch.blocks.empty() && patch.notes.empty()) {
      fusion_.close_open(nullptr);
      return;
    }
    patch.id = sync_.publish(patch);
    fusion_.close_open(&patch);
  }
  bool is_agreed() const {
    if (!is_done() || sync_.missing() > 0) return false;
    if (recent_.empty()) return true;
    if (has_untold()) return false;
    return std::all_of(recent_.begin(), recent_.end(), [&](const RobotState& mate) {
      return mate.done && mate.holds == sync_.digest() && relay_.is_current(mate);
    });
  }
  /// Asked seldom, and ever more seldom, as it costs as much as the map is large.
  bool goal_is_reached() {
    if (!options_.coverage_goal || agent_.stop_reason() || now_ < next_estimate_) return false;
    next_estimate_ = std::max(kEstimates * now_, now_ + kFirstEstimate);
    return belief_.estimate_coverage().share() >= *options_.coverage_goal;
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
  /// A mate not heard of late is anywhere near its path, as far as it may have come.
  TrafficAgent swollen(const RobotState& mate) const {
    TrafficAgent t = as_traffic(mate, belief_.space(0).kind);
    t.radius += std::min(kMostSwollen, t.speed * mate.age);
    return t;
  }

  static constexpr double kMostSwollen = 5.0;                      ///< [m]
  static constexpr double kFirstEstimate = 1.0, kEstimates = 1.1;  ///< [s], and a factor
  static constexpr double kNextQuestion = 2.0;  ///< Of a robot at rest whose mates work [s].

  RobotId id_;
  std::uint32_t kind_;  // as of `kind_number`
  DistributedAgentOptions options_;
  PlanRequests<Planner> requests_;
  PatchRecorder recorder_;
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
  std::size_t redundant_stops_ = 0;
  double next_estimate_ = 0.0;  // [s]
  double planned_ = 0.0;        // when it last asked [s]
  bool leaving_ = false;        // as all have agreed that nothing is left
};
}  // namespace surfleet
