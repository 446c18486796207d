// SPDX-License-Identifier: MIT
/// @file
/// @brief A transport under a network's conditions: a simulated network, or a real one made worse.
///
///     SimulatedNetwork<Packet> network(5, NetworkConditions::named("wifi"));
///     network.send({.time = t, .from = 2, .payload = packet});
///     network.advance(t += 0.1);
///     for (const Message<Packet>& m : network.receive(0)) …
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/fleet/network_conditions.hpp>

namespace surfleet {
/// What a payload must say of itself: `byte_size(p)`, and `kind_of(p)`, its kind, which is also its
/// rank: messages of lower kinds are sent before others that wait.
template <typename P>
concept NetworkPayload = requires(const P& p) {
  { byte_size(p) } -> std::convertible_to<std::size_t>;
  { kind_of(p) } -> std::convertible_to<std::uint8_t>;
};

/// Why a message did not arrive.
enum class NetworkDrop : std::uint8_t { loss, out_of_range, partition, queue };
inline constexpr std::size_t kNetworkDrops = 4;
inline std::string_view name_of(NetworkDrop reason) {
  constexpr std::string_view kNames[] = {"loss", "out_of_range", "partition", "queue"};
  return kNames[static_cast<std::size_t>(reason)];
}

/// Puts conditions on whatever `Inner` carries, and counts. Time is what `advance` says: messages
/// are sent at that time and arrive when it has come. A message that a network duplicates is
/// received twice, with the same sequence number; one that waits for bandwidth gets its number when
/// it leaves. The same seed and calls give the same result.
template <Transport Inner>
requires NetworkPayload<typename Inner::Payload>
class Impaired {
 public:
  using Payload = typename Inner::Payload;

  /// Where robots are, for the range and the line of sight.
  std::function<Point3(RobotId)> position;
  /// Whether two places see each other, for conditions that ask for it.
  std::function<bool(const Point3&, const Point3&)> line_of_sight;

  /// `here`: the robots whose messages are received in this process. Throws `Error` on conditions
  /// that are none.
  Impaired(NetworkConditions conditions, Inner inner, std::vector<RobotId> here)
      : conditions_(std::move(conditions)), inner_(std::move(inner)), here_(std::move(here)) {
    conditions_.check();
  }

  Inner& inner() { return inner_; }
  const NetworkConditions& conditions() const { return conditions_; }
  double time() const { return now_; }

  void send(Message<Payload> message) {
    require(!(conditions_.range || conditions_.line_of_sight) || position,
            "network: a range or line of sight, but no positions");
    require(!conditions_.line_of_sight || line_of_sight,
            "network: a line of sight, but nothing that tells what is between");
    if (!conditions_.bandwidth) {
      transmit(std::move(message), now_);
      return;
    }
    Sender& sender = senders_[message.from];
    const std::size_t size = byte_size(message.payload);
    const std::uint8_t kind = kind_of(message.payload);
    sender.waiting[kind].push_back({now_, size, std::move(message)});
    sender.bytes += size;
    while (sender.bytes > conditions_.queue_bytes) {
      auto& last = std::prev(sender.waiting.end())->second;
      sender.bytes -= last.back().size;
      last.pop_back();
      if (last.empty()) sender.waiting.erase(std::prev(sender.waiting.end()));
      ++dropped_[static_cast<std::size_t>(NetworkDrop::queue)];
    }
  }
  /// Lets time pass, up to `now` [s], never back.
  void advance(double now) {
    require(now >= now_, "network: time goes on only");
    for (auto& [id, sender] : senders_) pump(sender, now);
    now_ = now;
  }
  /// See `Transport`. O(n log n) of what is in transit to the robot.
  std::vector<Message<Payload>> receive(RobotId robot) {
    pull(robot, now_);
    std::vector<Message<Payload>> arrived;
    auto& box = boxes_[robot];
    const auto in_transit = std::stable_partition(
        box.begin(), box.end(), [&](const InTransit& u) { return u.arrives > now_; });
    for (auto it = in_transit; it != box.end(); ++it) arrived.push_back(std::move(it->message));
    box.erase(in_transit, box.end());
    std::stable_sort(
        arrived.begin(), arrived.end(), [](const Message<Payload>& a, const Message<Payload>& b) {
          return std::tie(a.time, a.from, a.sequence) < std::tie(b.time, b.from, b.sequence);
        });
    return arrived;
  }

  // -- counts ------------------------------------------------------------------------------------
  /// What a robot has sent, once whoever hears it: of a kind, and of all [bytes].
  std::uint64_t bytes_sent(RobotId robot, std::uint8_t kind) const {
    const auto it = sent_.find({robot, kind});
    return it == sent_.end() ? 0 : it->second;
  }
  std::uint64_t bytes_sent(RobotId robot) const {
    std::uint64_t sum = 0;
    for (const auto& [key, bytes] : sent_) sum += key.first == robot ? bytes : 0;
    return sum;
  }
  /// What all have sent of a kind [bytes].
  std::uint64_t bytes_sent_by_kind(std::uint8_t kind) const {
    std::uint64_t sum = 0;
    for (const auto& [key, bytes] : sent_) sum += key.second == kind ? bytes : 0;
    return sum;
  }
  /// Messages that did not arrive, for each receiver that missed one; `queue`, for each not sent.
  std::uint64_t dropped(NetworkDrop why) const { return dropped_[static_cast<std::size_t>(why)]; }

 private:
  struct Waiting {
    double since = 0.0;
    std::size_t size = 0;
    Message<Payload> message;
  };
  struct Sender {
    std::map<std::uint8_t, std::deque<Waiting>> waiting;  // by kind, none empty
    std::size_t bytes = 0;
    double free_at = 0.0;
    std::optional<Waiting> on_air;  // done at `free_at`
  };
  struct InTransit {
    double arrives = 0.0;
    Message<Payload> message;
  };

  void pump(Sender& sender, double now) {
    for (;;) {
      if (sender.on_air) {
        if (sender.free_at > now) return;
        transmit(std::move(sender.on_air->message), sender.free_at);
        sender.on_air.reset();
      }
      if (sender.waiting.empty()) return;
      double begin = sender.waiting.begin()->second.front().since;
      for (const auto& [kind, queue] : sender.waiting) begin = std::min(begin, queue.front().since);
      begin = std::max(begin, sender.free_at);
      if (begin > now) return;
      auto next = sender.waiting.begin();
      while (next->second.front().since > begin) ++next;
      sender.on_air = std::move(next->second.front());
      next->second.pop_front();
      if (next->second.empty()) sender.waiting.erase(next);
      sender.bytes -= sender.on_air->size;
      sender.free_at =
          begin + 8.0 * static_cast<double>(sender.on_air->size) / *conditions_.bandwidth;
    }
  }
  void transmit(Message<Payload> message, double time) {
    sent_[{message.from, kind_of(message.payload)}] += byte_size(message.payload);
    inner_.send(std::move(message));
    for (const RobotId robot : here_) pull(robot, time);
  }
  void pull(RobotId robot, double time) {
    for (Message<Payload>& m : inner_.receive(robot)) schedule(robot, std::move(m), time);
  }
  void schedule(RobotId to, Message<Payload> m, double time) {
    const auto drop = [&](NetworkDrop why) { ++dropped_[static_cast<std::size_t>(why)]; };
    if (!conditions_.connected(m.from, to, time)) return drop(NetworkDrop::partition);
    if (position) {
      const Point3 a = position(m.from), b = position(to);
      if ((conditions_.range && (a - b).norm() > *conditions_.range) ||
          (conditions_.line_of_sight && !line_of_sight(a, b)))
        return drop(NetworkDrop::out_of_range);
    }
    // A message's luck is its own, whatever else is sent.
    Random luck(mix64(conditions_.seed ^ mix64(std::uint64_t{m.from} << 32 | to)) + m.sequence);
    if (luck.uniform() < conditions_.loss) return drop(NetworkDrop::loss);
    const int copies = luck.uniform() < conditions_.duplication ? 2 : 1;
    double& last = last_arrival_[{m.from, to}];
    for (int copy = 0; copy < copies; ++copy) {
      double arrives =
          time + conditions_.latency + luck.uniform(-conditions_.jitter, conditions_.jitter);
      if (luck.uniform() < conditions_.reordering)
        arrives += luck.uniform(0.0, 2.0 * (conditions_.latency + conditions_.jitter) + kHeldBack);
      else
        last = arrives = std::max(arrives, last);
      boxes_[to].push_back({arrives, copy + 1 < copies ? m : std::move(m)});
    }
  }

  static constexpr double kHeldBack = 0.1;  // at most, beyond twice the latency [s]
  NetworkConditions conditions_;
  Inner inner_;
  std::vector<RobotId> here_;
  double now_ = 0.0;
  std::map<RobotId, Sender> senders_;
  std::map<RobotId, std::vector<InTransit>> boxes_;
  std::map<std::pair<RobotId, RobotId>, double> last_arrival_;
  std::map<std::pair<RobotId, std::uint8_t>, std::uint64_t> sent_;
  std::array<std::uint64_t, kNetworkDrops> dropped_{};
};

/// A network that is nothing but its conditions, for robots 0 … n − 1.
template <NetworkPayload P>
class SimulatedNetwork : public Impaired<PerfectTransport<P>> {
 public:
  explicit SimulatedNetwork(std::size_t robots, NetworkConditions conditions = {})
      : Impaired<PerfectTransport<P>>(std::move(conditions), PerfectTransport<P>(robots),
                                      all(robots)) {}

 private:
  static std::vector<RobotId> all(std::size_t robots) {
    std::vector<RobotId> ids(robots);
    std::iota(ids.begin(), ids.end(), RobotId{0});
    return ids;
  }
};
}  // namespace surfleet
