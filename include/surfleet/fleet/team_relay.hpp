// SPDX-License-Identifier: MIT
/// @file
/// @brief Which robots are of the team, where they are and what they do, heard from themselves or
/// from those between [000 §4.3].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <surfleet/core/types.hpp>
#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/robot_news.hpp>

namespace surfleet {
struct TeamRelayOptions {
  double state_period = 0.25;  ///< Between states while on a route [s].
  double idle_period = 1.0;    ///< The same without anything to do: it stays of the team [s].
  double route_period = 2.0;   ///< Between routes that do not change [s].
  double silence = 3.0;        ///< Mates are those whose state is no older [s].
  std::uint8_t hops = 8;       ///< News that so many have passed on go no further.
  RobotId robots = 256;        ///< Ids are below this.
  RobotKindId kinds = 1;       ///< The same of the kinds of robots that plans know.
  Box3 bounds{};               ///< Where robots and their stops may be [m]; empty: anywhere.
  double speed = 20.0;         ///< No robot is faster [m/s] …
  double slack = 20.0;         ///< … nor found farther than this from where it may be [m].
};

/// One robot's part: says its own state and route, and passes on what it has heard of a robot that
/// one of those it hears does not hear itself. Where all hear all, nothing is passed
/// on; where a chain is the only link, news travel along it and grow older. A robot whose clock is
/// wrong is as good as any.
class TeamRelay {
 public:
  explicit TeamRelay(RobotId self, std::uint32_t incarnation = 0, TeamRelayOptions options = {})
      : self_(self), incarnation_(incarnation), options_(options), within_(options.bounds) {
    if (within_.isEmpty()) return;
    within_.min().array() -= options.slack;
    within_.max().array() += options.slack;
  }

  /// Our own state, at any time; its route goes out when it differs from the last.
  void set_own(const RobotState& state) { own_ = state; }

  /// A message of kind `state` or `route`. Never throws on what it says.
  void hear(const Envelope& message, double now) {
    if (message.sender == self_ || message.sender >= options_.robots) return;
    drops_.reading([&] {
      if (message.kind == MessageKind::state) hear_states(message, now);
      if (message.kind == MessageKind::route) hear_routes(message, now);
    });
  }
  /// What there is to say now.
  std::vector<Outgoing> speak(double now) {
    std::vector<Outgoing> out;
    if (now >= next_state_) {
      StateMessage message;
      for (const auto& [id, mate] : mates_)
        if (hears(mate, now)) message.hears.insert(id);
      if (own_) {
        StateNews own{{self_, incarnation_, states_said_++, 0, 0.0}, *own_};
        own.state.route.clear();
        message.news.push_back(std::move(own));
      }
      for (auto& [id, mate] : mates_)
        if (mate.state && mate.state_fresh && is_wanted(id, mate, mate.state->head, now)) {
          mate.state_fresh = false;
          message.news.push_back(
              {passed_on(mate.state->head, mate.state_heard, now), mate.state->state});
          ++relayed_;
        }
      if (!message.news.empty())
        out.push_back({MessageKind::state, std::nullopt, encode_states(message)});
      const bool idle = !own_ || own_->idle;
      next_state_ = now + (idle ? options_.idle_period : options_.state_period);
    }
    std::vector<RouteNews> routes;
    if (own_ && (now >= next_route_ || !said_route_ || !same(*said_route_, own_->route))) {
      routes.push_back({{self_, incarnation_, routes_said_++, 0, 0.0}, own_->route});
      said_route_ = own_->route;
      next_route_ = now + options_.route_period;
    }
    for (auto& [id, mate] : mates_)
      if (mate.route && mate.route_fresh && is_wanted(id, mate, mate.route->head, now)) {
        mate.route_fresh = false;
        routes.push_back({passed_on(mate.route->head, mate.route_heard, now), mate.route->route});
        ++relayed_;
      }
    if (!routes.empty()) out.push_back({MessageKind::route, std::nullopt, encode_routes(routes)});
    return out;
  }

  /// The mates whose state is no older than `silence`, by ascending id, with their routes and ages.
  std::vector<RobotState> mates(double now) const { return mates(now, options_.silence); }
  /// The same of those whose state is no older than `most` [s].
  std::vector<RobotState> mates(double now, double most) const {
    std::vector<RobotState> team;
    for (const auto& [id, mate] : mates_)
      if (const std::optional<double> age = age_of(mate, now); age && *age <= most)
        team.push_back(told(mate, *age));
    return team;
  }
  /// The last that was heard of a robot, however long ago.
  std::optional<RobotState> last_of(RobotId robot, double now) const {
    const auto it = mates_.find(robot);
    if (it == mates_.end() || !it->second.state) return std::nullopt;
    return told(it->second, *age_of(it->second, now));
  }
  /// Robots that passed on the last state of a mate; nothing if there is none.
  std::optional<int> hops_of(RobotId robot) const {
    const auto it = mates_.find(robot);
    if (it == mates_.end() || !it->second.state) return std::nullopt;
    return it->second.state->head.hops;
  }
  /// Whether a mate can be taken at its word: what comes from far is older.
  bool is_current(const RobotState& mate) const {
    return mate.age <= options_.silence * (1 + hops_of(mate.id).value_or(0));
  }
  /// Whether no mate is heard: the single architecture.
  bool alone(double now) const { return mates(now).empty(); }
  /// What was not believed: messages that could not be read, and single news.
  const MessageDrops& drops() const { return drops_; }
  std::uint64_t relayed() const { return relayed_; }  ///< News of others that were passed on.

 private:
  struct Mate {
    std::optional<StateNews> state;
    std::optional<RouteNews> route;
    std::optional<NewsHead> own_state, own_route;              // the last from itself
    double state_heard = 0.0, route_heard = 0.0;               // [s]
    bool state_fresh = false, route_fresh = false;             // not passed on yet
    double direct = -std::numeric_limits<double>::infinity();  // last heard itself [s]
    std::set<RobotId> hears;
  };

  static bool same(const Stops& a, const Stops& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Stop& p, const Stop& q) {
      return p.configuration == q.configuration && p.targets == q.targets;
    });
  }
  bool hears(const Mate& mate, double now) const { return now - mate.direct <= options_.silence; }
  std::optional<double> age_of(const Mate& mate, double now) const {
    if (!mate.state) return std::nullopt;
    return mate.state->head.age + (now - mate.state_heard);
  }
  static RobotState told(const Mate& mate, double age) {
    RobotState state = mate.state->state;
    // Not an earlier self's, which is all that is heard of some time after a new start.
    if (mate.route && mate.route->head.incarnation == mate.state->head.incarnation)
      state.route = mate.route->route;
    state.age = age;
    return state;
  }
  static NewsHead passed_on(NewsHead head, double heard, double now) {
    head.hops = static_cast<std::uint8_t>(head.hops + 1);
    head.age += now - heard;
    return head;
  }
  /// Whether one of those we hear does not hear that robot itself.
  bool is_wanted(RobotId about, const Mate& mate, const NewsHead& head, double now) const {
    if (head.hops >= options_.hops || now - mate.state_heard > options_.silence) return false;
    for (const auto& [id, other] : mates_)
      if (id != about && hears(other, now) && !other.hears.contains(about)) return true;
    return false;
  }
  /// The mate that news are of, if it can be and they are newer than what is known of that kind. A
  /// mate's own word counts for more than that of others: what they tell may not run ahead of it
  /// while it is heard, and gives way to it when it is heard again.
  template <typename News>
  Mate* mate_of_news(const NewsHead& head, const Envelope& message, double now,
                     std::optional<News> Mate::*known, std::optional<NewsHead> Mate::*own) {
    const auto drop = [this](MessageDrop why) {
      drops_.add(why);
      return nullptr;
    };
    if (head.robot >= options_.robots || head.hops > options_.hops)
      return drop(MessageDrop::beyond_limits);
    // No robot speaks for itself through others, nor for others as itself.
    const bool itself = head.robot == message.sender;
    if ((head.hops == 0) != itself || (itself && head.incarnation != message.incarnation))
      return drop(MessageDrop::impostor);
    if (head.robot == self_) return nullptr;
    Mate& mate = mates_[head.robot];
    const std::optional<NewsHead>& said = mate.*own;
    const auto runs_ahead = [&](const NewsHead& told) {
      return said && (told.incarnation > said->incarnation || told.number > said->number + kAhead);
    };
    if (!itself && hears(mate, now) && runs_ahead(head)) return drop(MessageDrop::impostor);
    if (itself && mate.*known && (mate.*known)->head.hops > 0 &&
        (!said || (head.newer_than(*said) && runs_ahead((mate.*known)->head))))
      (mate.*known).reset();
    if (mate.*known && !head.newer_than((mate.*known)->head)) return nullptr;
    if (itself) mate.*own = head;
    return &mate;
  }
  bool may_be(const Point3& p) const { return within_.isEmpty() || within_.contains(p); }
  /// Whether a plan could be made with it: of a kind that is known, and where robots may be.
  bool is_possible(const RobotState& state) {
    if (state.kind >= options_.kinds) {
      drops_.add(MessageDrop::unknown_kind);
      return false;
    }
    const bool there =
        may_be(state.at.position) && std::all_of(state.ahead.begin(), state.ahead.end(),
                                                 [this](const Point3& p) { return may_be(p); });
    if (!there) drops_.add(MessageDrop::out_of_bounds);
    return there;
  }
  bool is_possible(const Stops& route) {
    const bool there = std::all_of(route.begin(), route.end(), [this](const Stop& stop) {
      return may_be(stop.configuration.position);
    });
    if (!there) drops_.add(MessageDrop::out_of_bounds);
    return there;
  }
  void hear_states(const Envelope& message, double now) {
    StateMessage said = decode_states(message.body);
    Mate& sender = mates_[message.sender];
    sender.direct = now;
    sender.hears = std::move(said.hears);
    for (StateNews& n : said.news) {
      Mate* const known = mate_of_news(n.head, message, now, &Mate::state, &Mate::own_state);
      if (!known || !is_possible(n.state)) continue;
      Mate& mate = *known;
      if (mate.state && mate.state->head.incarnation == n.head.incarnation) {
        const double between = std::max(0.0, *age_of(mate, now) - n.head.age);
        const double moved = (n.state.at.position - mate.state->state.at.position).norm();
        if (moved > options_.slack + options_.speed * (between + n.head.age)) {
          drops_.add(MessageDrop::jump);
          continue;
        }
      }
      mate.state = std::move(n);
      mate.state_heard = now;
      mate.state_fresh = true;
    }
  }
  void hear_routes(const Envelope& message, double now) {
    for (RouteNews& n : decode_routes(message.body)) {
      Mate* const mate = mate_of_news(n.head, message, now, &Mate::route, &Mate::own_route);
      if (!mate || !is_possible(n.route)) continue;
      mate->route = std::move(n);
      mate->route_heard = now;
      mate->route_fresh = true;
    }
  }

  /// News of a mate that is heard itself that may be lost before others tell later ones.
  static constexpr std::uint32_t kAhead = 64;

  RobotId self_;
  std::uint32_t incarnation_;
  TeamRelayOptions options_;
  Box3 within_;  // bounds and slack
  std::optional<RobotState> own_;
  std::optional<Stops> said_route_;
  std::map<RobotId, Mate> mates_;
  std::uint32_t states_said_ = 0, routes_said_ = 0;
  double next_state_ = -std::numeric_limits<double>::infinity(), next_route_ = next_state_;
  MessageDrops drops_;
  std::uint64_t relayed_ = 0;
};
}  // namespace surfleet
