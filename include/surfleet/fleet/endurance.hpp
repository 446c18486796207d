// SPDX-License-Identifier: MIT
/// @file
/// @brief How far and how long a robot can go on before it has to be back where it started.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/motion/kinematics.hpp>

namespace surfleet {
/// Why a robot does no more.
enum class StopReason : std::uint8_t {
  complete,       ///< There was nothing left to do.
  enough,         ///< What was left would have gained less than the least gain.
  coverage_goal,  ///< The share that was asked for is reached, by the mission's own account.
  endurance,      ///< It had to be back at its start.
  stranded,       ///< It found no path back to its start.
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
/// A reserve is kept beyond the path home: to brake and come round, and a tenth of the path, as
/// paths are followed with cut corners and steps aside. In time, also for turning about and for
/// waiting.
class Endurance {
 public:
  /// Throws `Error` on limits that are not positive.
  Endurance(const EnduranceLimits& limits, const Point3& home, const AerialLimits& motion)
      : limits_(limits), motion_(motion), last_(home), home_(home) {
    require(limits.distance.value_or(1.0) > 0.0 && limits.time.value_or(1.0) > 0.0,
            "endurance: expected more than 0 m and 0 s");
  }

  bool limited() const { return limits_.any(); }
  const Point3& home() const { return home_; }
  double travelled() const { return travelled_; }  ///< Since the start [m].

  void moved_to(const Point3& position) {
    const double step = (position - last_).norm();
    travelled_ += step;
    distance_home_ += step;  // it cannot have become longer by more
    last_ = position;
  }
  /// Whether a flight of `metres` at `time`, the flight home included, leaves the reserve.
  bool affords(double metres, double time) const {
    const double stop = motion_.speed * motion_.speed / motion_.braking;
    const double length = kDetour * metres + 2.0 * stop + motion_.speed;
    if (limits_.distance && travelled_ + length > *limits_.distance) return false;
    const double turning = 2.0 * kPi / motion_.yaw_rate + motion_.speed / motion_.acceleration;
    return !limits_.time || time + length / motion_.speed + turning + kWaiting <= *limits_.time;
  }
  /// Whether it has to set out for home now. `distance_home()` [m] is asked for only when a bound
  /// from the last answer does not decide.
  template <typename DistanceHome>
  bool must_return(double time, const DistanceHome& distance_home) {
    if (!limited() || affords(distance_home_, time)) return false;
    distance_home_ = distance_home();
    return !affords(distance_home_, time);
  }

 private:
  static constexpr double kDetour = 1.1;
  static constexpr double kWaiting = 10.0;  ///< For teammates [s].

  EnduranceLimits limits_;
  AerialLimits motion_;
  Point3 last_, home_;
  double travelled_ = 0.0;
  double distance_home_ = 0.0;  // a bound
};
}  // namespace surfleet
