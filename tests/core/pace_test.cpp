// SPDX-License-Identifier: MIT
#include <surfleet/core/pace.hpp>

#include <chrono>

#include "check.hpp"

namespace {
using namespace surfleet;

/// A clock that stands but for what a test says.
struct HandClock {
  using duration = std::chrono::duration<double>;
  using time_point = std::chrono::time_point<HandClock, duration>;
  static inline double seconds = 0.0;
  static time_point now() { return time_point(duration(seconds)); }
};
}  // namespace

TEST(pace_counts_late_steps_and_does_not_make_up_for_them) {
  HandClock::seconds = 100.0;
  Pace<HandClock> pace(0.25, 1000.0);
  CHECK(pace.now() == 0.0);
  HandClock::seconds += 0.0001;  // 0.1 s of ours
  pace.wait();
  CHECK(pace.late() == 0);
  CHECK_NEAR(pace.now(), 0.1, 1e-6);
  HandClock::seconds += 0.0007;  // due at 0.5, now 0.8
  pace.wait();
  CHECK(pace.late() == 1);
  HandClock::seconds += 0.0002;  // due at 1.05, now 1.0
  pace.wait();
  CHECK(pace.late() == 1);
  HandClock::seconds += 0.0004;  // due at 1.3, now 1.4
  pace.wait();
  CHECK(pace.late() == 2);
}
TEST(pace_waits_until_a_step_is_due) {
  const auto start = std::chrono::steady_clock::now();
  Pace<> pace(1.0, 100.0);
  for (int step = 0; step < 5; ++step) pace.wait();
  CHECK(std::chrono::steady_clock::now() - start >= std::chrono::milliseconds(49));
  CHECK(pace.now() >= 4.9);
}
TEST(pace_refuses_what_is_no_time) {
  CHECK_THROWS(Error, Pace<>(0.0));
  CHECK_THROWS(Error, Pace<>(0.25, -1.0));
}
