// SPDX-License-Identifier: MIT
// What a plan of the default planner costs, by incomplete elements and robots, on sites of houses
// whose walls are seen in part. "First" plans for the whole team on a map that the planner has
// never seen; "next" is the mean of those that follow, each for one robot that has made its first
// stop, after what it saw there has become known. Prints JSON; times are of the processor and of
// the clock.
//
//   plan_cost [--elements 1000,10000,100000] [--robots 1,3,10] [--next 10] [--threads 1]
//             [--repeats 1] [--plot FILE.svg]
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <span>
#include <string>
#include <vector>

#include "support/cli.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/plot.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/planning/default_planner.hpp>

namespace {
using namespace surfleet;
using examples::Clock;
using examples::seconds_since;

constexpr double kVoxel = 0.3;                                 // [m]
constexpr int kPlot = 40, kSky = 40, kHouse = 18, kRoof = 20;  // of a site [voxels]
constexpr int kHouseElements = 480;                            // incomplete at first, about

/// A square of plots with a house on each. The air is known to nine metres, and of the walls, in
/// pieces of three voxels, every other one by chance.
class Site {
 public:
  explicit Site(std::size_t elements)
      : side_(std::max(1, static_cast<int>(std::ceil(
                              std::sqrt(static_cast<double>(elements) / kHouseElements))))),
        houses_(std::max<int>(1, static_cast<int>(elements / kHouseElements))) {
    for_each_index(
        VoxelIndex(-kPlot / 2, -kPlot / 2, -1),
        VoxelIndex((side_ + 1) * kPlot - kPlot / 2, (side_ + 1) * kPlot - kPlot / 2, kSky),
        [&](const VoxelIndex& v) { write(v, state(v)); });
    mark();
  }
  TsdfMap& map() { return map_; }
  Box3 bounds() const {
    const double wide = (side_ * kPlot + kPlot / 4) * kVoxel;
    return {Point3(-0.25 * kPlot * kVoxel, -0.25 * kPlot * kVoxel, 0.0),
            Point3(wide, wide, kSky * kVoxel)};
  }
  /// Robots stand in the streets.
  std::vector<Configuration> starts(int robots) const {
    std::vector<Configuration> list;
    const double plot = kPlot * kVoxel;
    for (int r = 0; r < robots; ++r)
      list.push_back(
          {Point3((r + 0.5) * side_ * plot / robots, (r % (side_ + 1)) * plot, 3.0), 0.0});
    return list;
  }
  /// What is not known of walls within `reach` of a place becomes known.
  void see(const Point3& p, double reach) {
    const VoxelIndex r = VoxelIndex::Constant(static_cast<int>(reach / kVoxel));
    for_each_index(map_.index_of(p) - r, map_.index_of(p) + r, [&](const VoxelIndex& v) {
      if (is_wall(v) && (map_.center(v) - p).norm() <= reach) write(v, VoxelState::occupied);
    });
    mark();
  }

 private:
  static int in_plot(int i) { return ((i % kPlot) + kPlot) % kPlot; }
  /// How deep in a house a voxel is, 1 in its walls; 0 outside.
  int depth(const VoxelIndex& v) const {
    const int i = v.x() / kPlot, k = v.y() / kPlot;
    if (v.x() < 0 || v.y() < 0 || v.z() < 0 || i >= side_ || k >= side_ || k * side_ + i >= houses_)
      return 0;
    constexpr int kLow = (kPlot - kHouse) / 2;
    const int x = in_plot(v.x()) - kLow, y = in_plot(v.y()) - kLow;
    return std::max(0, std::min({x + 1, y + 1, kHouse - x, kHouse - y, kRoof - v.z()}));
  }
  bool is_wall(const VoxelIndex& v) const { return depth(v) == 1; }
  VoxelState state(const VoxelIndex& v) const {
    if (v.z() < 0) return VoxelState::occupied;
    const int d = depth(v);
    if (d > 1 || v.z() >= 30) return VoxelState::unknown;
    if (d == 0) return VoxelState::empty;
    const auto piece = [](int i) { return static_cast<std::uint64_t>(i / 3); };
    return mix64(piece(v.x()) | piece(v.y()) << 20 | piece(v.z()) << 40) % 2 == 0
               ? VoxelState::occupied
               : VoxelState::unknown;
  }
  void write(const VoxelIndex& v, VoxelState s) {
    const std::uint32_t slot = map_.ensure_slot(TsdfMap::block_of(v));
    map_.block(slot).voxels[TsdfMap::offset_of(v)] = {s == VoxelState::empty ? 0.5F : -0.5F,
                                                      s == VoxelState::unknown ? 0.0F : 1.0F};
    if (changed_.empty() || changed_.back() != slot) changed_.push_back(slot);
  }
  void mark() {
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const std::uint32_t slot : changed_) map_.mark_changed(slot);
    changed_.clear();
  }

  TsdfMap map_{{.voxel_size = kVoxel}};
  int side_, houses_;
  std::vector<std::uint32_t> changed_;
};

/// Seconds of the processor, all threads, and of the clock.
struct Cost {
  double processor = 0.0, clock = 0.0;
};
struct Row {
  std::size_t elements = 0;
  int robots = 0;
  Cost first, next;
  std::uint64_t stops = 0;  ///< A digest of all that were given out.
};

Row measure(std::size_t elements, int robots, int next, int threads) {
  Site site(elements);
  RobotKind kind;
  kind.camera = PinholeCamera::from_fov(radians(90.0), radians(60.0), 160, 92, 1.6, 8.0);
  kind.bounds = site.bounds();
  SurfaceBelief belief({.voxel_size = kVoxel, .region = site.bounds()},
                       std::span<const RobotKind>(&kind, 1), &site.map());
  DefaultPlanner planner = default_planner({.threads = threads});
  std::vector<RobotState> team;
  std::vector<RobotId> asked;
  for (const Configuration& at : site.starts(robots)) {
    asked.push_back(static_cast<RobotId>(team.size()));
    team.push_back({.id = asked.back(), .at = at});
  }
  Row row{belief.goals().size(), robots, {}, {}, 0};
  for (int k = 0; k <= next; ++k) {
    const SurfaceSituation situation{
        .belief = belief, .goals = belief.goals(), .asked = asked, .team = team};
    const std::clock_t before = std::clock();
    const auto start = Clock::now();
    const Plan plan = ask(planner, situation);
    const Cost cost{static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC,
                    seconds_since(start)};
    if (k == 0) {
      row.first = cost;
    } else {
      row.next.processor += cost.processor / next;
      row.next.clock += cost.clock / next;
    }
    for (const auto& [id, route] : plan.routes) {
      team[id].route = route;
      for (const Stop& stop : route)
        for (const double v : {stop.configuration.position.x(), stop.configuration.position.y(),
                               stop.configuration.position.z(), stop.configuration.yaw})
          row.stops = mix64(row.stops ^ std::bit_cast<std::uint64_t>(v));
      team[id].idle = route.empty();
    }
    // One robot makes its stop and asks.
    RobotState& robot = team[static_cast<std::size_t>(k % robots)];
    asked = {robot.id};
    if (!robot.route.empty()) {
      robot.at = robot.route.front().configuration;
      robot.route.clear();
      site.see(robot.at.position, 5.0);
      belief.update();
    }
    robot.idle = true;
  }
  return row;
}

Plot plot_of(std::span<const Row> rows, std::span<const int> robots) {
  Plot plot{.title = "What a plan costs",
            .x_label = "incomplete elements, power of ten",
            .y_label = "processor [s], power of ten"};
  for (const bool first : {true, false})
    for (const int r : robots) {
      PlotSeries series{.label = std::to_string(r)};
      series.label += r == 1 ? " robot" : " robots";
      series.label += first ? ", first plan" : ", next plans";
      series.dashed = first;
      for (const Row& row : rows) {
        if (row.robots != r) continue;
        series.x.push_back(std::log10(static_cast<double>(row.elements)));
        series.y.push_back(std::log10((first ? row.first : row.next).processor));
      }
      plot.add(std::move(series));
    }
  return plot;
}
int run(int argc, char** argv) {
  std::vector<int> elements{1000, 10000, 100000}, robots{1, 3, 10};
  int next = 10, threads = 1, repeats = 1;
  std::string picture;
  cli::Options app(
      "What a plan of the default planner costs, by incomplete elements and robots. Prints JSON.");
  app.add("--elements", elements, "of the sites, about").separated_by(',');
  app.add("--robots", robots, "of the team").separated_by(',');
  app.add("--next", next, "plans after the first").positive();
  app.add("--threads", threads, "of the planner").positive();
  app.add("--repeats", repeats, "of which the least counts").positive();
  app.add("--plot", picture, "file of a plot, SVG");
  app.parse(argc, argv);
  for (const int n : elements) require(n >= 1, "--elements: expected numbers of 1 or more");
  for (const int n : robots) require(n >= 1, "--robots: expected numbers of 1 or more");
  std::vector<Row> rows;
  std::printf("{\"threads\": %d, \"next_plans\": %d, \"repeats\": %d, \"rows\": [\n", threads, next,
              repeats);
  for (const int e : elements)
    for (const int r : robots) {
      // The machine is never quicker than it is: the least of repeats is the cost.
      Row least;
      for (int k = 0; k < repeats; ++k) {
        const Row row = measure(static_cast<std::size_t>(e), r, next, threads);
        if (k == 0) least = row;
        const auto take = [](Cost& a, const Cost& b) {
          a = {std::min(a.processor, b.processor), std::min(a.clock, b.clock)};
        };
        take(least.first, row.first);
        take(least.next, row.next);
      }
      rows.push_back(least);
      std::printf(
          "%s {\"elements\": %zu, \"robots\": %d, \"first_processor_s\": %.4f, "
          "\"first_clock_s\": %.4f, \"next_processor_s\": %.4f, \"next_clock_s\": %.4f, "
          "\"stops\": \"%016llx\"}",
          rows.size() == 1 ? "" : ",\n", least.elements, r, least.first.processor,
          least.first.clock, least.next.processor, least.next.clock,
          static_cast<unsigned long long>(least.stops));
      std::fflush(stdout);
    }
  std::printf("]}\n");
  if (!picture.empty()) write_file(picture, to_svg(plot_of(rows, robots)));
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  return cli::run("plan_cost", [&] { return run(argc, argv); });
}
