// SPDX-License-Identifier: MIT
/// @file
/// @brief Networks and events of distributed fleets, from files in the form of --config. Robots are
/// counted from 1, as in the names of results.
///
///     loss = 0.3                        killed = ["2 at 120"]
///     latency = 0.5                     vanished = ["5 at 60.5"]
///     bandwidth = 1e6                   restarted = ["2 at 180"]
///     partition = ["60 to 200: 1 2 | 3 4 5"]
///     cut = ["10 to 20: 1 > 3"]
///     line-of-sight = true
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/fleet/network_conditions.hpp>
#include <surfleet/simulation/fly_distributed.hpp>

#include "support/cli.hpp"

namespace surfleet::examples {
namespace fleet_files {
/// Words and marks of an entry, taken one after the other; what is wrong is told with all of it.
class Entry {
 public:
  Entry(const std::string& text, const std::string& form, int robots)
      : why_("\"" + text + "\": expected \"" + form + "\" with robots 1 to " +
             std::to_string(robots)),
        robots_(robots) {
    std::string apart;
    for (const char c : text)
      apart += c == ':' || c == '|' || c == '>' ? std::string{' ', c, ' '} : std::string{c};
    std::istringstream words(apart);
    for (std::string word; words >> word;) words_.push_back(word);
  }

  bool more() const { return next_ < words_.size(); }
  bool take(const std::string& mark) {
    const bool there = more() && words_[next_] == mark;
    next_ += there ? 1 : 0;
    return there;
  }
  void expect(const std::string& mark) { require(take(mark), why_); }
  void end() const { require(!more(), why_); }
  double time() {
    const auto t = parse_number<double>(word());
    require(t && *t >= 0.0 && std::isfinite(*t), why_);
    return *t;
  }
  RobotId robot() {
    const auto id = parse_number<int>(word());
    require(id && *id >= 1 && *id <= robots_, why_);
    return static_cast<RobotId>(*id - 1);
  }
  /// FROM to UNTIL:
  template <typename Span>
  void span(Span& of) {
    of.from = time();
    expect("to");
    of.until = time();
    expect(":");
  }

 private:
  const std::string& word() {
    require(more(), why_);
    return words_[next_++];
  }
  std::string why_;
  int robots_;
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

inline NetworkPartition partition(const std::string& text, int robots) {
  Entry e(text, "FROM to UNTIL: 1 2 | 3 ...", robots);
  NetworkPartition p;
  e.span(p);
  p.groups.emplace_back();
  while (e.more()) {
    if (e.take("|"))
      p.groups.emplace_back();
    else
      p.groups.back().push_back(e.robot());
  }
  return p;
}
inline OneWayCut cut(const std::string& text, int robots) {
  Entry e(text, "FROM to UNTIL: SENDER > RECEIVER", robots);
  OneWayCut c;
  e.span(c);
  c.sender = e.robot();
  e.expect(">");
  c.receiver = e.robot();
  e.end();
  return c;
}
inline FleetEvent event(const std::string& text, FleetEvent::Kind kind, int robots) {
  Entry e(text, "ROBOT at TIME", robots);
  FleetEvent event{.kind = kind};
  event.robot = e.robot();
  e.expect("at");
  event.time = e.time();
  e.end();
  return event;
}
/// Declares options and reads them of a file by `use`. Throws `Error` with its name before what is
/// wrong.
template <typename Declare>
void read(const std::string& option, const std::string& file, const char* expected,
          const Declare& use) {
  std::ifstream in(file);
  require(in.good(), option + " " + file + ": cannot be read; expected " + expected);
  cli::Options options("");
  try {
    use(options, in);
  } catch (const Error& e) {
    throw Error(option + " " + file + ": " + e.what());
  }
}
}  // namespace fleet_files

/// perfect, wifi, poor, or a file. Throws `Error`.
inline NetworkConditions network_conditions(const std::string& name, int robots,
                                            std::uint64_t seed) {
  const auto known = NetworkConditions::find(name);
  NetworkConditions n = known.value_or(NetworkConditions{});
  if (!known)
    fleet_files::read("--network", name, "perfect, wifi, poor or a file",
                      [&](cli::Options& o, std::istream& in) {
                        std::vector<std::string> partitions, cuts;
                        o.add("--loss", n.loss, "");
                        o.add("--duplication", n.duplication, "");
                        o.add("--reordering", n.reordering, "");
                        o.add("--latency", n.latency, "");
                        o.add("--jitter", n.jitter, "");
                        o.add("--bandwidth", n.bandwidth, "");
                        o.add("--range", n.range, "");
                        o.add_flag("--line-of-sight", n.line_of_sight, "");
                        o.add("--partition", partitions, "");
                        o.add("--cut", cuts, "");
                        o.parse_config(in);
                        for (const std::string& p : partitions)
                          n.partitions.push_back(fleet_files::partition(p, robots));
                        for (const std::string& c : cuts)
                          n.cuts.push_back(fleet_files::cut(c, robots));
                        n.check();
                      });
  n.seed = seed;
  return n;
}
/// Throws `Error`.
inline std::vector<FleetEvent> fleet_events(const std::string& file, int robots) {
  std::vector<FleetEvent> events;
  if (file.empty()) return events;
  fleet_files::read("--events", file, "a file", [&](cli::Options& o, std::istream& in) {
    std::vector<std::string> killed, vanished, restarted;
    o.add("--killed", killed, "");
    o.add("--vanished", vanished, "");
    o.add("--restarted", restarted, "");
    o.parse_config(in);
    for (const std::string& e : killed)
      events.push_back(fleet_files::event(e, FleetEvent::Kind::killed, robots));
    for (const std::string& e : vanished)
      events.push_back(fleet_files::event(e, FleetEvent::Kind::vanished, robots));
    for (const std::string& e : restarted)
      events.push_back(fleet_files::event(e, FleetEvent::Kind::restarted, robots));
  });
  return events;
}
}  // namespace surfleet::examples
