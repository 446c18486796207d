// SPDX-License-Identifier: MIT
/// @file
/// @brief A robot's state or route, relayed through a team, as bytes.
///
/// A body of kind `state`: the robots that its sender hears itself (number, then ids); number of
/// news; of each: robot, incarnation, number (varints); hops (uint8); age [s] (float32); then kind
/// (varint), idle, held, cornered, first, done, tilted (bits of a uint8), if done what it holds
/// (uint64), position and yaw (4 × float64), if tilted its pitch (float64), the path ahead (number,
/// 3 × float32 a point). A body of kind `route`: number of news, 65536 more if stops are tilted; of
/// each the same beginning, and then its stops (number); of each position and yaw (4 × float64), if
/// they are tilted its pitch (float64), and its targets (number, 3 zigzag varints a voxel).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/mapping/detail/hit_codec.hpp>
#include <surfleet/planning/plan.hpp>

namespace surfleet {
/// Which news, and how it came. Ages count from when things were said and heard: no clock is
/// compared with another's.
struct NewsHead {
  RobotId robot = 0;              ///< The robot whose state or route it is.
  std::uint32_t incarnation = 0;  ///< Of that robot.
  std::uint32_t number = 0;       ///< Later news have higher ones.
  std::uint8_t hops = 0;          ///< Robots that passed it on.
  double age = 0.0;               ///< [s]

  bool newer_than(const NewsHead& o) const {
    return std::tie(incarnation, number) > std::tie(o.incarnation, o.number);
  }
};
struct StateNews {
  NewsHead head;
  RobotState state;  ///< Without its route.
};
struct RouteNews {
  NewsHead head;
  Stops route;
};
struct StateMessage {
  std::set<RobotId> hears;  ///< The robots that its sender hears itself.
  std::vector<StateNews> news;
};

namespace detail {
/// Of a message; ahead of a robot; of a route, and targets of all its stops together.
inline constexpr std::uint64_t kMostNews = 256, kMostAhead = 1024, kMostStops = 1024,
                               kMostTargets = 1 << 16, kTilted = 1 << 16;
inline constexpr double kMostMetres = 1e7, kMostAge = 1e6, kMostPitch = 1.6;

class NewsReader {
 public:
  NewsReader(std::span<const std::byte> bytes, std::string what)
      : in_(bytes, what), what_(std::move(what)) {}
  std::uint64_t number(std::uint64_t most) {
    const std::uint64_t n = get_varint(in_, what_);
    if (n > most) throw beyond();
    return n;
  }
  /// How many follow, of which each has at least `bytes`.
  std::size_t count(std::uint64_t most, std::size_t bytes) {
    return count_of(number(most), most, bytes);
  }
  /// The same, and whether they have pitches.
  std::pair<std::size_t, bool> count_tilted(std::uint64_t most, std::size_t bytes) {
    const std::uint64_t n = number(kTilted + most);
    const bool tilted = n >= kTilted;
    return {count_of(tilted ? n - kTilted : n, most, bytes), tilted};
  }
  template <typename T>
  double real(double most) {
    const auto v = static_cast<double>(in_.get<T>());
    if (!(std::abs(v) <= most))
      throw MessageError(MessageDrop::out_of_bounds, what_ + ": a value beyond its bounds");
    return v;
  }
  template <typename T>
  Point3 point() {
    Point3 p;
    for (int k = 0; k < 3; ++k) p[k] = real<T>(kMostMetres);
    return p;
  }
  std::uint64_t digest() { return in_.get<std::uint64_t>(); }
  std::uint8_t byte() { return in_.get<std::uint8_t>(); }
  int coordinate() {
    const std::int64_t v = unzigzag(number(std::numeric_limits<std::uint32_t>::max()));
    if (v <= -(std::int64_t{1} << 30) || v >= std::int64_t{1} << 30)
      throw MessageError(MessageDrop::out_of_bounds, what_ + ": voxel outside the grid");
    return static_cast<int>(v);
  }
  Configuration configuration() {
    Configuration c;
    c.position = point<double>();
    c.yaw = real<double>(1e3);
    return c;
  }
  double pitch() { return real<double>(kMostPitch); }
  NewsHead head() {
    constexpr std::uint64_t kMax = std::numeric_limits<std::uint32_t>::max();
    NewsHead h;
    h.robot = static_cast<RobotId>(number(kMax));
    h.incarnation = static_cast<std::uint32_t>(number(kMax));
    h.number = static_cast<std::uint32_t>(number(kMax));
    h.hops = byte();
    h.age = real<float>(kMostAge);
    if (h.age < 0.0) throw Error(what_ + ": news of the future");
    return h;
  }
  void finish() const {
    if (in_.remaining() != 0) throw Error(what_ + ": bytes after its end");
  }

 private:
  std::size_t count_of(std::uint64_t n, std::uint64_t most, std::size_t bytes) const {
    if (n > most) throw beyond();
    if (n > in_.remaining() / bytes) throw Error(what_ + ": ends early");
    return static_cast<std::size_t>(n);
  }
  MessageError beyond() const {
    return {MessageDrop::beyond_limits, what_ + ": a number beyond its bounds"};
  }

  ByteReader in_;
  std::string what_;
};
inline void put_point(ByteWriter& out, const Point3& p) {
  for (int k = 0; k < 3; ++k) out.put(static_cast<float>(p[k]));
}
inline void put_configuration(ByteWriter& out, const Configuration& c) {
  for (int k = 0; k < 3; ++k) out.put(double{c.position[k]});
  out.put(c.yaw);
}
inline void put_head(ByteWriter& out, const NewsHead& h) {
  put_varint(out, h.robot);
  put_varint(out, h.incarnation);
  put_varint(out, h.number);
  out.put(h.hops);
  out.put(static_cast<float>(std::min(h.age, kMostAge)));
}
}  // namespace detail

inline Bytes encode_states(const StateMessage& message) {
  ByteWriter out;
  detail::put_varint(out, message.hears.size());
  for (const RobotId id : message.hears) detail::put_varint(out, id);
  detail::put_varint(out, message.news.size());
  for (const StateNews& n : message.news) {
    detail::put_head(out, n.head);
    detail::put_varint(out, n.state.kind);
    out.put(static_cast<std::uint8_t>(
        (n.state.idle ? 1 : 0) | (n.state.held ? 2 : 0) | (n.state.cornered ? 4 : 0) |
        (n.state.first ? 8 : 0) | (n.state.done ? 16 : 0) | (n.state.at.pitch != 0.0 ? 32 : 0)));
    if (n.state.done) out.put(n.state.holds);
    detail::put_configuration(out, n.state.at);
    if (n.state.at.pitch != 0.0) out.put(n.state.at.pitch);
    const std::size_t ahead = std::min<std::size_t>(n.state.ahead.size(), detail::kMostAhead);
    detail::put_varint(out, ahead);
    for (std::size_t i = 0; i < ahead; ++i) detail::put_point(out, n.state.ahead[i]);
  }
  return out.take();
}
/// Throws `Error` on anything but a sound message; what it says may still be none of the team's.
inline StateMessage decode_states(std::span<const std::byte> bytes) {
  detail::NewsReader in(bytes, "states");
  StateMessage message;
  for (std::size_t n = in.count(detail::kMostNews, 1); n > 0; --n)
    message.hears.insert(static_cast<RobotId>(in.number(std::numeric_limits<RobotId>::max())));
  message.news.resize(in.count(detail::kMostNews, 40));
  for (StateNews& n : message.news) {
    n.head = in.head();
    n.state.id = n.head.robot;
    n.state.kind = static_cast<RobotKindId>(in.number(std::numeric_limits<RobotKindId>::max()));
    const std::uint8_t flags = in.byte();
    n.state.idle = (flags & 1) != 0;
    n.state.held = (flags & 2) != 0;
    n.state.cornered = (flags & 4) != 0;
    n.state.first = (flags & 8) != 0;
    n.state.done = (flags & 16) != 0;
    if (n.state.done) n.state.holds = in.digest();
    n.state.at = in.configuration();
    if ((flags & 32) != 0) n.state.at.pitch = in.pitch();
    n.state.ahead.resize(in.count(detail::kMostAhead, 12));
    for (Point3& p : n.state.ahead) p = in.point<float>();
  }
  in.finish();
  return message;
}

inline Bytes encode_routes(const std::vector<RouteNews>& news) {
  ByteWriter out;
  const bool tilted = std::any_of(news.begin(), news.end(), [](const RouteNews& n) {
    return std::any_of(n.route.begin(), n.route.end(),
                       [](const Stop& s) { return s.configuration.pitch != 0.0; });
  });
  detail::put_varint(out, news.size() + (tilted ? detail::kTilted : 0));
  for (const RouteNews& n : news) {
    detail::put_head(out, n.head);
    const std::size_t stops = std::min<std::size_t>(n.route.size(), detail::kMostStops);
    detail::put_varint(out, stops);
    std::size_t left = detail::kMostTargets;
    for (std::size_t i = 0; i < stops; ++i) {
      const Stop& stop = n.route[i];
      detail::put_configuration(out, stop.configuration);
      if (tilted) out.put(stop.configuration.pitch);
      const std::size_t targets = std::min(stop.targets.size(), left);
      left -= targets;
      detail::put_varint(out, targets);
      for (std::size_t t = 0; t < targets; ++t)
        for (int k = 0; k < 3; ++k) detail::put_varint(out, detail::zigzag(stop.targets[t][k]));
    }
  }
  return out.take();
}
/// Throws `Error` on anything but a sound message; what it says may still be none of the team's.
inline std::vector<RouteNews> decode_routes(std::span<const std::byte> bytes) {
  detail::NewsReader in(bytes, "routes");
  const auto [count, tilted] = in.count_tilted(detail::kMostNews, 9);
  std::vector<RouteNews> news(count);
  for (RouteNews& n : news) {
    n.head = in.head();
    n.route.resize(in.count(detail::kMostStops, 33));
    std::uint64_t left = detail::kMostTargets;
    for (Stop& stop : n.route) {
      stop.configuration = in.configuration();
      if (tilted) stop.configuration.pitch = in.pitch();
      stop.targets.resize(in.count(left, 3));
      left -= stop.targets.size();
      for (VoxelIndex& v : stop.targets)
        for (int k = 0; k < 3; ++k) v[k] = in.coordinate();
    }
  }
  in.finish();
  return news;
}
}  // namespace surfleet
