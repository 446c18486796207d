// SPDX-License-Identifier: MIT
/// @file
/// @brief A seeded random stream that gives the same numbers with every compiler and library.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace surfleet {
namespace detail {
__extension__ using Uint128 = unsigned __int128;
}
/// One step of SplitMix64: a well-mixed 64-bit value for every input.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// xoshiro256++ with the few distributions the library needs.
///
/// The standard library's distributions differ between vendors; these do not. Satisfies
/// `std::uniform_random_bit_generator`. `fork` derives an independent stream, so that parallel
/// work draws the same numbers however it is scheduled.
class Random {
 public:
  using result_type = std::uint64_t;

  explicit Random(std::uint64_t seed = 1) {
    for (std::uint64_t i = 0; i < 4; ++i) state_[i] = mix64(seed * 4 + i + 0x51);
  }

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  result_type operator()() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, …, n − 1}; `n` > 0.
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>((static_cast<detail::Uint128>((*this)()) * n) >> 64);
  }
  /// Standard normal (polar Box–Muller, one value a call).
  double normal() {
    const double u = 1.0 - uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// An independent stream named by `id`; does not advance this one.
  Random fork(std::uint64_t id) const { return Random(mix64(state_[0] ^ mix64(state_[3] + id))); }

  /// Fisher–Yates.
  template <typename Range>
  void shuffle(Range& range) {
    for (std::size_t i = range.size(); i > 1; --i) std::swap(range[i - 1], range[below(i)]);
  }

 private:
  std::uint64_t state_[4];
};
}  // namespace surfleet
