// SPDX-License-Identifier: MIT
// requires: inspection, dds
// One robot of a distributed fleet: a process of its own, that hears its team over the network.
//
//   fleet_agent --id 1 --robots 2 --scene house --out out/1 &
//   fleet_agent --id 2 --robots 2 --scene house --out out/2 && wait
//   fleet_agent --collect out/1 out/2 --robots 2 --scene house --out out/team
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "support/agent_folder.hpp"
#include "support/cli.hpp"
#include "support/fleet_collect.hpp"
#include "support/inspection.hpp"
#include "support/inspection_report.hpp"
#include "support/json_values.hpp"
#include "support/peak_memory.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/adapters/dds_bodies.hpp>
#include <surfleet/adapters/dds_team.hpp>
#include <surfleet/adapters/dds_transport.hpp>
#include <surfleet/core/pace.hpp>
#include <surfleet/fleet/distributed_agent.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/team_agreement.hpp>
#include <surfleet/fleet/team_end.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/simulation/mission_record.hpp>
#include <surfleet/simulation/simulated_drone.hpp>

namespace {
using namespace surfleet;
using namespace surfleet::examples;

struct Arguments {
  InspectionSettings settings;
  int id = 0;
  std::string team = "surfleet", security;
  std::vector<std::string> peers{"127.0.0.1"}, collect;
  int domain = 0;
  double speed_up = 1.0;
  double join = 3.0;
  double stay = 0.0;
  double lost_packets = 0.0;
  std::string out = "out/fleet_agent";
  bool quiet = false;

  RobotId robot() const { return static_cast<RobotId>(id - 1); }
};

Arguments arguments(int argc, char** argv) {
  cli::Options app(
      "One robot of a distributed fleet as a process of its own, in real time, with a simulated "
      "body.\nRobots find each other over the network (Cyclone DDS), share what they map, and end "
      "with the same map.\nWrites trajectory.tum and agent.json while it flies, and map.sfm, "
      "reconstruction.ply, points.ply and\nmetrics.json at its end to --out. With --collect, puts "
      "together and judges what all have left.\nExit status: 0 complete, or ended as it was asked "
      "to "
      "(of --collect: every robot of the team,\nwith equal maps); 2 input refused; 3 ended early, "
      "as "
      "by --max-time.");
  Arguments a;
  app.begin_group("Team");
  app.add("--id", a.id, "of this robot, from 1 to --robots");
  app.add("--team", a.team, "name of the team; a network carries one");
  app.add("--peers", a.peers, "hosts of the others, as in 10.0.0.4,10.0.0.5").separated_by(',');
  app.add("--domain", a.domain, "of DDS; robots of another are not heard").within(0, 230);
  app.add("--security", a.security,
          "folder of keys, as make_fleet_keys makes it: no other is heard, and none can speak "
          "for another; without, senders are claimed, not proved");
  app.add("--join", a.join, "longest wait for the others before it sets out [s]").zero_or_more();
  app.add("--stay", a.stay,
          "hovers for so long after the end, so that one that comes late catches up [s]")
      .zero_or_more();
  app.add("--lost-packets", a.lost_packets, "share of this robot's packets that are not sent")
      .zero_or_more();
  app.add("--speed-up", a.speed_up, "seconds of the mission in one of the clock").positive();
  app.begin_group("Judgement");
  app.add("--collect", a.collect, "folders of all robots, to compare and judge");
  InspectionOptions options(app, InspectionProgram::agent);
  app.begin_group("Results");
  app.add("--out", a.out, "folder for the results");
  app.add_flag("--quiet", a.quiet, "no progress line");
  app.add_examples(
      "  start_fleet 3 --scene house --out out/house          three robots on this host, and their "
      "report\n"
      "  fleet_agent --id 2 --robots 5 --peers 10.0.0.1,10.0.0.3 --out out/2    one of several "
      "hosts\n"
      "  fleet_agent --id 1 --security keys --team alpha      with keys of make_fleet_keys\n"
      "  fleet_agent --collect out/1 out/2 --robots 2 --out out/team            what came of it");
  app.parse(argc, argv);
  a.settings = options.settle();
  if (a.collect.empty()) {
    require(app.was_given("--id"), "--id: expected the number of this robot, from 1 on");
    require(a.id >= 1 && a.id <= a.settings.robots, "--id " + std::to_string(a.id) +
                                                        ": expected 1 to --robots, which is " +
                                                        std::to_string(a.settings.robots));
  }
  require(a.speed_up <= 1000.0, "--speed-up: expected at most 1000");
  require(a.join <= 600.0, "--join: expected at most 600 s");
  require(a.stay <= 1e5, "--stay: expected at most 100000 s");
  require(a.lost_packets <= 0.9, "--lost-packets: expected at most 0.9");
  return a;
}

TeamAgreement agreement(const Arguments& a, const MissionOptions& mission,
                        const AnyPacker& packer) {
  const SurfaceBeliefOptions belief = SurfaceBelief::checked(mission.belief);
  return {.team = a.team,
          .robot = a.robot(),
          .robots = static_cast<std::uint32_t>(a.settings.robots),
          .voxel = belief.voxel_size,
          .truncation = belief.tsdf.truncation,
          .known_weight = belief.known_weight,
          .image_weight = a.settings.integrator().weight(0.0, 2.0),
          .range = std::visit([](const auto& s) { return s.max_range; }, mission.kind.sensor()),
          .packing = packer.packing()};
}

/// How many of the team are there. Throws `Error` if one is there with which one cannot fly.
std::size_t mates_there(const DdsTeam& team, const TeamAgreement& ours) {
  std::set<RobotId> mates;
  for (const std::string& note : team.others()) {
    const auto theirs = TeamAgreement::read(note);
    if (!theirs) continue;  // another program
    const auto why = disagreement(ours, *theirs);
    require(!why, why.value_or(""));
    mates.insert(theirs->robot);
  }
  return mates.size();
}
/// Waits for the team; how long it took to find all [s], or nothing if some are missing.
std::optional<double> meet(const DdsTeam& team, const TeamAgreement& ours, double patience,
                           const std::function<void()>& while_waiting) {
  constexpr double kMoment = 1.0;  // more, for those that should not be there
  const auto start = Clock::now();
  std::optional<double> found;
  for (;;) {
    const double waited = seconds_since(start);
    if (mates_there(team, ours) + 1 >= ours.robots && !found) found = waited;
    if (waited >= (found ? *found + kMoment : patience) || cli::interrupted()) return found;
    while_waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}
/// Higher for a robot that is started later, whatever it still knows of before.
std::uint32_t incarnation() {
  using std::chrono::seconds, std::chrono::system_clock;
  constexpr std::int64_t k2020 = 1577836800;
  const auto now = std::chrono::duration_cast<seconds>(system_clock::now().time_since_epoch());
  return static_cast<std::uint32_t>(std::max<std::int64_t>(0, now.count() - k2020));
}

/// A robot, its body, and its end of the network.
class FlyingAgent {
 public:
  using Body = SimulatedDrone<AnyWorld>;

  FlyingAgent(const Arguments& a, const InspectionSite& site, const InspectionInputs& inputs,
              std::shared_ptr<DdsTeam> team, const TeamAgreement& agreed, const SpentCharge& spent)
      : id_(a.robot()),
        options_(mission_options(a.settings, site)),
        world_(site.world(a.settings)),
        lidar_world_(a.settings.has_lidar() ? std::optional(site.lidar_world(a.settings))
                                            : std::nullopt),
        any_world_(lidar_world_ ? AnyWorld(*lidar_world_) : AnyWorld(world_)),
        fleet_(places(a, site)),
        body_(any_world_, id_, fleet_, options_.kind.limits, options_.neighbours),
        robot_(id_, options_.kind, body_, options_.belief, agent_options(spent),
               options_.start_clearance,
               make_planner(a.settings.planner, a.settings.planner_settings()),
               limited(distributed(inputs.distributed.agent, agreed), options_.limits),
               inputs.distributed.packer),
        network_(inputs.distributed.network, DdsTransport(team), {id_}),
        bodies_(std::move(team)),
        end_({.linger = TeamEndOptions{}.linger + a.stay, .memory = a.settings.wait_for_team}),
        record_(1) {
    network_.position = [this](RobotId r) {
      return r < fleet_.size() ? fleet_[r].position : Point3(Point3::Constant(-1e6));
    };
    network_.line_of_sight = [this](const Point3& p, const Point3& q) { return world_.sees(p, q); };
  }
  FlyingAgent(const FlyingAgent&) = delete;
  FlyingAgent& operator=(const FlyingAgent&) = delete;

  /// Shows its body to others, before it is of the team, too.
  void show_body() { bodies_.tell(at()); }
  /// A step of the mission's clock; false at its end.
  bool step(double now) {
    for (const auto& [robot, at] : bodies_.others())
      if (robot < fleet_.size()) fleet_[robot] = at;
    network_.advance(now);
    robot_.observe(now, network_.receive(id_));
    ++record_.result.images;
    end_.observe(robot_, now);
    note_idleness(now);
    record_.estimate(now, robot_.belief());
    if (end_.over(now)) return false;
    for (Message<Packet>& m : robot_.act(now)) network_.send(std::move(m));
    show_body();
    if (!idle_) record_.add(now, std::span<const Configuration>(&at(), 1));  // or it hovers
    return true;
  }
  void close(double now, bool over) {
    record_.close(now, robot_.belief(), robot_.plans().impossible());
    record_.add_planning_robot(robot_, over);
    record_.result.left_out = robot_.plans().left_out();
    record_.result.complete = record_.result.stop_reasons.front() == StopReason::complete;
  }

  const Configuration& at() const { return fleet_[id_]; }
  const DistributedAgent<Body>& robot() const { return robot_; }
  const MissionResult& result() const { return record_.result; }
  const TeamEnd& end() const { return end_; }
  const MissionOptions& options() const { return options_; }

  /// What it has done since there was nothing left to do.
  nlohmann::json idleness() const {
    if (!idle_) return {{"idle_s", 0.0}};
    return {{"idle_s", idle_until_ - idle_->since},
            {"idle_bytes_sent", network_.bytes_sent(id_) - idle_->bytes_sent},
            {"idle_memory_growth_bytes", static_cast<std::int64_t>(resident_memory()) -
                                             static_cast<std::int64_t>(idle_->memory)}};
  }
  nlohmann::json traffic() {
    nlohmann::json drops =
        by_name<NetworkDrop>(kNetworkDrops, [&](NetworkDrop why) { return network_.dropped(why); });
    drops.update(by_name<MessageDrop>(
        kMessageDrops, [refused = robot_.drops()](MessageDrop why) { return refused[why]; }));
    drops["other_partition"] = network_.inner().counts().impostors;
    drops["unreadable"] = network_.inner().counts().unreadable;
    nlohmann::json lost = nlohmann::json::array();
    for (const RobotId r : end_.lost()) lost.push_back(r + 1);
    return {{"bytes_sent", network_.bytes_sent(id_)},
            {"bytes_sent_by_kind", by_name<MessageKind>(kMessageKinds,
                                                        [&](MessageKind kind) {
                                                          return network_.bytes_sent(
                                                              id_, static_cast<std::uint8_t>(kind));
                                                        })},
            {"messages_dropped", drops},
            {"redundant_stops", robot_.redundant_stops()},
            {"lost_robots", lost}};
  }

 private:
  /// Its own start, and others far from everything until they tell of themselves.
  std::vector<Configuration> places(const Arguments& a, const InspectionSite& site) const {
    std::vector<Configuration> all = site.starts(a.settings, a.settings.robots);
    for (std::size_t r = 0; r < all.size(); ++r)
      if (r != id_) all[r].position = Point3::Constant(-1e6 - 1e3 * static_cast<double>(r));
    return all;
  }
  void note_idleness(double now) {
    if (!end_.since())
      idle_.reset();
    else if (!idle_ || idle_->since != *end_.since())
      idle_ = Idle{*end_.since(), network_.bytes_sent(id_), resident_memory()};
    idle_until_ = now;
  }
  /// One whose charge is spent goes home at once.
  AgentOptions agent_options(const SpentCharge& spent) {
    constexpr double kNothing = 1e-6;
    EnduranceLimits& left = options_.agent.endurance = options_.limits.endurance;
    if (left.distance) left.distance = std::max(kNothing, *left.distance - spent.distance);
    if (left.time) left.time = std::max(kNothing, *left.time - spent.time);
    return options_.agent;
  }
  static DistributedAgentOptions distributed(DistributedAgentOptions o,
                                             const TeamAgreement& agreed) {
    o.team = agreed.number();
    o.incarnation = incarnation();
    o.sync.robots = o.relay.robots = agreed.robots;
    return o;
  }

  struct Idle {
    double since = 0.0;  // [s]
    std::uint64_t bytes_sent = 0;
    std::size_t memory = 0;  // [bytes]
  };
  RobotId id_;
  MissionOptions options_;
  DroneWorld<EmbreeRayCaster> world_;
  std::optional<LidarWorld<EmbreeRayCaster>> lidar_world_;
  AnyWorld any_world_;
  std::vector<Configuration> fleet_;  // the truth
  Body body_;
  DistributedAgent<Body> robot_;
  Impaired<DdsTransport> network_;
  DdsBodies bodies_;
  TeamEnd end_;
  std::optional<Idle> idle_;
  double idle_until_ = 0.0;  // [s]
  MissionRecord record_;
};

void write_results(const std::filesystem::path& out, const Arguments& a, const InspectionSite& site,
                   FlyingAgent& agent, nlohmann::json more) {
  const InspectionSettings& s = a.settings;
  const TsdfMap& map = agent.robot().map();
  const MappedSurface surface = mapped_surface(map, s, site.scene.region);
  write_ply(surface.mesh, out / "reconstruction.ply");
  write_ply(surface.points, out / "points.ply");
  save_map(map, out / "map.sfm");
  const MissionResult& m = agent.result();
  char digest[20];
  std::snprintf(digest, sizeof digest, "%016llx",
                static_cast<unsigned long long>(agent.robot().patches().digest()));
  nlohmann::json metrics{{"id", a.id},
                         {"team", a.team},
                         {"scene", site.scene.name},
                         {"planner", s.planner},
                         {"architecture", s.architecture_name()},
                         {"network", s.network},
                         {"secured", !a.security.empty()},
                         {"seed", s.seed},
                         {"voxel_m", s.voxel},
                         {"complete", m.complete},
                         {"stop_reason", std::string(name_of(m.stop_reasons.front()))},
                         {"completion_time_s", m.completion_time},
                         {"planning_time_s", m.planning_time},
                         {"peak_memory_bytes", peak_memory()},
                         {"path_length_m", m.total_path_length()},
                         {"path_at_work_m", m.total_path_at_work()},
                         {"left_area_m2", m.left_area},
                         {"estimated_coverage", m.coverage.share()},
                         {"remaining_ise", m.remaining},
                         {"remaining_ise_reasons", by_name(m.reasons)},
                         {"images", m.images},
                         {"plans", m.plans},
                         {"waits", m.waits},
                         {"emergency_stops", m.emergency_stops},
                         {"patches_digest", digest}};
  metrics.update(agent.traffic());
  metrics.update(agent.idleness());
  metrics.update(more);
  write_file(out / "metrics.json", metrics.dump(2) + "\n");
}

/// Throws `Error` where a path and a map do not fit: better than to be missed in flight.
void require_room(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  constexpr std::uintmax_t kLeast = 16 << 20;
  std::error_code ec;
  fs::path there = fs::absolute(out, ec).lexically_normal();
  while (!fs::exists(there, ec) && there.has_relative_path()) there = there.parent_path();
  const auto room = fs::space(there, ec).available;
  require(ec || room >= kLeast, "output folder " + out.string() + ": " +
                                    std::to_string(room >> 10) +
                                    " kB of room; expected at least 16 MB");
}

int fly(const Arguments& a) {
  const InspectionSettings& s = a.settings;
  const InspectionSite site(open_scene(s), s);
  // Whatever can be refused is refused before the first file is made.
  const InspectionInputs inputs = read_inputs(s);
  require_room(a.out);
  const TeamAgreement agreed = agreement(a, mission_options(s, site), inputs.distributed.packer);
  const auto team = std::make_shared<DdsTeam>(
      a.robot(), DdsOptions{.domain = static_cast<std::uint32_t>(a.domain),
                            .team = a.team,
                            .peers = a.peers,
                            .note = agreed.note(),
                            .security = a.security,
                            .lost_packets = a.lost_packets});
  const SpentCharge spent = spent_before(a.out, a.id);
  // With keys, silent robots are not found.
  FlyingAgent agent(a, site, inputs, team, agreed, spent);
  cli::watch_interrupts();
  const std::optional<double> found = meet(*team, agreed, a.join, [&] { agent.show_body(); });
  const auto out = cli::prepare_output_folder(a.out);
  TrajectoryLog path(out);
  write_file(out / "agent.json", nlohmann::json{{"id", a.id},
                                                {"team", a.team},
                                                {"robots", s.robots},
                                                {"scene", s.scene},
                                                {"voxel_m", s.voxel},
                                                {"speed_up", a.speed_up}}
                                         .dump(2) +
                                     "\n");
  cli::ProgressLine line(!a.quiet);
  const auto started = Clock::now();
  Pace pace(agent.options().agent.image_period, a.speed_up);
  path.add(agent.at());
  bool over = false;
  for (double now = pace.now(); now < s.max_time && !cli::interrupted(); now = pace.now()) {
    if (!agent.step(now)) {
      over = true;
      break;
    }
    path.add(agent.at());
    char text[160];
    std::snprintf(text, sizeof text,
                  "robot %d: %5.0f s  %7.1f m  %5zu incomplete elements, %zu mates", a.id, now,
                  agent.result().total_path_length(), agent.robot().belief().incomplete().size(),
                  agent.robot().team().mates(now).size());
    line(text);
    pace.wait();
  }
  line.finish();
  agent.close(pace.now(), over);
  write_results(out, a, site, agent,
                {{"wall_time_s", seconds_since(started)},
                 {"late_steps", pace.late()},
                 {"spent_before_m", spent.distance},
                 {"spent_before_s", spent.time},
                 {"found_team_s", found ? nlohmann::json(*found) : nlohmann::json()}});
  const MissionResult& m = agent.result();
  std::printf("robot %d: %s, path %.1f m, time %.0f s, %zu incomplete elements left\n", a.id,
              std::string(name_of(m.stop_reasons.front())).c_str(), m.total_path_length(),
              m.completion_time, m.remaining);
  for (const RobotId r : agent.end().lost()) std::printf("  robot %u was lost\n", r + 1);
  return m.enough() ? cli::kDone : cli::kIncomplete;
}

int collect(const Arguments& a) {
  InspectionSettings s = a.settings;
  InspectionSite site(open_scene(s), s);
  const std::vector<Configuration> starts = site.starts(s, s.robots);
  const std::vector<AgentFolder> folders = read_agent_folders(a.collect, s);
  site.find_reference(s, starts.front().position);
  const CollectedFleet c = collect_fleet(folders, s, site);
  const auto out = cli::prepare_output_folder(a.out);
  s.network = "dds";
  write_inspection(out, c.run);
  write_judgement(out, s, site, c.run, c.judged, {}, c.more);
  const ReconstructionMetrics& m = c.judged.evaluation.metrics;
  std::printf("%s: %s, %zu of %d robots, maps %s\n",
              c.run.result.complete ? "complete"
              : c.ended_well()      ? "enough"
                                    : "ended early",
              site.scene.name.c_str(), c.run.result.path_length.size(), s.robots,
              c.run.distributed->maps_equal ? "equal" : "not equal");
  const auto name_them = [](const std::vector<int>& robots, const char* what) {
    for (const int id : robots) std::printf("  robot %d %s\n", id, what);
  };
  name_them(c.missing, "is missing: none of the folders is its own");
  name_them(c.killed, "was lost: it has left a path and no end");
  name_them(c.early, "ended early");
  std::printf("  path %.1f m, time %.0f s, coverage %.1f %%, RMSE %.2f cm, collisions %d\n",
              c.run.result.total_path_length(), c.run.result.completion_time,
              100.0 * m.surface_coverage, 100.0 * m.rmse_m, c.judged.paths.collisions);
  if (const std::string doubt = doubts(c.judged); !doubt.empty())
    std::fprintf(stderr, "fleet_agent: %s\n", doubt.c_str());
  std::printf("  see %s\n", (out / "report.html").c_str());
  return c.ended_well() ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("fleet_agent", [&] {
    const Arguments a = arguments(argc, argv);
    return a.collect.empty() ? fly(a) : collect(a);
  });
}
