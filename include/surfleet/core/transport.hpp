// SPDX-License-Identifier: MIT
/// @file
/// @brief How robots talk to each other: messages, what carries them, and the medium that loses
/// nothing.
///
///     PerfectTransport<Report> air(robots);
///     air.send({.time = now, .from = 2, .payload = report});        // to all others
///     for (const Message<Report>& m : air.receive(0)) …              // by time, sender, sequence
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>

namespace surfleet {
using RobotId = std::uint32_t;  ///< Of a robot in its team, from 0 on.

template <typename Payload>
struct Message {
  double time = 0.0;            ///< When it was sent [s].
  RobotId from = 0;             ///< Its sender.
  std::uint32_t sequence = 0;   ///< Among its sender's messages; set by the transport.
  std::optional<RobotId> to{};  ///< Nothing: to all others.
  Payload payload{};
};

/// What carries messages between robots.
///
/// - `send(message)`: gives it its sequence number and takes it away. Not for concurrent use:
///   robots that act at once hand their messages over one after the other.
/// - `receive(robot)`: what has arrived there since the last call, each message once, in the order
///   (time, sender, sequence), whatever the order of sending.
///
/// Models: `PerfectTransport`; `SimulatedNetwork` and `Impaired` (`fleet/impaired.hpp`).
template <typename T>
concept Transport = requires(T& transport, Message<typename T::Payload> message, RobotId robot) {
  transport.send(std::move(message));
  { transport.receive(robot) } -> std::same_as<std::vector<Message<typename T::Payload>>>;
};

/// Everything arrives, at once and unchanged. O(receivers) a message.
template <typename P>
class PerfectTransport {
 public:
  using Payload = P;

  /// Told of every message when it is sent, for counts and records.
  std::function<void(const Message<P>&)> on_send;

  explicit PerfectTransport(std::size_t robots) : boxes_(robots), sent_(robots, 0) {}

  std::size_t robots() const { return boxes_.size(); }
  /// Throws `Error` for a sender or a receiver that is not there.
  void send(Message<P> message) {
    require_robot(message.from);
    if (message.to) require_robot(*message.to);
    message.sequence = sent_[message.from]++;
    if (on_send) on_send(message);
    if (message.to) {
      const RobotId to = *message.to;
      boxes_[to].push_back(std::move(message));
      return;
    }
    for (RobotId robot = 0; robot < boxes_.size(); ++robot)
      if (robot != message.from) boxes_[robot].push_back(message);
  }
  /// O(n log n). Throws `Error` for a robot that is not there.
  std::vector<Message<P>> receive(RobotId robot) {
    require_robot(robot);
    std::vector<Message<P>> arrived = std::exchange(boxes_[robot], {});
    std::sort(arrived.begin(), arrived.end(), [](const Message<P>& a, const Message<P>& b) {
      return std::tie(a.time, a.from, a.sequence) < std::tie(b.time, b.from, b.sequence);
    });
    return arrived;
  }
  /// How many messages a robot has sent.
  std::uint32_t sent(RobotId robot) const { return sent_[robot]; }

 private:
  void require_robot(RobotId robot) const {
    require(robot < boxes_.size(), "robot " + std::to_string(robot) + ": expected one of " +
                                       std::to_string(boxes_.size()));
  }
  std::vector<std::vector<Message<P>>> boxes_;
  std::vector<std::uint32_t> sent_;
};
static_assert(Transport<PerfectTransport<int>>);
}  // namespace surfleet
