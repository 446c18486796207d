// SPDX-License-Identifier: MIT
/// @file
/// @brief Map patches packed by zstd.
#pragma once

#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/mapping/patch_codec.hpp>

namespace surfleet {
/// One zstd frame with its size.
struct ZstdPacker {
  static constexpr std::uint8_t packing() { return 1; }
  int level = 3;  ///< 1, quick, to 19, small.

  Bytes pack(std::span<const std::byte> bytes) const {
    Bytes packed(ZSTD_compressBound(bytes.size()));
    const std::size_t n =
        ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), level);
    if (ZSTD_isError(n) != 0U) throw Error(std::string("zstd: ") + ZSTD_getErrorName(n));
    packed.resize(n);
    packed.shrink_to_fit();
    return packed;
  }
  Bytes unpack(std::span<const std::byte> bytes, std::size_t size, const std::string& what) const {
    require(ZSTD_getFrameContentSize(bytes.data(), bytes.size()) == size &&
                ZSTD_findFrameCompressedSize(bytes.data(), bytes.size()) == bytes.size(),
            what + ": expected one zstd frame of " + std::to_string(size) + " bytes");
    Bytes unpacked(size);
    const std::size_t n =
        ZSTD_decompress(unpacked.data(), unpacked.size(), bytes.data(), bytes.size());
    require(n == size, what + ": damaged zstd frame");
    return unpacked;
  }
};
static_assert(BytePacker<ZstdPacker>);
}  // namespace surfleet
