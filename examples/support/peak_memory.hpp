// SPDX-License-Identifier: MIT
/// @file
/// @brief How much memory this process takes, and has taken at the most.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>

namespace surfleet::examples {
/// The largest memory this process has had [bytes].
inline std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}
/// What of this process is in memory [bytes]; 0 where the system does not tell.
inline std::size_t resident_memory() {
  std::ifstream in("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  in >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}
}  // namespace surfleet::examples
