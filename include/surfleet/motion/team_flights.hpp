// SPDX-License-Identifier: MIT
/// @file
/// @brief Whom a robot would meet on its way, were all to fly straight to where they are sent.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <surfleet/core/types.hpp>

namespace surfleet {
/// From one place straight to another, at the speed that all have, to stay there.
struct StraightFlight {
  Point3 from, to;

  double length() const { return (to - from).norm(); }
  /// Where it is after so many metres.
  Point3 after(double way) const {
    const double all = length();
    return way < all ? Point3(from + (to - from) * (way / all)) : to;
  }
};

/// The least distance between two who set off at the same time [m]. O(1).
inline double closest_approach(const StraightFlight& a, const StraightFlight& b) {
  std::array<double, 3> stages{0.0, a.length(), b.length()};
  std::sort(stages.begin(), stages.end());
  double least = (a.from - b.from).norm();
  for (std::size_t i = 1; i < stages.size(); ++i) {
    // Between two of these both move evenly, so one sees the other pass along a segment.
    const Eigen::Vector3d begin = b.after(stages[i - 1]) - a.after(stages[i - 1]);
    const Eigen::Vector3d passed = b.after(stages[i]) - a.after(stages[i]) - begin;
    const double squared = passed.squaredNorm();
    const double t = squared > 0.0 ? std::clamp(-begin.dot(passed) / squared, 0.0, 1.0) : 0.0;
    least = std::min(least, (begin + t * passed).norm());
  }
  return least;
}

/// The flights of a team that are settled.
class TeamFlights {
 public:
  /// `gap`: how near two may come to each other without one of them having to wait [m].
  explicit TeamFlights(double gap) : gap_(gap) {}

  void settle(const StraightFlight& flight) { flights_.push_back(flight); }
  /// Whether `flight` comes nearer than the gap to one of them, and nearer than where it begins.
  bool meet(const StraightFlight& flight) const {
    return std::any_of(flights_.begin(), flights_.end(), [&](const StraightFlight& other) {
      const double now = (flight.from - other.from).norm();
      return closest_approach(flight, other) < std::min(gap_, now - kCloser);
    });
  }

 private:
  static constexpr double kCloser = 1e-3;  ///< [m]
  double gap_;
  std::vector<StraightFlight> flights_;
};
}  // namespace surfleet
