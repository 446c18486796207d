// SPDX-License-Identifier: MIT
/// @file
/// @brief What one robot does, alone or in any fleet: observe, check its stops, set out, give way,
/// move.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/fleet/agent_options.hpp>
#include <surfleet/fleet/as_traffic.hpp>
#include <surfleet/fleet/endurance.hpp>
#include <surfleet/fleet/note_views_in_vain.hpp>
#include <surfleet/fleet/open_work.hpp>
#include <surfleet/fleet/path_around.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/fleet/route_work.hpp>
#include <surfleet/fleet/silent_mates.hpp>
#include <surfleet/fleet/stall_watch.hpp>
#include <surfleet/fleet/watchful_view.hpp>
#include <surfleet/geometry/teammate_mask.hpp>
#include <surfleet/motion/low_level_planner.hpp>
#include <surfleet/motion/traffic_policy.hpp>
#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// Carries out the routes of one robot on what is believed [000 §2.5.3, 3.5.2, Alg. 1, 3].
///
/// A route is a list of stops; the first is under way. Which part owns the belief and calls the
/// planner is not the agent's affair: in a fleet with one map agents share it, and call in this
/// order, each for all of them: `sense`, `integrate`, `check_stop`, `accept` what is planned,
/// `set_out`, `announce` and `hear`, `move`.
template <RobotBody Body>
class Agent {
 public:
  /// Body and belief are referred to and must outlive the agent. Throws `Error` for a kind with a
  /// gimbal and a body without.
  Agent(RobotId id, RobotKindId kind, Body& body, SurfaceBelief& belief, AgentOptions options)
      : id_(id),
        kind_(kind),
        body_(&body),
        belief_(&belief),
        options_(options),
        home_(options.home.value_or(body.estimate())),
        traffic_(traffic_options(belief.space(kind).kind.limits, options.image_period)),
        endurance_(options.endurance, home_.position, this->kind().limits, apart(),
                   travelled_by(body)) {
    require(GimballedBody<Body> || !this->kind().has_gimbal(),
            "pitches of the robot's kind: expected 0 alone, as its body has no gimbal");
    endurance_.moved_to(body.estimate().position);
  }

  // -- sensing -----------------------------------------------------------------------------------
  /// Takes an image or a scan, less what shows teammates. Different agents at once.
  void sense() {
    reading_ = body_->sense();
    seen_ = body_->neighbours();
    for (const SeenRobot& mate : seen_)
      mask_teammates(reading_, kind().sensor(), sensor_pose(), std::span(&mate.position, 1),
                     kind().body_radius + belief_->voxel_size() + mate.error);
  }
  /// Puts the last image or scan into the belief, which is not updated yet.
  void integrate() { belief_->integrate(reading_, kind().sensor(), sensor_pose()); }
  const SensorReading& reading() const { return reading_; }  ///< The last that was taken.
  Pose sensor_pose() const { return kind().sensor_pose(body_->estimate()); }

  // -- what there is to say ----------------------------------------------------------------------
  RobotState state(double time) const {
    return {.id = id_,
            .kind = kind_,
            .at = body_->estimate(),
            .ahead = body_->remaining(),
            .route = route_,
            .idle = route_.empty(),
            .held = held_ && body_->standing(),
            .cornered = traffic_.cornered(time),
            .first = retired_.has_value()};  // a charge does not wait
  }
  /// Of its motion, for the others.
  TrafficAgent announce(double time) const {
    TrafficAgent t = as_traffic(state(time), kind());
    // One that brakes still moves, whatever it is about.
    if (!moving() && body_->standing()) t.path.clear();
    return t;
  }
  /// Whether it still turns for its first views all around.
  bool scanning() const { return phase_ == Phase::scanning; }
  /// Whether it neither moves nor observes nor has anything to do.
  bool at_rest() const {
    return phase_ == Phase::waiting && route_.empty() && body_->standing() &&
           (!retired_ || retired_ == StopReason::stranded || is_home());
  }
  /// Whether it has nothing to do, or so much of what its route was made for is complete, or left
  /// behind, that a new one is due (UtilityCheck).
  bool is_free() const { return !retired_ && (route_.empty() || is_spent()); }
  /// Whether it is time to ask for a plan on its behalf.
  bool asks(double time) const {
    return !retired_ && (route_.empty() ? time >= idle_until_ : is_spent());
  }
  /// Why it does no more, if so, and how far it had gone when it set out for home [m].
  std::optional<StopReason> stop_reason() const { return retired_; }
  double travelled_at_work() const { return retired_ ? worked_ : endurance_.travelled(); }
  std::size_t departures() const { return departures_; }  ///< How often it set out for a stop.
  std::size_t emergency_stops() const { return emergency_stops_; }
  std::size_t waits() const { return waits_; }  ///< For teammates.

  // -- stops -------------------------------------------------------------------------------------
  /// Leaves a stop when it has served, and a goal that is none any more; stops before obstacles.
  void check_stop() {
    if (!given_up_.empty()) belief_->not_reached(std::exchange(given_up_, {}));
    if (phase_ == Phase::observing) {
      const auto needed = images_needed(*belief_, body_->estimate().position, route_.front());
      if (++images_ >= std::min(needed, most_images())) leave_stop();
    }
    if (!moving()) return;
    if (phase_ == Phase::flying && is_pointless(route_.front())) {
      leave_goal();
    } else if (obstacle_ahead_(space().free, body_->remaining(), body_->stopping_distance())) {
      ++emergency_stops_;
      halt();
      if (replan_.as_printed) drop_route(0.0);
    }
  }

  /// Does no more than to go back to its start.
  void retire(StopReason reason) {
    if (retired_ && reason != StopReason::stranded) return;
    if (!retired_) worked_ = endurance_.travelled();
    retired_ = reason;
    route_.clear();
    replan_ = {};
    idle_until_ = 0.0;
    pause_ = kIdle;
    if (phase_ != Phase::scanning) halt();
  }

  // -- planning ----------------------------------------------------------------------------------
  /// Leaves what it was about to do to other robots, and asks for other work at once.
  void give_up_to_others(double time) {
    if (moving()) halt();
    drop_route(time);
  }
  /// Takes a new route in place of what it has. An empty one leaves it without work: it then asks
  /// less and less often, as a plan is one for all, and disturbs them.
  void accept(Stops route, const ReplanRule& rule, double time) {
    if (retired_) return;
    const bool same = !route.empty() && !route_.empty() && phase_ != Phase::waiting &&
                      nearly_equal(route.front().configuration, route_.front().configuration);
    route_ = std::move(route);
    work_ = RouteWork(route_, belief_->incomplete());
    replan_ = rule;
    if (!same) leave_goal();
    if (route_.empty())
      rest(time);
    else
      pause_ = kIdle;
  }
  /// Sets out for the next stop if it waits for that, or turns to it in flight.
  void set_out(double time) {
    endurance_.update(space().roadmap, heard_.size());
    if (!retired_ && endurance_.must_return(time, space().roadmap)) retire(StopReason::endurance);
    if (phase_ != Phase::waiting) return;
    if (retired_ && route_.empty() && !at_rest() && time >= idle_until_) route_ = {{home_, {}}};
    if (!body_->standing()) {
      if (!turns(time)) body_->stop();
    } else if (!route_.empty()) {
      depart(time);
    }
  }

  // -- motion ------------------------------------------------------------------------------------
  /// What a teammate has told. Call `announce` and pass it on, all before any robot moves.
  void hear(const TrafficAgent& mate) { heard_[mate.id] = mate; }
  /// Forgets what teammates have told of their motion.
  void forget_traffic() { heard_.clear(); }
  /// Moves on by an image period, with regard to what the others have told. Different agents at
  /// once, if the belief's goals were asked for before.
  void move(double time) {
    if (!(heard_.empty() && seen_.empty()) && phase_ != Phase::scanning) give_way(time);
    if (phase_ == Phase::scanning && (quarters_ == 0 || body_->finished())) {
      const std::vector<double>& pitches = kind().pitches;
      if (quarters_ == 4 * pitches.size() || kind().sees_all_around()) {
        phase_ = Phase::waiting;
      } else {
        const Configuration at = body_->estimate();
        tilt(pitches[quarters_++ / 4]);
        body_->follow(std::span<const Point3>(&at.position, 1), at.yaw + 0.5 * kPi, std::nullopt);
      }
    }
    if (phase_ == Phase::flying && watches()) {
      const Configuration view = view_under_way(*belief_, space(), body_->estimate().position,
                                                polyline_length(body_->remaining()),
                                                route_.front().configuration, replan_.watch_on);
      body_->watch(view.yaw);
      tilt(view.pitch);
    }
    if (!held_) held_until_ = time + kLongestHold;
    if (phase_ == Phase::flying && time > held_until_) give_up_route();
    body_->advance(options_.image_period);
    endurance_.moved_to(body_->estimate().position);
    watch_for_stalls(time);
    if (phase_ == Phase::flying && has_arrived()) phase_ = Phase::observing;
  }

 private:
  enum class Phase : std::uint8_t { scanning, waiting, flying, observing, aside };

  const KindSpace& space() const { return belief_->space(kind_); }
  const RobotKind& kind() const { return space().kind; }
  void tilt(double pitch) {
    if constexpr (GimballedBody<Body>) body_->tilt(pitch);
  }
  bool has_arrived() const {
    const double pitch = GimballedBody<Body> ? route_.front().configuration.pitch : 0.0;
    return body_->finished() && std::abs(body_->estimate().pitch - pitch) < kSamePitch;
  }
  /// Whether it turns to what there is to see in flight.
  bool watches() const { return !replan_.as_printed && !kind().sees_all_around(); }
  bool moving() const { return phase_ == Phase::flying || phase_ == Phase::aside; }

  bool is_pointless(const Stop& stop) const {
    return !replan_.as_printed && surfleet::is_pointless(*belief_, stop);
  }
  bool is_spent() const {
    const double share = replan_.utility_share.value_or(options_.utility_share);
    if (!replan_.as_printed)
      return work_.is_complete_or_behind(share, belief_->incomplete(), route_);
    return phase_ == Phase::waiting && work_.is_complete(share, belief_->incomplete());
  }
  /// Images that a stop may take at the most.
  std::size_t most_images() const {
    return static_cast<std::size_t>(
        std::max(1.0, std::ceil(options_.max_dwell / options_.image_period)));
  }
  void leave_stop() {
    Configuration at = body_->estimate();
    if (kind().sees_all_around()) at.yaw = route_.front().configuration.yaw;
    note_views_in_vain(*belief_, space(), at, route_.front(), images_, most_images());
    route_.erase(route_.begin());
    stalls_.arrives();
    phase_ = Phase::waiting;
  }
  /// And asks for another from `time` on.
  void drop_route(double time) {
    route_.clear();
    idle_until_ = time;
  }
  void halt() {
    body_->stop();
    phase_ = Phase::waiting;
    held_ = false;
  }
  /// As `halt`, but a robot that may turn in flight goes on until `set_out` has asked where to.
  void leave_goal() {
    if (!replan_.turn_in_flight || held_ || phase_ != Phase::flying) return halt();
    phase_ = Phase::waiting;
  }
  void rest(double time) {
    idle_until_ = time + pause_;
    pause_ = std::min(2.0 * pause_, kLongestIdle);
  }

  /// Sets off for the first stop that can be reached; the others are noted and dropped.
  void depart(double time) {
    bool too_far = false;
    while (!route_.empty()) {
      const Stop& stop = route_.front();
      if (is_pointless(stop)) {
        route_.erase(route_.begin());
        continue;
      }
      if (const auto path = retired_ ? path_home(time) : path_to(stop.configuration.position)) {
        if (affords(*path, time)) return set_off(*path);
        too_far = true;
      } else {
        belief_->not_reached(stop.targets);
        if (retired_ && ++vain_returns_ >= kMostVainReturns) retired_ = StopReason::stranded;
      }
      route_.erase(route_.begin());
    }
    if (too_far)
      retire(StopReason::endurance);
    else
      rest(time);
  }
  std::optional<Path> path_to(const Point3& goal) const {
    return space().roadmap.query(body_->estimate().position, goal);
  }
  /// Idle mates give way to robots with work; among those that go home none would.
  std::optional<Path> path_home(double time) const {
    std::vector<Point3> standing;
    for (const auto& [id, mate] : heard_)
      if (polyline_length(mate.path) < kStanding) standing.push_back(mate.position);
    const Point3 here = body_->estimate().position;
    return endurance_.path_home(path_around(space(), here, home_.position, standing, apart()),
                                space().free, time);
  }
  /// Between those that pass each other [m].
  double apart() const { return 2.0 * kind().body_radius + traffic_.options.standing_gap(); }
  bool is_home() const { return (body_->estimate().position - home_.position).norm() < kHome; }
  double distance_home(const Point3& from) const {
    const auto path = space().roadmap.query(from, home_.position);
    return path ? path->length : std::numeric_limits<double>::infinity();
  }
  bool affords(const Path& path, double time) const {
    return retired_ || !endurance_.limited() ||
           endurance_.affords(path.length + distance_home(path.points.back()), time);
  }
  /// Whether the robot, under way to a goal that is none any more, could turn to its next stop.
  bool turns(double time) {
    if (body_->braking()) return false;
    while (!route_.empty() && is_pointless(route_.front())) route_.erase(route_.begin());
    if (route_.empty()) return false;
    const auto path = path_to(route_.front().configuration.position);
    if (!path || retired_ || !affords(*path, time)) return false;
    // A robot that has to turn back is sooner there if it brakes first.
    if (path->points.size() > 1 && body_->velocity().dot(path->points[1] - path->points[0]) < 0.0)
      return false;
    // The turn leads off the path as far as the robot needs to come round.
    const std::vector<Point3> onto = body_->path_onto(path->points);
    for (std::size_t i = 1; i < std::min<std::size_t>(onto.size(), 3); ++i)
      if (!space().free.is_free_segment(onto[i - 1], onto[i])) return false;
    set_off(*path);
    return true;
  }
  void set_off(const Path& path) {
    const Configuration& goal = route_.front().configuration;
    const double yaw = kind().sees_all_around() ? body_->estimate().yaw : goal.yaw;
    body_->follow(path.points, yaw, watches() ? std::optional(yaw) : std::nullopt);
    tilt(goal.pitch);
    phase_ = Phase::flying;
    images_ = 0;
    ++departures_;
  }

  /// A body that does not move leaves its work to others, and at last does no more.
  void watch_for_stalls(double time) {
    if (held_ || (!moving() && phase_ != Phase::scanning)) return stalls_.rests();
    if (!stalls_.moves(body_->estimate(), polyline_length(body_->remaining()) < kStanding, time))
      return;
    give_up_to_others(time);
    halt();
    if (stalls_.stranded()) retire(StopReason::stranded);
  }
  /// Where robots block each other for good, one does something else.
  void give_up_route() {
    const std::vector<VoxelIndex>& targets = route_.front().targets;
    given_up_.insert(given_up_.end(), targets.begin(), targets.end());
    route_.clear();
    halt();
  }
  /// TrafficPolicy [000 Alg. 3]: stop and wait, or step aside, or go on.
  void give_way(double time) {
    const TrafficAgent self = announce(time);
    std::vector<TrafficAgent> traffic{self};
    for (const auto& [id, mate] : heard_) traffic.push_back(mate);
    add_silent_mates(seen_, heard_, self, traffic_.options, traffic);
    const auto free = [&](const Point3& p, const Point3& q) {
      return space().free.is_free_segment(p, q) &&
             endurance_.affords_aside((q - p).norm(), time, retired_.has_value());
    };
    const Maneuver m = traffic_(self, traffic, free, time);
    switch (m.kind) {
      case Maneuver::Kind::none:
        if (held_) body_->resume();
        held_ = false;
        if (phase_ == Phase::aside && body_->finished()) phase_ = Phase::waiting;
        break;
      case Maneuver::Kind::stop:
        if (!moving()) break;
        if (!held_) ++waits_;
        body_->stop();
        held_ = true;
        break;
      case Maneuver::Kind::step_aside:
        if (phase_ == Phase::aside && !body_->finished() &&
            (m.target - aside_).norm() < kind().body_radius) {
          // The place is still good; the path there must be, too.
          const bool hold = traffic_.too_close(self, traffic) >= 0;
          if (hold && !held_) body_->stop();
          if (!hold && held_) body_->resume();
          held_ = hold;
        } else if (!body_->standing()) {
          const bool was_moving = moving();
          body_->stop();
          held_ = was_moving;
        } else {
          const Configuration at = body_->estimate();
          const std::array<Point3, 2> path{at.position, m.target};
          body_->follow(path, at.yaw, std::nullopt);
          aside_ = m.target;
          phase_ = Phase::aside;
          held_ = false;
          ++waits_;
        }
        break;
    }
  }
  static constexpr double kHome = 0.05;       ///< So near to its start it is there [m].
  static constexpr double kStanding = 0.1;    ///< Path of a mate that as good as stands [m].
  static constexpr double kSamePitch = 1e-3;  ///< [rad]
  static constexpr int kMostVainReturns = 8;
  static constexpr double kIdle = 2.0;  ///< Between requests of a robot without work [s] …
  static constexpr double kLongestIdle = 30.0;  ///< … when nothing was found time after time.
  static constexpr double kLongestHold = 60.0;  ///< For teammates before a route is given up [s].

  RobotId id_;
  RobotKindId kind_;
  Body* body_;
  SurfaceBelief* belief_;
  AgentOptions options_;
  Configuration home_;
  TrafficPolicy traffic_;
  StallWatch stalls_;
  Endurance endurance_;
  std::optional<StopReason> retired_;
  int vain_returns_ = 0;
  double worked_ = 0.0;  // travelled until then [m]
  ObstacleCheck obstacle_ahead_{.lookahead = 1.5};
  SensorReading reading_;
  Phase phase_ = Phase::scanning;
  Stops route_;               // what is left to do; the first stop is under way
  RouteWork work_;            // what the route was made for
  ReplanRule replan_;         // of the plan that the route is from
  std::size_t quarters_ = 0;  // of the first turn all around, one at each pitch
  double idle_until_ = 0.0;   // no new request before [s]
  double pause_ = kIdle;      // until the next request if this one gives nothing [s]
  std::size_t images_ = 0;    // taken at this stop
  bool held_ = false;         // stopped for a teammate on a path that will be gone on with
  double held_until_ = 0.0;   // if still held then, the route is given up [s]
  Point3 aside_ = Point3::Zero();
  std::map<int, TrafficAgent> heard_;  // the last of every teammate
  std::vector<SeenRobot> seen_;        // with the last image
  std::vector<VoxelIndex> given_up_;   // not in the belief yet, which others read
  std::size_t departures_ = 0, emergency_stops_ = 0, waits_ = 0;
};
}  // namespace surfleet
