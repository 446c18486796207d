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
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/fleet/packet.hpp>

namespace surfleet {
struct DdsOptions {
  std::uint32_t domain = 0;
  std::string team = "surfleet";                  ///< Letters, digits, _ and -.
  std::vector<std::string> peers{"127.0.0.1"};    ///< Hosts that are asked for others.
  double lease = 3.0;                             ///< Who is silent for so long is gone [s].
  RobotId robots = 64;                            ///< Ids are below this.
  std::size_t most_bytes = std::size_t{1} << 24;  ///< Of a message; longer ones are not read.
};

/// What Cyclone DDS is to be told: no multicast, those peers, room for 120 processes a host. Throws
/// `Error` for a peer that is no host.
inline std::string dds_configuration(const DdsOptions& options) {
  const auto host = [](const std::string& name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '.' || c == ':' || c == '-' || c == '_';
    });
  };
  require(options.lease > 0.0 && std::isfinite(options.lease), "dds: expected a positive lease");
  const bool local = std::all_of(options.peers.begin(), options.peers.end(), [](const auto& p) {
    return p == "127.0.0.1" || p == "localhost";
  });
  std::string xml = "<CycloneDDS><Domain Id=\"any\"><General>";
  if (local)
    xml += "<Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"false\"/></Interfaces>";
  xml +=
      "<AllowMulticast>false</AllowMulticast></General><Discovery>"
      "<ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex><Peers>";
  for (const std::string& peer : options.peers) {
    require(host(peer), "dds: peer \"" + peer + "\"; expected a host or an address");
    xml += "<Peer address=\"" + peer + "\"/>";
  }
  return xml + "</Peers><LeaseDuration>" + std::to_string(options.lease) +
         "s</LeaseDuration></Discovery></Domain></CycloneDDS>";
}

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

  /// Throws `Error` if there is no network, or for options out of range. All transports of a
  /// process share the configuration of the first of their domain.
  DdsTransport(RobotId self, DdsOptions options) : self_(self), options_(std::move(options)) {
    require(self < options_.robots, "dds: robot " + std::to_string(self) + "; expected one of " +
                                        std::to_string(options_.robots));
    const bool plain = !options_.team.empty() &&
                       std::all_of(options_.team.begin(), options_.team.end(), [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == '_' || c == '-';
                       });
    require(plain, "dds: team \"" + options_.team + "\"; expected letters, digits, _ or -");
    domain_ = shared_domain(options_);
    participant_ =
        checked(dds_create_participant(options_.domain, nullptr, nullptr), "participant");
    const Qos all = partition(options_.team + "/robot/*");
    const Qos own = partition(prefix() + std::to_string(self_));
    const dds_entity_t subscriber =
        checked(dds_create_subscriber(participant_, all.get(), nullptr), "subscriber");
    const dds_entity_t publisher =
        checked(dds_create_publisher(participant_, own.get(), nullptr), "publisher");
    for (std::size_t k = 0; k < kMessageKinds; ++k) {
      const Qos qos = quality(static_cast<MessageKind>(k));
      const dds_entity_t topic =
          checked(dds_create_topic(participant_, &surfleet_dds_FleetMessage_desc, kTopics[k],
                                   qos.get(), nullptr),
                  "topic");
      readers_[k] = checked(dds_create_reader(subscriber, topic, qos.get(), nullptr), "reader");
      writers_[k] = checked(dds_create_writer(publisher, topic, qos.get(), nullptr), "writer");
    }
  }
  ~DdsTransport() {
    if (participant_ > 0) dds_delete(participant_);
  }
  DdsTransport(const DdsTransport&) = delete;
  DdsTransport& operator=(const DdsTransport&) = delete;

  /// Throws `Error` for a sender that is not this robot.
  void send(Message<Packet> message) {
    require(message.from == self_, "dds: a robot speaks for itself alone");
    const auto k = static_cast<std::size_t>(message.payload.kind);
    const std::size_t size = byte_size(message.payload);
    surfleet_dds_FleetMessage m{};
    m.sender = self_;
    m.receiver = message.to.value_or(self_);
    m.number = sent_[k]++;
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
    require(robot == self_, "dds: a robot hears for itself alone");
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
  static constexpr std::uint32_t kKeptPatches = 16;

  struct QosDeleter {
    void operator()(dds_qos_t* q) const { dds_delete_qos(q); }
  };
  using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

  static dds_entity_t checked(dds_entity_t entity, const char* what) {
    require(entity >= 0, std::string("dds: no ") + what + ": " + dds_strretcode(-entity));
    return entity;
  }
  /// States are worth only their newest, digests reach who comes late, patches come once: who was
  /// away asks for them.
  static Qos quality(MessageKind kind) {
    Qos qos(dds_create_qos());
    const bool state = kind == MessageKind::state, digest = kind == MessageKind::digest;
    dds_qset_reliability(qos.get(), state ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                         DDS_MSECS(100));
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST,
                     state || digest ? 1 : static_cast<std::int32_t>(kKeptPatches));
    dds_qset_durability(qos.get(),
                        digest ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
    return qos;
  }
  static Qos partition(const std::string& name) {
    Qos qos(dds_create_qos());
    const char* names[] = {name.c_str()};
    dds_qset_partition(qos.get(), 1, names);
    return qos;
  }
  /// The domain with its configuration, for as long as anybody uses it.
  static std::shared_ptr<dds_entity_t> shared_domain(const DdsOptions& options) {
    static std::mutex mutex;
    static std::map<std::uint32_t, std::weak_ptr<dds_entity_t>> domains;
    const std::lock_guard lock(mutex);
    if (auto known = domains[options.domain].lock()) return known;
    const dds_entity_t made =
        checked(dds_create_domain(options.domain, dds_configuration(options).c_str()), "domain");
    std::shared_ptr<dds_entity_t> domain(new dds_entity_t(made), [](const dds_entity_t* d) {
      dds_delete(*d);
      delete d;
    });
    domains[options.domain] = domain;
    return domain;
  }
  std::string prefix() const { return options_.team + "/robot/"; }

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
    if (m.sender >= options_.robots || m.bytes._length > options_.most_bytes ||
        !std::isfinite(m.time)) {
      ++counts_.unreadable;
      return;
    }
    if (m.sender == self_ || m.sender != robot_of(reader, info.publication_handle)) {
      ++counts_.impostors;
      return;
    }
    if (m.receiver != m.sender && m.receiver != self_) return;
    const auto* first = reinterpret_cast<const std::byte*>(m.bytes._buffer);
    Message<Packet> message;
    message.time = m.time;
    message.from = m.sender;
    message.sequence = m.number;
    if (m.receiver != m.sender) message.to = self_;
    message.payload = {kind, std::make_shared<const Bytes>(first, first + m.bytes._length)};
    arrived.push_back(std::move(message));
    ++counts_.received;
  }
  /// The robot whose partition a writer writes to; nothing for none of our team.
  std::optional<RobotId> robot_of(dds_entity_t reader, dds_instance_handle_t writer) {
    if (const auto known = writer_robots_.find(writer); known != writer_robots_.end())
      return known->second;
    std::optional<RobotId> robot;
    if (dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer)) {
      std::uint32_t count = 0;
      char** names = nullptr;
      if (dds_qget_partition(endpoint->qos, &count, &names)) {
        if (count == 1 && std::string(names[0]).starts_with(prefix()))
          if (const auto id =
                  parse_number<std::uint32_t>(std::string(names[0]).substr(prefix().size())))
            robot = *id;
        for (std::uint32_t i = 0; i < count; ++i) dds_free(names[i]);
        dds_free(names);
      }
      dds_builtintopic_free_endpoint(endpoint);
      writer_robots_[writer] = robot;
    }
    return robot;
  }

  RobotId self_;
  DdsOptions options_;
  std::shared_ptr<dds_entity_t> domain_;
  dds_entity_t participant_ = 0;
  std::array<dds_entity_t, kMessageKinds> readers_{}, writers_{};
  std::array<std::uint32_t, kMessageKinds> sent_{};
  std::map<dds_instance_handle_t, std::optional<RobotId>> writer_robots_;
  Counts counts_;
};
static_assert(Transport<DdsTransport>);
}  // namespace surfleet
