// SPDX-License-Identifier: MIT
/// @file
/// @brief Messages between robots over DDS (Eclipse Cyclone DDS), a process or a host each.
///
///     DdsTransport air(3, {.team = "alpha", .peers = {"10.0.0.4", "10.0.0.5"}});
///     air.send({.time = now, .from = 3, .payload = seal(envelope)});
///     for (const Message<Packet>& m : air.receive(3)) …
#pragma once

#include <dds/dds.h>
#include <surfleet/adapters/fleet_message.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/adapters/dds_team.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/fleet/packet.hpp>

namespace surfleet {
/// One robot's end of a team's network. Models `Transport` for that robot alone. A message counts
/// only if it comes from the partition of the robot that it names as its sender.
class DdsTransport {
 public:
  using Payload = Packet;
  struct Counts {
    std::array<std::uint64_t, kMessageKinds> bytes_sent{};
    std::uint64_t received = 0;
    std::uint64_t impostors = 0;  ///< Messages from another robot's partition.
    std::uint64_t unreadable = 0;
  };

  /// Throws `Error` if there is no room for more.
  explicit DdsTransport(std::shared_ptr<DdsTeam> team) : team_(std::move(team)) {
    const dds_entity_t of = team_->participant();
    const detail::DdsQos all = team_->all_partitions(kRoom), own = team_->own_partition(kRoom);
    const dds_entity_t subscriber =
        detail::dds_checked(dds_create_subscriber(of, all.get(), nullptr), "subscriber");
    const dds_entity_t publisher =
        detail::dds_checked(dds_create_publisher(of, own.get(), nullptr), "publisher");
    for (std::size_t k = 0; k < kMessageKinds; ++k) {
      const detail::DdsQos qos = quality(static_cast<MessageKind>(k), team_->options().robots);
      const dds_entity_t topic = detail::dds_checked(
          dds_create_topic(of, &surfleet_dds_FleetMessage_desc, kTopics[k], qos.get(), nullptr),
          "topic");
      readers_[k] =
          detail::dds_checked(dds_create_reader(subscriber, topic, qos.get(), nullptr), "reader");
      writers_[k] =
          detail::dds_checked(dds_create_writer(publisher, topic, qos.get(), nullptr), "writer");
    }
  }
  /// A robot's place in its team and this end of its network at once; throws as both do.
  DdsTransport(RobotId self, DdsOptions options)
      : DdsTransport(std::make_shared<DdsTeam>(self, std::move(options))) {}

  /// Throws `Error` for a sender that is not this robot.
  void send(Message<Packet> message) {
    require(message.from == team_->self(), "dds: a robot speaks for itself alone");
    const auto k = static_cast<std::size_t>(message.payload.kind);
    const std::size_t size = byte_size(message.payload);
    surfleet_dds_FleetMessage m{};
    m.sender = team_->self();
    m.receiver = message.to.value_or(team_->self());
    m.number = sent_++;
    m.time = message.time;
    m.bytes._length = m.bytes._maximum = static_cast<std::uint32_t>(size);
    // Written, not changed: the C interface has no const.
    m.bytes._buffer = size == 0 ? nullptr
                                : const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(
                                      message.payload.bytes->data()));
    // What does not go out now is the network's loss, and the robots' part to make good.
    if (dds_write(writers_[k], &m) == DDS_RETCODE_OK) counts_.bytes_sent[k] += size;
  }
  /// Throws `Error` for another robot than this.
  std::vector<Message<Packet>> receive(RobotId robot) {
    require(robot == team_->self(), "dds: a robot hears for itself alone");
    std::vector<Message<Packet>> arrived;
    for (std::size_t k = 0; k < kMessageKinds; ++k) take(static_cast<MessageKind>(k), arrived);
    std::stable_sort(
        arrived.begin(), arrived.end(), [](const Message<Packet>& a, const Message<Packet>& b) {
          return std::tie(a.time, a.from, a.sequence) < std::tie(b.time, b.from, b.sequence);
        });
    return arrived;
  }
  /// How many others listen.
  std::size_t listeners() const {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writers_[0], &status);
    return status.current_count;
  }
  const Counts& counts() const { return counts_; }

 private:
  static constexpr std::array<const char*, kMessageKinds> kTopics{
      "surfleet_state", "surfleet_route", "surfleet_digest", "surfleet_request", "surfleet_patch"};
  static constexpr const char* kRoom = "robot";
  static constexpr std::int32_t kKept = 16;  ///< Routes, requests, patches of a sender.

  /// Of states only the newest counts, digests reach robots that come late, patches come once: a
  /// robot that was away asks for them. For readers and writers.
  static detail::DdsQos quality(MessageKind kind, RobotId robots) {
    detail::DdsQos qos(dds_create_qos());
    const bool state = kind == MessageKind::state, digest = kind == MessageKind::digest;
    // States are not sent again; all else is, and holds its writer up for no more than this.
    dds_qset_reliability(qos.get(), state ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                         DDS_MSECS(100));
    // So many of each sender wait to be read, or to be acknowledged.
    const std::int32_t kept = state || digest ? 1 : kKept;
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kept);
    // Whoever comes late is given the last digest, and nothing else.
    dds_qset_durability(qos.get(),
                        digest ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    // Nor do more senders than the team has robots take up memory, whatever they call themselves.
    detail::dds_bound(qos.get(), robots, kept);
    // A robot does not hear itself.
    dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
    return qos;
  }
  void take(MessageKind kind, std::vector<Message<Packet>>& arrived) {
    constexpr std::size_t kAtOnce = 32;
    const dds_entity_t reader = readers_[static_cast<std::size_t>(kind)];
    for (;;) {
      std::array<void*, kAtOnce> samples{};  // null: lent by the reader
      std::array<dds_sample_info_t, kAtOnce> infos{};
      const dds_return_t n = dds_take(reader, samples.data(), infos.data(), kAtOnce, kAtOnce);
      if (n <= 0) return;
      for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
        if (infos[i].valid_data)
          read(kind, reader, infos[i], *static_cast<surfleet_dds_FleetMessage*>(samples[i]),
               arrived);
      dds_return_loan(reader, samples.data(), n);
      if (static_cast<std::size_t>(n) < kAtOnce) return;
    }
  }
  void read(MessageKind kind, dds_entity_t reader, const dds_sample_info_t& info,
            const surfleet_dds_FleetMessage& m, std::vector<Message<Packet>>& arrived) {
    if (m.sender >= team_->options().robots || m.bytes._length > team_->options().most_bytes ||
        !std::isfinite(m.time)) {
      ++counts_.unreadable;
      return;
    }
    if (m.sender == team_->self() ||
        m.sender != team_->robot_of(reader, info.publication_handle, kRoom)) {
      ++counts_.impostors;
      return;
    }
    if (m.receiver != m.sender && m.receiver != team_->self()) return;
    const auto* first = reinterpret_cast<const std::byte*>(m.bytes._buffer);
    Message<Packet> message;
    message.time = m.time;
    message.from = m.sender;
    message.sequence = m.number;
    if (m.receiver != m.sender) message.to = team_->self();
    message.payload = {kind, std::make_shared<const Bytes>(first, first + m.bytes._length)};
    arrived.push_back(std::move(message));
    ++counts_.received;
  }
  std::shared_ptr<DdsTeam> team_;
  std::array<dds_entity_t, kMessageKinds> readers_{}, writers_{};
  std::uint32_t sent_ = 0;  // of all kinds: what is sent first comes first
  Counts counts_;
};
static_assert(Transport<DdsTransport>);
}  // namespace surfleet
