// SPDX-License-Identifier: MIT
/// @file
/// @brief What robots of a distributed fleet send each other: sealed bytes of five kinds.
///
/// | bytes | content |
/// | --- | --- |
/// | 2, 1, 1 | magic `SF`; version, 1; kind (uint8) |
/// | 4 | team (uint32) |
/// | 12 | sender, its incarnation, its number of the message (uint32) |
/// | … | body |
/// | 4 | CRC-32 of everything before (uint32) |
///
/// The checksum tells damage, not forgery: without a transport that proves senders, a sender is
/// taken to be what it says it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/fleet/message_drops.hpp>

namespace surfleet {
/// The most urgent first.
enum class MessageKind : std::uint8_t { state = 0, route = 1, digest = 2, request = 3, patch = 4 };
inline constexpr std::size_t kMessageKinds = 5;
inline std::string_view name_of(MessageKind kind) {
  constexpr std::string_view kNames[] = {"state", "route", "digest", "request", "patch"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// A message's payload. Copies share the bytes.
struct Packet {
  MessageKind kind = MessageKind::state;
  std::shared_ptr<const Bytes> bytes;
};
inline std::size_t byte_size(const Packet& p) { return p.bytes ? p.bytes->size() : 0; }
inline std::uint8_t kind_of(const Packet& p) { return static_cast<std::uint8_t>(p.kind); }

/// A body and where it is to go.
struct Outgoing {
  MessageKind kind = MessageKind::state;
  std::optional<RobotId> to{};  ///< Nothing: to all others.
  Bytes body;
};

/// Sender and kind; `body` is a view of the packet's bytes.
struct Envelope {
  MessageKind kind = MessageKind::state;
  std::uint32_t team = 0;
  RobotId sender = 0;
  std::uint32_t incarnation = 0, number = 0;
  std::span<const std::byte> body{};
};

inline Packet seal(const Envelope& e) {
  ByteWriter out;
  out.put('S');
  out.put('F');
  out.put(std::uint8_t{1});
  out.put(e.kind);
  for (const std::uint32_t v : {e.team, std::uint32_t{e.sender}, e.incarnation, e.number})
    out.put(v);
  out.put_array(e.body);
  out.put(crc32(out.bytes()));
  return {e.kind, std::make_shared<const Bytes>(out.take())};
}
/// Throws `MessageError` on anything but a whole packet of this version.
inline Envelope open_packet(std::span<const std::byte> bytes) {
  constexpr std::size_t kHead = 20, kFoot = 4;
  const auto sound = [](bool ok, MessageDrop why, const char* text) {
    if (!ok) throw MessageError(why, std::string("packet: ") + text);
  };
  sound(bytes.size() >= kHead + kFoot, MessageDrop::truncated, "ends early; expected a whole one");
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + bytes.size() - kFoot, sizeof(stored));
  sound(stored == crc32(bytes.first(bytes.size() - kFoot)), MessageDrop::checksum,
        "checksum does not match");
  ByteReader in(bytes, "packet");
  const bool magic = in.get<char>() == 'S' && in.get<char>() == 'F';
  sound(magic, MessageDrop::malformed, "expected SF");
  sound(in.get<std::uint8_t>() == 1, MessageDrop::malformed, "of another version; expected 1");
  const auto kind = in.get<std::uint8_t>();
  sound(kind < kMessageKinds, MessageDrop::malformed, "of an unknown kind; expected 0 to 4");
  Envelope e;
  e.kind = static_cast<MessageKind>(kind);
  e.team = in.get<std::uint32_t>();
  e.sender = in.get<std::uint32_t>();
  e.incarnation = in.get<std::uint32_t>();
  e.number = in.get<std::uint32_t>();
  e.body = in.take(in.remaining() - kFoot);
  return e;
}
}  // namespace surfleet
