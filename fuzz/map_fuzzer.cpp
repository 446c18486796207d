// SPDX-License-Identifier: MIT
/// @file
/// @brief Feeds bytes to the map reader; what it accepts must survive a round trip.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include <surfleet/mapping/map_file.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  const auto input = std::as_bytes(std::span(data, size));
  // As it is, and with its checksum put right, so that mutations reach the parser.
  for (const bool mend : {false, true}) {
    Bytes bytes(input.begin(), input.end());
    if (mend && bytes.size() >= 4) {
      const std::uint32_t sum = crc32(std::span<const std::byte>(bytes).first(bytes.size() - 4));
      std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof(sum));
    }
    try {
      const TsdfMap map = decode_map(bytes);
      const Bytes once = encode_map(map);
      if (encode_map(decode_map(once)) != once) std::abort();
    } catch (const Error&) {
    }
  }
  return 0;
}
