// SPDX-License-Identifier: MIT
/// @file
/// @brief Notices a body that does not move although it should.
#pragma once

#include <cmath>
#include <optional>

#include <surfleet/core/types.hpp>

namespace surfleet {
struct StallWatchOptions {
  double patience = 20.0;  ///< Without progress it is a stall [s].
  int most = 3;            ///< After so many stalls without an arrival the robot is stranded.
  double step = 0.1;       ///< Less is no progress, in flight [m] …
  double turn = 0.1;       ///< … and in place [rad].
};

/// Counts the stalls of one robot. What it does when its place is reached is to turn, heading or
/// gimbal; before that it has to come farther.
class StallWatch {
 public:
  StallWatchOptions options;

  /// To be told with every step of the clock, `in_place` at the end of a path. Whether a stall has
  /// come to an end now, so that something else should be tried.
  bool moves(const Configuration& at, bool in_place, double time) {
    const bool turned = since_ && (std::abs(wrap_angle(at.yaw - from_.yaw)) >= options.turn ||
                                   std::abs(at.pitch - from_.pitch) >= options.turn);
    if (!since_ || (at.position - from_.position).norm() >= options.step || (in_place && turned)) {
      from_ = at;
      since_ = time;
    }
    if (time - *since_ < options.patience) return false;
    since_.reset();
    ++stalls_;
    return true;
  }
  /// It is not to move: it waits, gives way, or looks.
  void rests() { since_.reset(); }
  void arrives() { stalls_ = 0; }
  bool stranded() const { return stalls_ >= options.most; }

 private:
  Configuration from_;
  std::optional<double> since_;  // [s]
  int stalls_ = 0;
};
}  // namespace surfleet
