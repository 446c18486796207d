// SPDX-License-Identifier: MIT
/// @file
/// @brief Any bytes as a configuration file are settings within their bounds, or are refused.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "support/inspection_settings.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  cli::Options app("");
  examples::InspectionOptions options(app);
  std::istringstream file(std::string(reinterpret_cast<const char*>(data), size));
  try {
    app.parse_config(file);
    const examples::InspectionSettings s = options.settle();
    if (s.robots < 1 || s.robots > 64 || !(s.voxel >= 0.01) || !(s.farthest > s.nearest))
      std::abort();
  } catch (const Error&) {
  }
  return 0;
}
