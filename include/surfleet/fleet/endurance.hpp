// SPDX-License-Identifier: MIT
/// @file
/// @brief How far and how long a robot can go on before it has to be back where it started.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/fleet/way_home.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/motion/lazy_prm.hpp>

namespace surfleet {
/// Why a robot does no more.
enum class StopReason : std::uint8_t {
  complete,       ///< There was nothing left to do.
  enough,         ///< What was left would have gained less than the least gain.
  coverage_goal,  ///< The share that was asked for is reached, by the mission's own account.
  endurance,      ///< It had to be back at its start.
  stranded,       ///< It found no path back to its start, or its body did not move.
  ended,          ///< The mission was ended, by time or from outside, before it was through.
  lost            ///< Its process died; its team went on without it.
};
inline constexpr std::array kStopReasons{
    StopReason::complete, StopReason::enough, StopReason::coverage_goal, StopReason::endurance,
    StopReason::stranded, StopReason::ended,  StopReason::lost};
inline std::string_view name_of(StopReason reason) {
  constexpr std::string_view kNames[] = {"complete", "enough", "coverage_goal", "endurance",
                                         "stranded", "ended",  "lost"};
  return kNames[static_cast<std::size_t>(reason)];
}
/// Whether it is a reason that was asked for.
constexpr bool is_enough(StopReason reason) { return reason <= StopReason::endurance; }

/// What a charge lasts; the robot is back at its start before that.
struct EnduranceLimits {
  std::optional<double> distance{};  ///< [m]
  std::optional<double> time{};      ///< From the mission's begin [s].

  bool any() const { return distance || time; }
};

/// A robot's account of its charge.
///
/// At any time what is left pays for the way home over known free space (`WayHome`) and for a
/// reserve beyond: to brake and come round, a tenth of the way, as paths are followed with cut
/// corners, and to go once around a mate, or whatever else comes to lie in the way. In time, also
/// for turning about and for waiting, longer with more teammates. Once the robot is on its way
/// home, the reserve is what it may spend.
class Endurance {
 public:
  /// Robots pass each other `apart` [m]; `spent` is what was flown on this charge before [m].
  /// Throws `Error` on limits that are not positive.
  Endurance(const EnduranceLimits& limits, const Point3& home, const AerialLimits& motion,
            double apart, double spent = 0.0)
      : limits_(limits), motion_(motion), way_(home), apart_(apart), travelled_(spent) {
    require(limits.distance.value_or(1.0) > 0.0 && limits.time.value_or(1.0) > 0.0,
            "endurance: expected more than 0 m and 0 s");
  }

  bool limited() const { return limits_.any(); }
  double travelled() const { return travelled_; }  ///< On this charge [m].
  const WayHome& way() const { return way_; }      ///< Kept if there are limits.

  void moved_to(const Point3& position) {
    if (last_) travelled_ += (position - *last_).norm();
    last_ = position;
    if (limited()) way_.moved_to(position);
  }
  /// Whether a flight of `metres` at `time`, the flight home included, leaves the reserve.
  bool affords(double metres, double time) const {
    const double around = (kPi - 2.0) * apart_;
    return lasts(kDetour * metres + stop() + motion_.speed + around,
                 time + kWaiting * static_cast<double>(std::max<std::size_t>(mates_, 1)));
  }
  /// Whether it lasts for such a flight, the reserve used up.
  bool covers(double metres, double time) const { return lasts(metres + stop(), time); }
  /// Whether a robot that steps `metres` aside and comes back can still go home.
  bool affords_aside(double metres, double time, bool returning) const {
    if (!limited()) return true;
    const double all = 2.0 * metres + way_.length();
    return returning ? covers(all, time) : affords(all, time);
  }
  /// Of a path home, as around mates that stand, and the way that is held: the path as far as the
  /// charge lasts for it, else the shorter.
  std::optional<Path> path_home(std::optional<Path> path, const FreeSpace& free,
                                double time) const {
    if (!limited() || (path && covers(path->length, time))) return path;
    if ((path && path->length <= way_.length()) || !way_.is_open(free)) return path;
    return Path(way_.points());
  }
  /// Follows the map and the robot; `mates` may have to be waited for.
  void update(const LazyPrmStar& roadmap, std::size_t mates) {
    mates_ = mates;
    if (limited()) way_.update(roadmap);
  }
  /// Whether it has to set out for home now. A shorter way is asked for only when that decides.
  bool must_return(double time, const LazyPrmStar& roadmap) {
    if (!limited() || affords(way_.length(), time)) return false;
    way_.shorten(roadmap);
    return !affords(way_.length(), time);
  }

 private:
  static constexpr double kDetour = 1.1;
  static constexpr double kWaiting = 10.0;  ///< For each teammate [s].

  /// To brake and come up to speed again [m].
  double stop() const { return 2.0 * motion_.speed * motion_.speed / motion_.braking; }
  bool lasts(double length, double time) const {
    if (limits_.distance && travelled_ + length > *limits_.distance) return false;
    const double turning = 2.0 * kPi / motion_.yaw_rate + motion_.speed / motion_.acceleration;
    return !limits_.time || time + length / motion_.speed + turning <= *limits_.time;
  }

  EnduranceLimits limits_;
  AerialLimits motion_;
  WayHome way_;
  double apart_;  // [m]
  std::optional<Point3> last_;
  double travelled_;
  std::size_t mates_ = 0;
};
}  // namespace surfleet
