// SPDX-License-Identifier: MIT
/// @file
/// @brief The TSPLIB reader refuses or reads any bytes; what it reads survives a round trip.
#include <cstdlib>

#include <surfleet/allocation/tsplib.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  try {
    const TsplibInstance instance =
        parse_tsplib({reinterpret_cast<const char*>(data), size}, "input", 200);
    const TsplibInstance again = parse_tsplib(format_tsplib(instance), "again", 200);
    for (int i = 0; i < instance.costs.size(); ++i)
      for (int j = 0; j < instance.costs.size(); ++j)
        if (again.costs(i, j) != instance.costs(i, j)) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
