// SPDX-License-Identifier: MIT
/// @file
/// @brief Little-endian bytes in and out, a checksum, and files written whole or not at all.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include <surfleet/core/error.hpp>

namespace surfleet {
static_assert(std::endian::native == std::endian::little, "the file formats are little-endian");

using Bytes = std::vector<std::byte>;

/// CRC-32 (polynomial 0xEDB88320) of `data`; `seed` continues an earlier one.
inline std::uint32_t crc32(std::span<const std::byte> data, std::uint32_t seed = 0) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1U) != 0U ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t c = ~seed;
  for (const std::byte b : data) c = table[(c ^ static_cast<std::uint32_t>(b)) & 0xFFU] ^ (c >> 8);
  return ~c;
}

/// Appends values of trivially copyable types to a byte vector.
class ByteWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    // Not by `insert`, whose growth some compilers warn of once all is inlined.
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  template <typename T>
  void put_array(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto raw = std::as_bytes(values);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  void put_text(std::string_view text) { put_array(std::span<const char>(text)); }
  const Bytes& bytes() const { return bytes_; }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// Takes values from a byte span and throws `Error` rather than read past its end.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, std::string what)
      : bytes_(bytes), what_(std::move(what)) {}

  std::size_t remaining() const { return bytes_.size() - at_; }
  std::size_t position() const { return at_; }

  template <typename T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    need(sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// A view of the next `n` bytes.
  std::span<const std::byte> take(std::size_t n) {
    need(n);
    const auto view = bytes_.subspan(at_, n);
    at_ += n;
    return view;
  }

 private:
  void need(std::size_t n) const {
    if (n > remaining())
      throw Error(what_ + ": ends early at byte " + std::to_string(bytes_.size()) +
                  "; expected a complete file");
  }
  std::span<const std::byte> bytes_;
  std::string what_;
  std::size_t at_ = 0;
};

/// The whole file; throws `Error` if it cannot be read.
inline Bytes read_file(const std::filesystem::path& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec))
    throw Error(path.string() + ": no such file; expected a file that can be read");
  if (!std::filesystem::is_regular_file(path, ec))
    throw Error(path.string() + ": not a regular file");
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) throw Error(path.string() + ": cannot be opened for reading");
  const auto size = in.tellg();
  Bytes bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!in) throw Error(path.string() + ": cannot be read to its end");
  return bytes;
}

/// Bytes as the text they are; a view.
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Writes `bytes` to `path` by way of a temporary beside it, so that a reader sees the old file
/// or the new one and never half of either. Throws `Error` if it cannot.
inline void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::filesystem::path partial = path;
  partial += ".partial";
  {
    std::ofstream out(partial, std::ios::binary | std::ios::trunc);
    if (out)
      out.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) {
      std::error_code ignored;
      std::filesystem::remove(partial, ignored);
      throw Error(path.string() + ": cannot be written; expected a writable folder with room");
    }
  }
  std::error_code ec;
  std::filesystem::rename(partial, path, ec);
  if (ec) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw Error(path.string() + ": cannot be written: " + ec.message());
  }
}
inline void write_file(const std::filesystem::path& path, std::string_view text) {
  write_file(path, std::as_bytes(std::span<const char>(text)));
}
}  // namespace surfleet
