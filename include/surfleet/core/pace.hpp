// SPDX-License-Identifier: MIT
/// @file
/// @brief Steps of equal length on a real clock, or on one that runs faster.
///
///     for (Pace pace(0.25); !done(pace.now()); pace.wait()) step();
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <thread>

#include <surfleet/core/error.hpp>

namespace surfleet {
/// Time that starts with 0 and passes `speed_up` times as fast as the clock's. A step that takes
/// too long is late, and puts off all that follow: they are not made up for.
template <typename Clock = std::chrono::steady_clock>
class Pace {
 public:
  /// Throws `Error` unless both are positive.
  explicit Pace(double period, double speed_up = 1.0)
      : period_(period), speed_up_(speed_up), start_(Clock::now()), due_(period) {
    require(period > 0.0 && std::isfinite(period), "pace: expected a positive period");
    require(speed_up > 0.0 && std::isfinite(speed_up), "pace: expected a positive speed-up");
  }
  double now() const {  ///< [s]
    return speed_up_ * std::chrono::duration<double>(Clock::now() - start_).count();
  }
  /// Until the next step is due.
  void wait() {
    const double left = due_ - now();
    if (left < 0.0) {
      ++late_;
      due_ -= left;
    } else {
      std::this_thread::sleep_for(std::chrono::duration<double>(left / speed_up_));
    }
    due_ += period_;
  }
  std::size_t late() const { return late_; }  ///< Steps that took too long.

 private:
  double period_, speed_up_;
  typename Clock::time_point start_;
  double due_;
  std::size_t late_ = 0;
};
}  // namespace surfleet
