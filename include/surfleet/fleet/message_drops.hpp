// SPDX-License-Identifier: MIT
/// @file
/// @brief Why messages between robots are not read, or what they say is not believed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <surfleet/core/error.hpp>

namespace surfleet {
enum class MessageDrop : std::uint8_t {
  truncated,          ///< Less than a packet.
  checksum,           ///< Damaged.
  malformed,          ///< No message of this version, or no body of its kind.
  foreign,            ///< Of another team, or of a sender that is none of it.
  replayed,           ///< Heard before, or too old to tell.
  flood,              ///< More than the sender's share.
  outdated,           ///< Of an earlier self of the sender.
  impostor,           ///< Says what another robot alone may say.
  unknown_kind,       ///< News of a kind of robot that is none of the team's.
  out_of_bounds,      ///< Places and values where no robot can be.
  jump,               ///< States that no motion explains.
  bomb,               ///< A patch larger than its box and images allow.
  out_of_reach,       ///< A patch of what its images cannot have shown.
  impossible_weight,  ///< A patch of weights that no such images give.
  conflict,           ///< Another content under a name that is held: the first stays.
  in_vain,            ///< Patches asked for that are not held.
  beyond_limits       ///< More robots, stops or patches than there may be.
};
inline constexpr std::size_t kMessageDrops = 17;
inline std::string_view name_of(MessageDrop why) {
  constexpr std::array<std::string_view, kMessageDrops> kNames{
      "truncated",    "checksum",          "malformed",    "foreign",       "replayed",     "flood",
      "outdated",     "impostor",          "unknown_kind", "out_of_bounds", "jump",         "bomb",
      "out_of_reach", "impossible_weight", "conflict",     "in_vain",       "beyond_limits"};
  return kNames[static_cast<std::size_t>(why)];
}

/// A message that is not read, and why.
class MessageError : public Error {
 public:
  MessageError(MessageDrop why, const std::string& text) : Error(text), why_(why) {}
  MessageDrop why() const { return why_; }

 private:
  MessageDrop why_;
};

/// How often what was dropped.
class MessageDrops {
 public:
  void add(MessageDrop why) { ++counts_[static_cast<std::size_t>(why)]; }
  MessageDrops& operator+=(const MessageDrops& o) {
    for (std::size_t k = 0; k < kMessageDrops; ++k) counts_[k] += o.counts_[k];
    return *this;
  }
  std::uint64_t operator[](MessageDrop why) const { return counts_[static_cast<std::size_t>(why)]; }
  std::uint64_t total() const {
    std::uint64_t n = 0;
    for (const std::uint64_t c : counts_) n += c;
    return n;
  }
  /// Runs `read` and counts what it throws: nothing that a message says ends a robot.
  template <typename Read>
  void reading(Read&& read) {
    try {
      read();
    } catch (const MessageError& e) {
      add(e.why());
    } catch (const Error&) {
      add(MessageDrop::malformed);
    }
  }

 private:
  std::array<std::uint64_t, kMessageDrops> counts_{};
};
}  // namespace surfleet
