// SPDX-License-Identifier: MIT
/// @file
/// @brief Feeds bytes to what a robot does with its mail: packets, states, routes, digests,
/// requests. The first byte says which kind of body the rest is.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/team_relay.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace surfleet;
  const auto input = std::as_bytes(std::span(data, size));
  MessageGuard guard(0);
  guard.admit(1, input, 0.0);
  if (size == 0) return 0;
  const auto kind = static_cast<MessageKind>(data[0] % kMessageKinds);
  const Envelope mail{.kind = kind, .sender = 1, .body = input.subspan(1)};
  const Packet sealed = seal(mail);
  const auto opened = guard.admit(1, *sealed.bytes, 0.0);
  if (!opened || opened->kind != kind || opened->body.size() != size - 1) std::abort();

  TeamRelay relay(0);
  relay.hear(*opened, 1.0);
  for (const RobotState& mate : relay.mates(1.0))
    if (!mate.at.position.allFinite() || !std::isfinite(mate.at.yaw)) std::abort();
  relay.speak(1.0);
  try {
    const Bytes once = encode_states(decode_states(mail.body));
    if (encode_states(decode_states(once)) != once) std::abort();
  } catch (const Error&) {
  }
  try {
    const Bytes once = encode_routes(decode_routes(mail.body));
    if (encode_routes(decode_routes(once)) != once) std::abort();
  } catch (const Error&) {
  }

  PatchSync<> sync(0, {.known_missing = 50});
  for (const double now : {1.0, 1.1}) {
    sync.hear(*opened, now);
    if (sync.missing() > 50) std::abort();
    sync.speak(now + 0.6);
  }
  return 0;
}
