// SPDX-License-Identifier: MIT
/// @file
/// @brief What a network does to messages.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/transport.hpp>

namespace surfleet {
/// For a time, robots hear only those of their own group; those that no group names are one, too.
struct NetworkPartition {
  double from = 0.0, until = 0.0;  ///< [s]
  std::vector<std::vector<RobotId>> groups;
};
/// For a time, one does not hear another, whatever the opposite direction does.
struct OneWayCut {
  double from = 0.0, until = 0.0;  ///< [s]
  RobotId sender = 0, receiver = 0;
};

struct NetworkConditions {
  double loss = 0.0;                  ///< Share of messages that a receiver misses.
  double duplication = 0.0;           ///< Share that arrives twice.
  double reordering = 0.0;            ///< Share that is held back while later ones pass.
  double latency = 0.0;               ///< From the last bit sent to the message received [s].
  double jitter = 0.0;                ///< Latency varies by up to this, evenly [s].
  std::optional<double> bandwidth{};  ///< Of a robot's sending [bit/s].
  std::size_t queue_bytes = 1 << 20;  ///< What waits for it; more drops the least urgent.
  std::optional<double> range{};      ///< Farthest that robots hear each other [m].
  bool line_of_sight = false;         ///< Robots hear each other only where nothing is between.
  std::vector<NetworkPartition> partitions{};
  std::vector<OneWayCut> cuts{};
  std::uint64_t seed = 1;

  /// Whether the schedule lets `receiver` hear `sender` at a time.
  bool connected(RobotId sender, RobotId receiver, double time) const {
    for (const OneWayCut& c : cuts)
      if (c.sender == sender && c.receiver == receiver && time >= c.from && time < c.until)
        return false;
    for (const NetworkPartition& p : partitions) {
      if (time < p.from || time >= p.until) continue;
      const auto group = [&](RobotId robot) {
        std::size_t g = 0;
        while (g < p.groups.size() &&
               std::count(p.groups[g].begin(), p.groups[g].end(), robot) == 0)
          ++g;
        return g;
      };
      if (group(sender) != group(receiver)) return false;
    }
    return true;
  }
  /// Throws `Error` on what no network is.
  void check() const {
    const auto share = [](double v) { return v >= 0.0 && v <= 1.0; };
    const auto length = [](double v) { return v >= 0.0 && std::isfinite(v); };
    require(share(loss) && share(duplication) && share(reordering),
            "network: expected loss, duplication and reordering in [0, 1]");
    require(length(latency) && length(jitter) && jitter <= latency,
            "network: expected a latency of at least 0 and no more jitter than that");
    require(!bandwidth || (*bandwidth > 0.0 && std::isfinite(*bandwidth)),
            "network: expected a positive bandwidth or none");
    require(!range || *range > 0.0, "network: expected a positive range or none");
    for (const NetworkPartition& p : partitions)
      require(p.from <= p.until, "network: a partition ends before it begins");
    for (const OneWayCut& c : cuts)
      require(c.from <= c.until, "network: a cut ends before it begins");
  }

  /// Of that name: perfect, wifi (2 %, 20 ms, 20 Mbit/s) or poor (30 %, 500 ± 200 ms, 1 Mbit/s).
  static std::optional<NetworkConditions> find(std::string_view name) {
    if (name == "perfect") return NetworkConditions{};
    if (name == "wifi") return NetworkConditions{.loss = 0.02, .latency = 0.02, .bandwidth = 20e6};
    if (name == "poor")
      return NetworkConditions{.loss = 0.3, .latency = 0.5, .jitter = 0.2, .bandwidth = 1e6};
    return std::nullopt;
  }
  /// The same. Throws `Error` for another name.
  static NetworkConditions named(const std::string& name) {
    if (auto known = find(name)) return *std::move(known);
    throw Error("network '" + name + "': expected perfect, wifi or poor");
  }
};
}  // namespace surfleet
