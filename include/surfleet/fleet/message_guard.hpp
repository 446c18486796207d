// SPDX-License-Identifier: MIT
/// @file
/// @brief What of a robot's mail is read at all: whole packets of its team, each once, and from no
/// sender more than its share.
#pragma once

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/fleet/packet.hpp>

namespace surfleet {
/// The numbers that were seen of late. What is older than the window counts as seen. O(step).
class ReplayWindow {
 public:
  static constexpr std::uint32_t kSize = 1024;

  /// Whether the number comes for the first time.
  bool accept(std::uint32_t number) {
    if (none_ || number > newest_) {
      const std::uint64_t step = none_ ? kSize : std::uint64_t{number} - newest_;
      if (step >= kSize) seen_.reset();
      for (std::uint64_t k = 1; k <= step && step < kSize; ++k) seen_.reset((newest_ + k) % kSize);
      newest_ = number;
      none_ = false;
    } else if (newest_ - number >= kSize || seen_.test(number % kSize)) {
      return false;
    }
    seen_.set(number % kSize);
    return true;
  }

 private:
  std::bitset<kSize> seen_;
  std::uint32_t newest_ = 0;
  bool none_ = true;
};

/// An allowance that grows with time, up to a burst.
class RateLimit {
 public:
  RateLimit(double rate, double burst) : rate_(rate), burst_(burst), left_(burst) {}
  bool take(double amount, double now) {
    left_ = std::min(burst_, left_ + rate_ * std::max(0.0, now - last_));
    last_ = std::max(last_, now);
    if (left_ < amount) return false;
    left_ -= amount;
    return true;
  }

 private:
  double rate_, burst_, left_, last_ = 0.0;
};

struct MessageGuardOptions {
  std::uint32_t team = 0;          ///< Packets of others are not read.
  RobotId robots = 256;            ///< Senders' ids are below this.
  double messages_rate = 200.0;    ///< Of one sender [1/s] …
  double messages_burst = 1000.0;  ///< … and at once.
  double bytes_rate = 4e6;         ///< Of one sender [bytes/s] …
  double bytes_burst = 32e6;       ///< … and at once.
};

/// Opens packets. A robot that was started again has a higher incarnation and counts its messages
/// anew; what its earlier self sent comes too late.
class MessageGuard {
 public:
  explicit MessageGuard(RobotId self, MessageGuardOptions options = {})
      : self_(self), options_(options) {}

  /// The packet, opened, or nothing. `from` is the sender by the transport. The view lasts as
  /// long as the bytes.
  std::optional<Envelope> admit(RobotId from, std::span<const std::byte> bytes, double now) {
    if (from >= options_.robots || from == self_) return drop(MessageDrop::foreign);
    Sender& sender = senders_.try_emplace(from, options_).first->second;
    if (!sender.messages.take(1.0, now) ||
        !sender.bytes.take(static_cast<double>(bytes.size()), now))
      return drop(MessageDrop::flood);
    std::optional<Envelope> opened;
    drops_.reading([&] { opened = open_packet(bytes); });
    if (!opened) return std::nullopt;
    const Envelope& e = *opened;
    if (e.team != options_.team || e.sender != from) return drop(MessageDrop::foreign);
    if (sender.incarnation && e.incarnation < *sender.incarnation)
      return drop(MessageDrop::outdated);
    if (!sender.incarnation || e.incarnation > *sender.incarnation) {
      sender.incarnation = e.incarnation;
      sender.window = {};
    }
    if (!sender.window.accept(e.number)) return drop(MessageDrop::replayed);
    return opened;
  }
  const MessageDrops& drops() const { return drops_; }

 private:
  struct Sender {
    std::optional<std::uint32_t> incarnation;
    ReplayWindow window;
    RateLimit messages, bytes;
    explicit Sender(const MessageGuardOptions& o)
        : messages(o.messages_rate, o.messages_burst), bytes(o.bytes_rate, o.bytes_burst) {}
  };
  std::optional<Envelope> drop(MessageDrop why) {
    drops_.add(why);
    return std::nullopt;
  }

  RobotId self_;
  MessageGuardOptions options_;
  std::map<RobotId, Sender> senders_;
  MessageDrops drops_;
};
}  // namespace surfleet
