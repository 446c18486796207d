// SPDX-License-Identifier: MIT
/// @file
/// @brief How much memory this process has taken.
#pragma once

#include <sys/resource.h>

#include <cstddef>

namespace surfleet::examples {
/// The largest memory this process has had [bytes].
inline std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}
}  // namespace surfleet::examples
