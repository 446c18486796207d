// SPDX-License-Identifier: MIT
/// @file
/// @brief A fleet reconstructs what it does not know: the loop from depth image to motion and back,
/// on one map for all robots [000 ch. 2, 3].
///
///     Mission<TsgaPlanner, DroneWorld<EmbreeRayCaster>> mission(options, world, starts);
///     const MissionResult result = mission.run();
///     write_ply(extract_mesh(mission.map()), "reconstruction.ply");
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/fleet/plan.hpp>
#include <surfleet/geometry/teammate_mask.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/motion/low_level_planner.hpp>
#include <surfleet/motion/traffic_policy.hpp>
#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/look_ledger.hpp>
#include <surfleet/viewpoint/revealing_look.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/visibility.hpp>

namespace surfleet {
/// Where the robots really are: a simulator, or the robots themselves.
///
/// `capture(robot, shot, fleet)` is the depth image that robot takes as its shot-th, with all
/// robots at the given configurations. It is asked for different robots at once, and must give the
/// same image for the same arguments.
template <typename W>
concept WorldModel = requires(W& world, std::size_t robot, std::uint64_t shot,
                              std::span<const Configuration> fleet) {
  { world.capture(robot, shot, fleet) } -> std::same_as<DepthImage>;
};

struct MissionOptions {
  PinholeCamera camera;
  Pose T_body_camera = forward_camera_mount();
  double voxel_size = 0.3;       ///< [m]
  double known_weight = 0.3;     ///< W_th: a voxel of at least this weight is known.
  double observed_share = 0.15;  ///< Share of W_th from which a voxel serves flight and sight.
  TsdfOptions tsdf;              ///< A truncation of 0 stands for three voxels.
  double body_radius = 1.0;      ///< [m]
  double margin = 0.0;           ///< Kept beyond the body [m]; 0 stands for one voxel.
  double unknown_margin = 0.0;   ///< The same from what is unknown [m]; 0 stands for `margin`.
  double start_clearance = 2.5;  ///< What is known to be free around every start [m].
  AerialLimits limits;
  double image_period = 0.25;  ///< Between a robot's images, and the step of the clock [s].
  double utility_share = 0.2;  ///< Share of a route's elements whose completion asks for a new
                               ///< plan, unless the planner says another: 1 - c_thres, as
                               ///< `UtilityCheck` reads it.
  LookLedgerOptions looks;     ///< When an element is given up.
  double max_dwell = 10.0;     ///< Longest stay at a stop [s].
  bool watchful = true;        ///< On the way, turn to what there is to see.
  Box3 region;                 ///< Where surface is to be reconstructed [m].
  Box3 bounds;                 ///< Where the robots may fly [m].
  KeepOut keep_out;            ///< Where in there their bodies may not be.
  double max_time = 7200.0;    ///< The mission ends at this time at the latest [s].
  int threads = 1;
  std::uint64_t seed = 1;
};

/// How images come into a mission's map. Behind a surface an image soon knows nothing: beams have
/// another side.
inline TsdfIntegrator<DropOffWeight<>> mission_integrator(const MissionOptions& o) {
  return TsdfIntegrator<DropOffWeight<>>(o.tsdf,
                                         {.full = o.voxel_size, .zero = 1.5 * o.voxel_size});
}

/// A row of the mission's history.
struct MissionProgress {
  double time = 0.0;         ///< [s]
  double path_length = 0.0;  ///< Of all robots [m].
  std::size_t incomplete = 0;
  std::size_t known_blocks = 0;
  /// The mission's own account of how complete its mesh is (`estimate_coverage`), as of the last
  /// time it was taken: ever more seldom, as the map grows.
  double estimated_coverage = 0.0;
};

struct TimedConfiguration {
  double time = 0.0;  ///< [s]
  Configuration configuration;
};

struct MissionResult {
  bool complete = false;         ///< False if ended by time or from outside.
  double completion_time = 0.0;  ///< On the mission's clock [s].
  double planning_time = 0.0;    ///< Of the machine, in the high-level planner [s].
  std::vector<std::vector<TimedConfiguration>> trajectories;  ///< One a robot.
  std::vector<double> path_length;                            ///< One a robot [m].
  std::size_t remaining = 0;                                  ///< Incomplete elements at the end.
  CoverageEstimate coverage;                                  ///< By its own account, at the end.
  std::map<LeftReason, std::size_t> reasons;                  ///< Of all that remain.
  std::vector<MissionProgress> history;                       ///< About once in ten seconds.
  std::size_t images = 0, plans = 0, emergency_stops = 0, waits = 0;

  double total_path_length() const {
    double sum = 0.0;
    for (const double l : path_length) sum += l;
    return sum;
  }
};

/// One fleet, one map, one planner: the centralised architecture; with one robot, the single one.
///
/// An event loop on a simulated clock. In every step the robots move, look, and the map, the
/// incomplete surface, the free space and the roadmap follow the change; then stops are
/// checked off, obstacles and traffic are watched, and robots without a route are planned for. The
/// same options, world and planner give the same result on any number of threads.
template <FleetPlanner Planner, WorldModel World>
class Mission {
 public:
  Planner planner;
  /// Called about once a simulated second; false ends the mission.
  std::function<bool(const MissionProgress&)> on_progress;

  /// Throws `Error` on options out of range, no robots, no planner, or starts outside the bounds.
  Mission(MissionOptions options, World& world, std::span<const Configuration> starts,
          Planner p = {})
      : planner(std::move(p)),
        options_(checked(std::move(options), starts)),
        world_(&world),
        map_({.voxel_size = options_.voxel_size}),
        integrate_(mission_integrator(options_)),
        known_(map_, {.known_weight = options_.known_weight}),
        observed_(map_, {.known_weight = options_.known_weight * options_.observed_share}),
        flyable_(map_, {.known_weight = options_.known_weight * options_.observed_share,
                        .occupied_below = 0.5 * options_.voxel_size}),
        incomplete_({.known_weight = options_.known_weight, .region = options_.region}),
        free_(flyable_, {.radius = options_.body_radius,
                         .bounds = options_.bounds,
                         .margin = options_.margin,
                         .unknown_margin = options_.unknown_margin,
                         .keep_out = options_.keep_out}),
        roadmap_(free_, {.seed = options_.seed}),
        headings_(options_.camera, options_.T_body_camera),
        frustum_(options_.camera, options_.T_body_camera),
        ledger_(options_.looks) {
    if constexpr (std::is_same_v<Planner, AnyPlanner>)
      require(planner != nullptr, "planner: expected one, not an empty function");
    for (const Configuration& start : starts) {
      free_.add_known_free({start.position, options_.start_clearance});
      agents_.emplace_back(AerialMotion(start, options_.limits), TrafficPolicy(traffic_options()));
      fleet_.push_back(start);
    }
    free_.update();
    result_.trajectories.resize(agents_.size());
    result_.path_length.assign(agents_.size(), 0.0);
  }
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;

  const TsdfMap& map() const { return map_; }
  /// The map, when the mission is over; nothing else of the mission may be used after.
  TsdfMap take_map() { return std::move(map_); }
  const MissionOptions& options() const { return options_; }

  /// Runs to the end. Once only.
  MissionResult run() {
    record();
    double next_report = 0.0;
    while (time_ < options_.max_time) {
      look();
      check_stops();
      plan();
      if (finished()) {
        result_.complete = true;
        break;
      }
      move();
      time_ = static_cast<double>(++step_) * options_.image_period;
      record();
      if (time_ >= next_report) {
        next_report += 1.0;
        if (time_ >= next_estimate_) {
          estimate_ = estimate().share();
          next_estimate_ = std::max(kEstimates * time_, time_ + kFirstEstimate);
        }
        const MissionProgress progress = current();
        if (result_.history.empty() || time_ >= result_.history.back().time + 10.0)
          result_.history.push_back(progress);
        if (on_progress && !on_progress(progress)) break;
      }
    }
    result_.coverage = estimate();
    estimate_ = result_.coverage.share();
    result_.history.push_back(current());
    result_.completion_time = time_;
    account_for_rest();
    return std::move(result_);
  }

 private:
  enum class Phase : std::uint8_t { scanning, waiting, flying, looking, aside };
  struct Agent {
    Agent(AerialMotion m, TrafficPolicy t) : motion(std::move(m)), traffic(std::move(t)) {}
    AerialMotion motion;
    Phase phase = Phase::scanning;
    Stops route;                   ///< What is left to do; the first stop is under way.
    std::size_t initial_work = 0;  ///< Elements the route was made for, for the utility check.
    ReplanRule replan;             ///< Of the plan that the route is from.
    int quarters = 0;              ///< Of the first look around.
    double idle_until = 0.0;       ///< No new request before [s].
    double pause = kIdle;          ///< Until the next request if this one gives nothing [s].
    std::size_t images = 0;        ///< Taken at this stop.
    double watch_yaw = 0.0;        ///< Where to look on the way [rad].
    TrafficPolicy traffic;
    bool held = false;        ///< Stopped for a teammate on a path that will be gone on with.
    double held_until = 0.0;  ///< If still held then, the route is given up [s].
    Point3 aside = Point3::Zero();
  };

  static MissionOptions checked(MissionOptions o, std::span<const Configuration> starts) {
    require(!starts.empty(), "robots: expected at least one");
    require(starts.size() <= 64, "robots: expected at most 64");
    require(o.voxel_size > 0.0 && std::isfinite(o.voxel_size),
            "voxel size: expected a positive length");
    require(o.known_weight > 0.0 && o.observed_share > 0.0 && o.observed_share <= 1.0,
            "known weight: expected a positive weight and a share in (0, 1]");
    require(o.image_period > 0.0 && o.image_period <= 5.0,
            "image period: expected more than 0 and at most 5 s");
    require(o.limits.speed > 0.0, "speed: expected more than 0 m/s");
    require(!o.bounds.isEmpty(), "bounds: expected a box to fly in");
    for (const Configuration& s : starts)
      require(o.bounds.contains(s.position) && o.keep_out.distance(s.position) >= o.body_radius,
              "start outside the bounds or in a keep-out box: expected a start inside the one and "
              "outside the other");
    if (o.tsdf.truncation <= 0.0) o.tsdf.truncation = 3.0 * o.voxel_size;
    if (o.margin <= 0.0) o.margin = o.voxel_size;
    if (o.unknown_margin <= 0.0) o.unknown_margin = o.margin;
    o.tsdf.threads = o.threads;
    return o;
  }

  /// Corners are cut, so robots are not quite where their paths say.
  TrafficOptions traffic_options() const {
    TrafficOptions o;
    o.least_gap += options_.limits.corner_tolerance;
    o.period = options_.image_period;
    o.braking = options_.limits.braking;
    return o;
  }

  // -- sensing -----------------------------------------------------------------------------------
  void look() {
    const std::size_t n = agents_.size();
    std::vector<DepthImage> images(n);
    parallel_for(n, options_.threads, [&](std::size_t r) {
      images[r] = world_->capture(r, step_, fleet_);
      std::vector<Point3> mates;
      for (std::size_t k = 0; k < n; ++k)
        if (k != r) mates.push_back(fleet_[k].position);
      mask_teammates(images[r], options_.camera, camera_pose(r), mates,
                     options_.body_radius + options_.voxel_size);
    });
    for (std::size_t r = 0; r < n; ++r)
      integrate_(images[r], options_.camera, camera_pose(r), map_);
    result_.images += n;
    known_.update(map_);
    observed_.update(map_);
    flyable_.update(map_);
    incomplete_.update(known_);
    free_.update();
    elements_dirty_ = true;
  }
  Pose camera_pose(std::size_t r) const { return fleet_[r].pose() * options_.T_body_camera; }

  /// The elements still worth planning for, in voxel order; made when first asked for in a step.
  const std::vector<IncompleteElement>& work() {
    if (elements_dirty_) {
      work_ = incomplete_.elements();
      std::erase_if(work_, [&](const IncompleteElement& e) { return ledger_.given_up(e.voxel); });
      elements_dirty_ = false;
    }
    return work_;
  }

  // -- stops -------------------------------------------------------------------------------------
  /// Nothing is left that the stop was for; one that is for nothing stays to be flown to.
  bool is_pointless(const Stop& stop) const {
    return !stop.targets.empty() &&
           std::none_of(stop.targets.begin(), stop.targets.end(), [&](const VoxelIndex& v) {
             return incomplete_.contains(v) && !ledger_.given_up(v);
           });
  }
  std::size_t open_work(const Stops& route) const {
    std::size_t n = 0;
    for (const Stop& s : route)
      for (const VoxelIndex& v : s.targets) n += incomplete_.contains(v) ? 1 : 0;
    return n;
  }
  /// Images that a stop may take at the most.
  std::size_t most_looks() const {
    return static_cast<std::size_t>(
        std::max(1.0, std::ceil(options_.max_dwell / options_.image_period)));
  }
  /// Images from here that make a voxel at distance z known: W_th z², as the weights are 1/z².
  std::size_t looks_needed(const Configuration& q, const VoxelIndex& v) const {
    const double z2 = (known_.grid().center(v) - q.position).squaredNorm();
    return static_cast<std::size_t>(std::ceil(options_.known_weight * z2)) + 2;
  }

  void check_stops() {
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      Agent& a = agents_[r];
      if (a.phase == Phase::looking) {
        ++a.images;
        bool done = true;
        std::size_t needed = 0;
        for (const VoxelIndex& v : a.route.front().targets) {
          if (!incomplete_.contains(v)) continue;
          done = false;
          needed = std::max(needed, looks_needed(fleet_[r], v));
        }
        if (done || a.images >= std::min(needed, most_looks())) leave_stop(r);
      }
      if (a.phase != Phase::flying && a.phase != Phase::aside) continue;
      if (a.phase == Phase::flying && is_pointless(a.route.front())) {
        leave_goal(a);
      } else if (obstacle_ahead_(free_, a.motion.remaining(), a.motion.stopping_distance())) {
        ++result_.emergency_stops;
        halt(a);
      }
    }
  }
  void leave_stop(std::size_t r) {
    Agent& a = agents_[r];
    note_looks_in_vain(r);
    elements_dirty_ = true;
    a.route.erase(a.route.begin());
    a.phase = Phase::waiting;
  }
  /// Whatever was in fair view from this stop for long enough and is still incomplete, and what the
  /// stop was for in any case, was looked at in vain.
  void note_looks_in_vain(std::size_t r) {
    const Agent& a = agents_[r];
    const ViewFrustum::Placed view = frustum_.at(fleet_[r]);
    const Point3 eye = view.eye();
    LineOfSight line(observed_);
    const Stop& stop = a.route.front();
    for (const IncompleteElement& e : work()) {
      if (a.images < std::min(looks_needed(fleet_[r], e.voxel), most_looks())) continue;
      const Eigen::Vector3d to_eye = (eye - e.position).normalized();
      const bool fair = e.faces(to_eye, kFairLook) && reveals(view, e, line);
      if (fair ||
          std::find(stop.targets.begin(), stop.targets.end(), e.voxel) != stop.targets.end())
        ledger_.looked_in_vain(e.voxel, to_eye);
    }
  }
  void halt(Agent& a) {
    a.motion.stop();
    a.phase = Phase::waiting;
    a.held = false;
  }
  /// As `halt`, but who may turn in flight goes on until `plan` has asked where to.
  void leave_goal(Agent& a) {
    if (!a.replan.turn_in_flight || a.held || a.phase != Phase::flying) return halt(a);
    a.phase = Phase::waiting;
  }
  // -- planning ----------------------------------------------------------------------------------
  void plan() {
    if (std::any_of(agents_.begin(), agents_.end(),
                    [](const Agent& a) { return a.phase == Phase::scanning; }))
      return;
    bool ask = false;
    for (const Agent& a : agents_) ask |= a.route.empty() ? time_ >= a.idle_until : is_spent(a);
    ask |= at_rest();
    if (ask) request_plan();
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      Agent& a = agents_[r];
      if (a.phase != Phase::waiting) continue;
      if (!a.motion.standing()) {
        if (!turns(r)) a.motion.stop();
      } else if (!a.route.empty()) {
        depart(r);
      }
    }
  }
  /// UtilityCheck: so much of what the route was made for is complete, or left behind, that a new
  /// one is due.
  bool is_spent(const Agent& a) const {
    return a.initial_work > 0 && UtilityCheck{a.replan.utility_share.value_or(
                                     options_.utility_share)}(a.initial_work, open_work(a.route));
  }

  void request_plan() {
    std::vector<RobotRequest> robots;
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      Agent& a = agents_[r];
      const bool idle = a.route.empty() || is_spent(a);
      robots.push_back({fleet_[r], idle, idle ? Stops{} : a.route});
    }
    const PlanRequest request{.work = work(),
                              .incomplete = incomplete_,
                              .known = known_,
                              .observed = observed_,
                              .ledger = ledger_,
                              .free_space = free_,
                              .roadmap = roadmap_,
                              .camera = options_.camera,
                              .T_body_camera = options_.T_body_camera,
                              .headings = headings_,
                              .region = options_.region,
                              .robots = robots,
                              .time = time_,
                              .round = result_.plans};
    if (at_rest()) ++vain_plans_;
    const auto before = std::chrono::steady_clock::now();
    PlanResult result = ask(planner, request);
    result_.planning_time +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    ++result_.plans;
    impossible_ = std::move(result.impossible);
    planned_revision_ = known_.grid().revision();
    nothing_planned_ = std::all_of(result.routes.begin(), result.routes.end(),
                                   [](const auto& route) { return !route || route->empty(); });
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      if (!result.routes[r]) continue;
      Agent& a = agents_[r];
      Stops& route = *result.routes[r];
      const bool same =
          !route.empty() && !a.route.empty() && a.phase != Phase::waiting &&
          (route.front().configuration.position - a.route.front().configuration.position).norm() <
              1e-6 &&
          std::abs(wrap_angle(route.front().configuration.yaw -
                              a.route.front().configuration.yaw)) < 1e-6;
      a.route = std::move(route);
      a.initial_work = open_work(a.route);
      a.replan = result.replan;
      if (!same) leave_goal(a);
      if (a.route.empty())
        rest(a);
      else
        a.pause = kIdle;
    }
  }
  /// A robot nobody had work for asks less and less often: a plan is one for all, and disturbs
  /// them.
  void rest(Agent& a) {
    a.idle_until = time_ + a.pause;
    a.pause = std::min(2.0 * a.pause, kLongestIdle);
  }

  /// Sets off for the first stop that can be reached; the others are noted and dropped.
  void depart(std::size_t r) {
    Agent& a = agents_[r];
    while (!a.route.empty()) {
      const Stop& stop = a.route.front();
      if (is_pointless(stop)) {
        a.route.erase(a.route.begin());
        continue;
      }
      if (const auto path = roadmap_.query(fleet_[r].position, stop.configuration.position)) {
        set_off(a, *path);
        return;
      }
      ledger_.not_reached(stop.targets);
      elements_dirty_ = true;
      a.route.erase(a.route.begin());
    }
    rest(a);
  }

  /// Whether the robot, under way to a goal that is none any more, could turn to its next stop.
  bool turns(std::size_t r) {
    Agent& a = agents_[r];
    if (a.motion.braking()) return false;
    while (!a.route.empty() && is_pointless(a.route.front())) a.route.erase(a.route.begin());
    if (a.route.empty()) return false;
    const auto path = roadmap_.query(fleet_[r].position, a.route.front().configuration.position);
    if (!path) return false;
    // Who has to turn back is sooner there if it brakes first.
    if (path->points.size() > 1 && a.motion.velocity().dot(path->points[1] - path->points[0]) < 0.0)
      return false;
    // The turn leads off the path as far as the robot needs to come round.
    const std::vector<Point3> way = a.motion.way_onto(path->points);
    for (std::size_t i = 1; i < std::min<std::size_t>(way.size(), 3); ++i)
      if (!free_.is_free_segment(way[i - 1], way[i])) return false;
    set_off(a, *path);
    return true;
  }
  void set_off(Agent& a, const Path& path) {
    const double yaw = a.route.front().configuration.yaw;
    a.watch_yaw = yaw;
    AerialMotion::YawLaw look;
    if (options_.watchful)
      look = [&a](const Point3&, const Eigen::Vector3d&) { return a.watch_yaw; };
    a.motion.follow(path.points, yaw, std::move(look));
    a.phase = Phase::flying;
    a.images = 0;
    vain_plans_ = 0;
  }

  /// Nobody moves, looks or has anything to do.
  bool at_rest() const {
    return std::all_of(agents_.begin(), agents_.end(), [](const Agent& a) {
      return a.phase == Phase::waiting && a.route.empty() && a.motion.standing();
    });
  }
  /// Done when nobody has anything to do and the planner, asked on this very map, found nothing, or
  /// time after time nothing that can be reached.
  bool finished() const {
    return at_rest() && planned_revision_ == known_.grid().revision() &&
           (nothing_planned_ || vain_plans_ > options_.looks.max_failures);
  }

  // -- motion ------------------------------------------------------------------------------------
  void move() {
    std::vector<TrafficAgent> traffic;
    for (std::size_t r = 0; r < agents_.size(); ++r) traffic.push_back(announce(r));
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      Agent& a = agents_[r];
      if (agents_.size() > 1 && a.phase != Phase::scanning) give_way(r, traffic);
      if (a.phase == Phase::scanning && (a.quarters == 0 || a.motion.finished())) {
        if (++a.quarters > 4)
          a.phase = Phase::waiting;
        else
          a.motion.follow(std::span<const Point3>(&fleet_[r].position, 1),
                          fleet_[r].yaw + 0.5 * kPi);
      }
      if (a.phase == Phase::flying && options_.watchful) a.watch_yaw = where_to_look(r);
      if (!a.held) a.held_until = time_ + kLongestHold;
      if (a.phase == Phase::flying && time_ > a.held_until) give_up_route(a);
      fleet_[r] = a.motion.advance(options_.image_period);
      if (a.phase == Phase::flying && a.motion.finished()) a.phase = Phase::looking;
      traffic[r] = announce(r);
    }
  }
  /// Where robots block each other for good, one does something else.
  void give_up_route(Agent& a) {
    ledger_.not_reached(a.route.front().targets);
    elements_dirty_ = true;
    a.route.clear();
    halt(a);
  }
  /// What a robot tells the others of its motion.
  TrafficAgent announce(std::size_t r) const {
    const Agent& a = agents_[r];
    TrafficAgent t;
    t.id = static_cast<int>(r);
    t.position = fleet_[r].position;
    // One that brakes still moves, whatever it is about.
    if (a.phase == Phase::flying || a.phase == Phase::aside || !a.motion.standing())
      t.path = a.motion.remaining();
    t.radius = options_.body_radius;
    t.speed = options_.limits.speed;
    t.idle = a.route.empty();
    t.cornered = a.traffic.cornered(time_);
    t.held = a.held && a.motion.standing();
    return t;
  }
  /// TrafficPolicy [000 Alg. 3]: stop and wait, or step aside, or go on.
  void give_way(std::size_t r, std::span<const TrafficAgent> traffic) {
    Agent& a = agents_[r];
    const auto free = [this](const Point3& p, const Point3& q) {
      return free_.is_free_segment(p, q);
    };
    const Maneuver m = a.traffic(traffic[r], traffic, free, time_);
    const bool moving = a.phase == Phase::flying || a.phase == Phase::aside;
    switch (m.kind) {
      case Maneuver::Kind::none:
        if (a.held) a.motion.resume();
        a.held = false;
        if (a.phase == Phase::aside && a.motion.finished()) a.phase = Phase::waiting;
        break;
      case Maneuver::Kind::stop:
        if (!moving) break;
        if (!a.held) ++result_.waits;
        a.motion.stop();
        a.held = true;
        break;
      case Maneuver::Kind::step_aside:
        if (a.phase == Phase::aside && !a.motion.finished() &&
            (m.target - a.aside).norm() < options_.body_radius) {
          // The place is still good; the way there must be, too.
          const bool hold = a.traffic.too_close(traffic[r], traffic) >= 0;
          if (hold && !a.held) a.motion.stop();
          if (!hold && a.held) a.motion.resume();
          a.held = hold;
        } else if (!a.motion.standing()) {
          a.motion.stop();
          a.held = moving;
        } else {
          const std::array<Point3, 2> way{fleet_[r].position, m.target};
          a.motion.follow(way, fleet_[r].yaw);
          a.aside = m.target;
          a.phase = Phase::aside;
          a.held = false;
          ++result_.waits;
        }
        break;
    }
  }
  /// The heading with the most incomplete surface in view from here; near the goal, the goal's.
  double where_to_look(std::size_t r) {
    const Agent& a = agents_[r];
    const Configuration& goal = a.route.front().configuration;
    const double left = polyline_length(a.motion.remaining());
    const auto has_to_turn = [&](double angle) {
      return left < (angle / options_.limits.yaw_rate + 0.5) * options_.limits.speed;
    };
    if (!a.replan.watch_on && has_to_turn(kPi)) return goal.yaw;
    std::vector<SightTarget> near;
    const double reach = 0.85 * options_.camera.max_range;
    for (const IncompleteElement& e : work())
      if ((e.position - fleet_[r].position).squaredNorm() < reach * reach)
        near.push_back({e.frontier(options_.voxel_size), e.direction, 1.0, 2});
    if (near.empty()) return goal.yaw;
    const SightTargets targets(std::move(near), MapSight(observed_), headings_,
                               {.max_range = reach});
    const std::vector<char> none(targets.size(), 0);
    const auto worth = worth_by_heading(targets, targets.seen_from(fleet_[r].position), none);
    const auto best = std::max_element(worth.begin(), worth.end());
    if (*best <= 0.0) return goal.yaw;
    const double yaw = heading_angle(static_cast<int>(best - worth.begin()));
    return has_to_turn(std::abs(wrap_angle(goal.yaw - yaw))) ? goal.yaw : yaw;
  }

  // -- records -----------------------------------------------------------------------------------
  void record() {
    for (std::size_t r = 0; r < agents_.size(); ++r) {
      auto& t = result_.trajectories[r];
      if (!t.empty())
        result_.path_length[r] += (fleet_[r].position - t.back().configuration.position).norm();
      t.push_back({time_, fleet_[r]});
    }
  }
  MissionProgress current() const {
    return {.time = time_,
            .path_length = result_.total_path_length(),
            .incomplete = incomplete_.size(),
            .known_blocks = known_.grid().block_count(),
            .estimated_coverage = estimate_};
  }
  CoverageEstimate estimate() const {
    const TriangleMesh mesh =
        extract_surface(map_, {.min_weight = options_.known_weight, .threads = options_.threads});
    return estimate_coverage(map_, mesh, incomplete_, options_.known_weight, options_.region);
  }
  void account_for_rest() {
    std::map<VoxelKey, LeftReason> planned;
    for (const auto& [v, reason] : impossible_) planned[key_of(v)] = reason;
    incomplete_.for_each([&](const IncompleteElement& e) {
      LeftReason reason = LeftReason::not_attempted;
      if (const auto given = ledger_.reason(e.voxel)) {
        reason = *given;
      } else if (const auto it = planned.find(key_of(e.voxel)); it != planned.end()) {
        reason = it->second;
      }
      ++result_.reasons[reason];
      ++result_.remaining;
    });
  }

  static constexpr double kFairLook = 0.4;  ///< Least cosine between n̄_v and the line of sight.
  static constexpr double kFirstEstimate = 20.0;  ///< Between accounts of coverage at first [s] …
  static constexpr double kEstimates = 1.25;      ///< … and later, the next over the last.
  static constexpr double kIdle = 2.0;  ///< Between requests of a robot without work [s] …
  static constexpr double kLongestIdle = 30.0;  ///< … when nothing was found time after time.
  static constexpr double kLongestHold = 60.0;  ///< For teammates before a route is given up [s].

  MissionOptions options_;
  World* world_;
  TsdfMap map_;
  TsdfIntegrator<DropOffWeight<>> integrate_;
  VoxelStateMap known_, observed_, flyable_;
  IncompleteSurface incomplete_;
  FreeSpace free_;
  LazyPrmStar roadmap_;
  HeadingTable headings_;
  ViewFrustum frustum_;
  LookLedger ledger_;
  ObstacleCheck obstacle_ahead_{.lookahead = 1.5};
  std::vector<Agent> agents_;
  std::vector<Configuration> fleet_;
  std::vector<IncompleteElement> work_;
  bool elements_dirty_ = true;
  std::vector<std::pair<VoxelIndex, LeftReason>> impossible_;
  std::uint64_t planned_revision_ = ~std::uint64_t{0}, step_ = 0;
  bool nothing_planned_ = false;
  int vain_plans_ = 0;  ///< Made with all at rest, since a robot last set off.
  double time_ = 0.0, next_estimate_ = 0.0, estimate_ = 0.0;
  MissionResult result_;
};
}  // namespace surfleet
