// SPDX-License-Identifier: MIT
/// @file
/// @brief What one robot of a distributed fleet leaves behind, also if its process is killed.
///
/// agent.json (which robot it is) and trajectory.tum (stamps of Unix time) are there while it
/// flies; map.sfm, reconstruction.ply, points.ply and metrics.json come at its end. A robot that is
/// started again in the folder of one that did not come to an end keeps that one's path as
/// trajectory_before_K.tum, and has so much less of its charge.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>

namespace surfleet::examples {
inline std::filesystem::path earlier_trajectory(const std::filesystem::path& folder,
                                                std::size_t k) {
  return folder / ("trajectory_before_" + std::to_string(k) + ".tum");
}

/// Writes a path while it is flown, a line at a time.
class TrajectoryLog {
 public:
  /// Throws `Error` if it cannot be written.
  explicit TrajectoryLog(const std::filesystem::path& folder) : file_(folder / "trajectory.tum") {
    namespace fs = std::filesystem;
    std::error_code ec;
    std::size_t k = 1;
    if (fs::exists(folder / "metrics.json", ec)) {
      fs::remove(folder / "metrics.json", ec);
      while (fs::remove(earlier_trajectory(folder, k), ec)) ++k;
    } else if (fs::exists(file_, ec)) {
      while (fs::exists(earlier_trajectory(folder, k), ec)) ++k;
      fs::rename(file_, earlier_trajectory(folder, k), ec);
    }
    out_.open(file_);
    out_ << "# time tx ty tz qx qy qz qw\n" << std::flush;
    check();
  }
  /// Throws `Error` if there is no more room.
  void add(const Configuration& at) {
    const std::chrono::duration<double> unix_time =
        start_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_);
    const StampedPose pose{unix_time.count(), at.pose()};
    const std::string text = format_tum(std::span<const StampedPose>(&pose, 1));
    out_ << text.substr(text.find('\n') + 1) << std::flush;
    check();
  }

 private:
  void check() const {
    require(out_.good(),
            file_.string() + ": cannot be written; expected a writable folder with room");
  }
  std::filesystem::path file_;
  std::ofstream out_;
  // A clock that is set meanwhile would tear the path.
  std::chrono::duration<double> start_ = std::chrono::system_clock::now().time_since_epoch();
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// A robot's folder, read.
struct AgentFolder {
  std::filesystem::path path;
  nlohmann::json about;                   ///< agent.json
  std::optional<nlohmann::json> metrics;  ///< Nothing if it did not come to an end.
  std::vector<Trajectory> flights;        ///< The first first; none is empty.

  int id() const { return about.at("id").get<int>(); }
  bool has_map() const {
    std::error_code ec;
    return metrics && std::filesystem::exists(path / "map.sfm", ec);
  }
};

/// Throws `Error` for a folder that no robot has left.
inline AgentFolder read_agent_folder(const std::filesystem::path& folder) {
  AgentFolder f{.path = folder, .about = {}, .metrics = {}, .flights = {}};
  std::error_code ec;
  const auto object = [&](const char* name) {
    const Bytes bytes = read_file(folder / name);
    nlohmann::json j = nlohmann::json::parse(text_of(bytes), nullptr, false);
    require(j.is_object(), (folder / name).string() + ": expected what fleet_agent writes");
    return j;
  };
  f.about = object("agent.json");
  require(
      f.about.contains("id") && f.about["id"].is_number_integer() && f.id() >= 1 && f.id() <= 64,
      (folder / "agent.json").string() + ": expected an id of 1 to 64");
  if (std::filesystem::exists(folder / "metrics.json", ec)) f.metrics = object("metrics.json");
  const auto fly = [&](const std::filesystem::path& file) {
    const Bytes bytes = read_file(file);
    std::string_view text = text_of(bytes);
    text = text.substr(0, text.rfind('\n') + 1);  // a process may be killed while it writes
    if (Trajectory t = parse_tum(text, file.string()); !t.empty())
      f.flights.push_back(std::move(t));
  };
  for (std::size_t k = 1; std::filesystem::exists(earlier_trajectory(folder, k), ec); ++k)
    fly(earlier_trajectory(folder, k));
  fly(folder / "trajectory.tum");
  return f;
}

/// What a robot's charge has given before its process was started anew.
struct SpentCharge {
  double distance = 0.0;  ///< [m]
  double time = 0.0;      ///< In the air, of the mission's clock [s].
};
/// Of the flights in a folder whose robot did not come to an end; nothing if that is another's, or
/// none's. Throws `Error` for one that cannot be read.
inline SpentCharge spent_before(const std::filesystem::path& folder, int id) {
  SpentCharge spent;
  std::error_code ec;
  if (!std::filesystem::exists(folder / "agent.json", ec) ||
      std::filesystem::exists(folder / "metrics.json", ec))
    return spent;
  const AgentFolder before = read_agent_folder(folder);
  if (before.id() != id) return spent;
  const double speed_up = before.about.value("speed_up", 1.0);
  for (const Trajectory& t : before.flights) {
    spent.distance += path_length(t);
    spent.time += speed_up * (t.back().time - t.front().time);
  }
  return spent;
}

/// Where a robot with these flights is at a time [s]: between its stamps on a line, after a flight
/// where that has ended, before the first nowhere, as in the instant before it is set down anew.
class FlownPath {
 public:
  static constexpr double kInstant = 1e-3;  ///< [s]

  /// Flights need not be in order.
  explicit FlownPath(std::vector<Trajectory> flights) : flights_(std::move(flights)) {
    std::sort(flights_.begin(), flights_.end(), [](const Trajectory& a, const Trajectory& b) {
      return a.front().time < b.front().time;
    });
  }
  Point3 at(double time) const {
    std::size_t k = 0;
    while (k < flights_.size() && flights_[k].front().time <= time) ++k;
    if (k == 0 || (k < flights_.size() && time > flights_[k].front().time - kInstant))
      return Point3::Constant(std::numeric_limits<double>::infinity());
    const Trajectory& t = flights_[k - 1];
    const auto next = std::upper_bound(t.begin(), t.end(), time,
                                       [](double v, const StampedPose& p) { return v < p.time; });
    if (next == t.end()) return t.back().T_world_body.translation();
    const StampedPose &a = *std::prev(next), &b = *next;
    const double share = b.time > a.time ? (time - a.time) / (b.time - a.time) : 1.0;
    return a.T_world_body.translation() +
           share * (b.T_world_body.translation() - a.T_world_body.translation());
  }
  /// The times at which it may turn, come or go.
  void add_instants(std::vector<double>& times) const {
    for (const Trajectory& t : flights_) {
      times.push_back(t.front().time - 0.5 * kInstant);
      for (const StampedPose& p : t) times.push_back(p.time);
    }
  }
  double length() const {  ///< [m]
    double sum = 0.0;
    for (const Trajectory& t : flights_) sum += path_length(t);
    return sum;
  }
  const std::vector<Trajectory>& flights() const { return flights_; }

 private:
  std::vector<Trajectory> flights_;
};
}  // namespace surfleet::examples
