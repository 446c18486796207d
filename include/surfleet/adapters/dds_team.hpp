// SPDX-License-Identifier: MIT
/// @file
/// @brief A robot's place in a team on DDS (Eclipse Cyclone DDS): its participant, which others are
/// there, and which may write what.
///
///     const auto team = std::make_shared<DdsTeam>(3, DdsOptions{.team = "alpha", .peers =
///     {"10.0.0.4"}}); DdsTransport air(team); for (const std::string& note : team->others()) …
///
/// A robot writes to partitions of its own, `TEAM/robot/I` and `TEAM/body/I`, its number counted
/// from 1, and is known by them. With a folder of keys, as `make_fleet_keys` makes it, which robot
/// writes where is proved, and what is written is encrypted; without, it is only said.
#pragma once

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/transport.hpp>

namespace surfleet {
struct DdsOptions {
  std::uint32_t domain = 0;                       ///< 0 to 230.
  std::string team = "surfleet";                  ///< Letters, digits, _ and -.
  std::vector<std::string> peers{"127.0.0.1"};    ///< Hosts that are asked for others.
  double lease = 3.0;                             ///< A robot silent for so long is gone [s].
  RobotId robots = 64;                            ///< Ids are below this.
  std::size_t most_bytes = std::size_t{1} << 24;  ///< Of a message; longer ones are not read.
  std::string note{};                ///< What others are told of this robot when they find it.
  std::filesystem::path security{};  ///< Folder of keys; empty: nothing is proved or encrypted.
  /// Share of packets that are not sent, to see what comes of it.
  double lost_packets = 0.0;
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
  require(options.lost_packets >= 0.0 && options.lost_packets <= 0.9,
          "dds: expected a share of lost packets of 0 to 0.9");
  require(!options.peers.empty(), "dds: expected a peer");
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
    require(host(peer), "peer \"" + peer + "\": expected a host or an address");
    xml += "<Peer address=\"" + peer + "\"/>";
  }
  xml +=
      "</Peers><LeaseDuration>" + std::to_string(options.lease) + "s</LeaseDuration></Discovery>";
  // Longer ones are not even put together; with room for what DDS itself adds.
  xml +=
      "<Internal><MaxSampleSize>" + std::to_string(options.most_bytes + 1024) + "B</MaxSampleSize>";
  if (options.lost_packets > 0.0)  // of a thousand
    xml += "<Test><XmitLossiness>" + std::to_string(std::lround(1000.0 * options.lost_packets)) +
           "</XmitLossiness></Test>";
  xml += "</Internal>";
  return xml + "</Domain></CycloneDDS>";
}

namespace detail {
struct DdsQosDeleter {
  void operator()(dds_qos_t* q) const { dds_delete_qos(q); }
};
using DdsQos = std::unique_ptr<dds_qos_t, DdsQosDeleter>;

/// The last that the library has logged, which else would go to stderr.
class DdsLog {
 public:
  static DdsLog& instance() {
    static DdsLog* const log = new DdsLog;  // the library may log until the process is gone
    return *log;
  }
  std::string last() {
    const std::lock_guard lock(mutex_);
    return last_;
  }

 private:
  DdsLog() {
    dds_set_log_sink(
        [](void* self, const dds_log_data_t* data) {
          auto& log = *static_cast<DdsLog*>(self);
          const std::lock_guard lock(log.mutex_);
          if (data->message != nullptr) log.last_ = data->message;
        },
        this);
  }
  std::mutex mutex_;
  std::string last_;
};

inline dds_entity_t dds_checked(dds_entity_t entity, const std::string& what) {
  if (entity >= 0) return entity;
  std::string why = DdsLog::instance().last();
  std::replace(why.begin(), why.end(), '\n', ' ');
  while (!why.empty() && std::isspace(static_cast<unsigned char>(why.back())) != 0) why.pop_back();
  throw Error("dds: no " + what + ": " + dds_strretcode(-entity) +
              (why.empty() ? "" : " (" + why + ")"));
}
/// Memory for `kept` messages of each of `robots`, and for a thousand names, which cost little: the
/// library bounds neither by itself.
inline void dds_bound(dds_qos_t* qos, RobotId robots, std::int32_t kept) {
  constexpr std::int32_t kNames = 1024;
  dds_qset_resource_limits(qos, static_cast<std::int32_t>(robots) * kept, kNames, kept);
}
/// A plugin of the library as a file, where distributions keep them; else its name alone.
inline std::string dds_plugin(const std::string& name) {
  namespace fs = std::filesystem;
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_participant), &info) == 0) return name;
  std::error_code ec;
  const fs::path folder = fs::path(info.dli_fname).parent_path();
  const std::string file = "lib" + name + ".so";
  if (fs::exists(folder / file, ec)) return (folder / file).string();
  for (const auto& entry : fs::directory_iterator(folder, ec))
    if (entry.path().filename().string().starts_with("libddsc") &&
        fs::exists(entry.path() / file, ec))
      return (entry.path() / file).string();
  return name;
}
}  // namespace detail

class DdsTeam {
 public:
  /// Throws `Error` if there is no network, for options out of range, and for keys that are
  /// missing, wrong or expired. All of a process share the configuration of the first of their
  /// domain.
  DdsTeam(RobotId self, DdsOptions options) : self_(self), options_(std::move(options)) {
    require(self < options_.robots, "dds: robot " + std::to_string(self + 1) +
                                        "; expected one of " + std::to_string(options_.robots));
    require(options_.domain <= 230, "dds: expected a domain of 0 to 230");
    const bool plain = !options_.team.empty() &&
                       std::all_of(options_.team.begin(), options_.team.end(), [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == '_' || c == '-';
                       });
    require(plain, "dds: team \"" + options_.team + "\"; expected letters, digits, _ or -");
    domain_ = shared_domain(options_);
    const detail::DdsQos qos(dds_create_qos());
    dds_qset_userdata(qos.get(), options_.note.data(), options_.note.size());
    if (!options_.security.empty()) secure(qos.get());
    participant_ = detail::dds_checked(dds_create_participant(options_.domain, qos.get(), nullptr),
                                       "participant");
    present_ = detail::dds_checked(
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
        "reader of participants");
    if (!options_.security.empty())
      writing_ = detail::dds_checked(
          dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
          "reader of writers");
  }
  ~DdsTeam() { dds_delete(participant_); }
  DdsTeam(const DdsTeam&) = delete;
  DdsTeam& operator=(const DdsTeam&) = delete;

  RobotId self() const { return self_; }
  const DdsOptions& options() const { return options_; }
  dds_entity_t participant() const { return participant_; }

  /// The notes of all others in the domain that are there now, of whatever team; with keys, of
  /// those alone that have proved their identity and write something.
  std::vector<std::string> others() const {
    dds_guid_t own{};
    dds_get_guid(participant_, &own);
    std::set<Guid> proved;
    if (writing_ > 0)
      each_present<dds_builtintopic_endpoint_t>(
          writing_, [&](const auto& writer) { proved.insert(guid(writer.participant_key)); });
    std::vector<std::string> notes;
    each_present<dds_builtintopic_participant_t>(present_, [&](const auto& other) {
      if (guid(other.key) == guid(own) || (writing_ > 0 && !proved.contains(guid(other.key))))
        return;
      void* data = nullptr;
      std::size_t size = 0;
      if (!dds_qget_userdata(other.qos, &data, &size)) return;
      notes.emplace_back(static_cast<const char*>(data), size);
      dds_free(data);
    });
    return notes;
  }

  /// Quality with the partition that this robot writes to, or with those of all robots.
  detail::DdsQos own_partition(const std::string& room) const {
    return partition(prefix(room) + std::to_string(self_ + 1));
  }
  detail::DdsQos all_partitions(const std::string& room) const {
    return partition(prefix(room) + "*");
  }
  /// The robot whose partition a writer writes to; nothing for none of our team.
  std::optional<RobotId> robot_of(dds_entity_t reader, dds_instance_handle_t writer,
                                  const std::string& room) {
    if (const auto known = writer_robots_.find(writer); known != writer_robots_.end())
      return known->second;
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer);
    if (endpoint == nullptr) return std::nullopt;
    std::optional<RobotId> robot;
    std::uint32_t count = 0;
    char** names = nullptr;
    if (dds_qget_partition(endpoint->qos, &count, &names)) {
      if (count == 1 && std::string_view(names[0]).starts_with(prefix(room)))
        if (const auto number =
                parse_number<std::uint32_t>(std::string(names[0]).substr(prefix(room).size()));
            number && *number >= 1 && *number <= options_.robots)
          robot = *number - 1;
      for (std::uint32_t i = 0; i < count; ++i) dds_free(names[i]);
      dds_free(names);
    }
    dds_builtintopic_free_endpoint(endpoint);
    if (writer_robots_.size() >= kMostWriters) writer_robots_.clear();
    return writer_robots_[writer] = robot;
  }

 private:
  using Guid = std::array<std::uint8_t, sizeof(dds_guid_t)>;
  static Guid guid(const dds_guid_t& g) {
    Guid bytes;
    std::copy(std::begin(g.v), std::end(g.v), bytes.begin());
    return bytes;
  }
  /// What a reader of the library's own topics says of all that are there.
  template <typename Topic, typename Use>
  static void each_present(dds_entity_t reader, const Use& use) {
    constexpr std::size_t kMost = 1024;
    std::vector<void*> samples(kMost, nullptr);  // null: lent by the reader
    std::vector<dds_sample_info_t> infos(kMost);
    const dds_return_t n =
        dds_read_mask(reader, samples.data(), infos.data(), kMost, kMost,
                      DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
    if (n <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
      if (infos[i].valid_data) use(*static_cast<const Topic*>(samples[i]));
    dds_return_loan(reader, samples.data(), n);
  }
  std::string prefix(const std::string& room) const { return options_.team + "/" + room + "/"; }
  static detail::DdsQos partition(const std::string& name) {
    detail::DdsQos qos(dds_create_qos());
    const char* names[] = {name.c_str()};
    dds_qset_partition(qos.get(), 1, names);
    return qos;
  }
  void secure(dds_qos_t* qos) const {
    const std::filesystem::path all = std::filesystem::absolute(options_.security);
    const std::filesystem::path own = all / ("robot_" + std::to_string(self_ + 1));
    const auto file = [&](const char* property, const std::filesystem::path& path) {
      std::error_code ec;
      require(std::filesystem::is_regular_file(path, ec),
              path.string() + ": not there; expected a folder of keys with this robot's own");
      dds_qset_prop(qos, property, ("file:" + path.string()).c_str());
    };
    file("dds.sec.auth.identity_ca", all / "identity_ca.pem");
    file("dds.sec.auth.identity_certificate", own / "certificate.pem");
    file("dds.sec.auth.private_key", own / "key.pem");
    file("dds.sec.access.permissions_ca", all / "permissions_ca.pem");
    file("dds.sec.access.governance", all / "governance.p7s");
    file("dds.sec.access.permissions", own / "permissions.p7s");
    const auto plugin = [&](const std::string& role, const std::string& library,
                            const std::string& name) {
      const std::string key = "dds.sec." + role + ".library.";
      dds_qset_prop(qos, (key + "path").c_str(), detail::dds_plugin(library).c_str());
      dds_qset_prop(qos, (key + "init").c_str(), ("init_" + name).c_str());
      dds_qset_prop(qos, (key + "finalize").c_str(), ("finalize_" + name).c_str());
    };
    plugin("auth", "dds_security_auth", "authentication");
    plugin("crypto", "dds_security_crypto", "crypto");
    plugin("access", "dds_security_ac", "access_control");
  }
  /// The domain with its configuration, for as long as it is in use.
  static std::shared_ptr<dds_entity_t> shared_domain(const DdsOptions& options) {
    static std::mutex mutex;
    static std::map<std::uint32_t, std::weak_ptr<dds_entity_t>> domains;
    const std::lock_guard lock(mutex);
    if (auto known = domains[options.domain].lock()) return known;
    detail::DdsLog::instance();
    const dds_entity_t made = detail::dds_checked(
        dds_create_domain(options.domain, dds_configuration(options).c_str()), "domain");
    std::shared_ptr<dds_entity_t> domain(new dds_entity_t(made), [](const dds_entity_t* d) {
      dds_delete(*d);
      delete d;
    });
    domains[options.domain] = domain;
    return domain;
  }

  static constexpr std::size_t kMostWriters = 4096;  ///< That are kept in mind.

  RobotId self_;
  DdsOptions options_;
  std::shared_ptr<dds_entity_t> domain_;
  dds_entity_t participant_ = 0, present_ = 0, writing_ = 0;
  std::map<dds_instance_handle_t, std::optional<RobotId>> writer_robots_;
};
}  // namespace surfleet
