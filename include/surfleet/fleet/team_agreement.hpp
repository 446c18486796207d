// SPDX-License-Identifier: MIT
/// @file
/// @brief What the robots of a team have to agree on before they fly, and what they say of it.
///
///     if (const auto why = disagreement(ours, *TeamAgreement::read(note))) refuse(*why);
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/transport.hpp>

namespace surfleet {
struct TeamAgreement {
  static constexpr std::uint32_t kProtocol = 5;
  std::string team;
  RobotId robot = 0;  ///< The one that says so.
  std::uint32_t protocol = kProtocol;
  std::uint32_t robots = 0;   ///< Of the team at the most.
  double voxel = 0.0;         ///< [m]
  double truncation = 0.0;    ///< µ [m]
  double known_weight = 0.0;  ///< W_th
  double image_weight = 0.0;  ///< Of one image for surface 2 m away: W_th is of that rule.
  double range = 0.0;         ///< Of the sensors [m]: bounds what patches can hold.
  std::uint32_t packing = 0;  ///< Of patches (`BytePacker::packing()`).

  /// A line of text. Numbers are written so that they read back as the same value.
  std::string note() const {
    return std::string(kMark) + kComma + team + kComma + std::to_string(robot) + kComma + agreed();
  }
  /// The agreement of a note; nothing if it is none.
  static std::optional<TeamAgreement> read(std::string_view note) {
    std::vector<std::string> words{""};
    for (const char c : note.substr(0, kLongest))
      if (c == kComma)
        words.emplace_back();
      else
        words.back() += c;
    if (words.size() < 4 || words[0] != kMark) return std::nullopt;
    TeamAgreement a;
    a.team = words[1];  // which is told to people
    const bool plain = std::all_of(a.team.begin(), a.team.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (!plain) return std::nullopt;
    const auto robot = parse_number<std::uint32_t>(words[2]);
    const auto protocol = parse_number<std::uint32_t>(words[3]);
    if (!robot || !protocol) return std::nullopt;
    a.robot = *robot;
    a.protocol = *protocol;
    if (a.protocol != kProtocol) return a;  // whatever follows in theirs
    if (words.size() != 11) return std::nullopt;
    const auto robots = parse_number<std::uint32_t>(words[4]);
    const auto voxel = parse_number<double>(words[5]), truncation = parse_number<double>(words[6]),
               known = parse_number<double>(words[7]), weight = parse_number<double>(words[8]),
               range = parse_number<double>(words[9]);
    const auto packing = parse_number<std::uint32_t>(words[10]);
    if (!robots || !voxel || !truncation || !known || !weight || !range || !packing)
      return std::nullopt;
    a.robots = *robots;
    a.voxel = *voxel;
    a.truncation = *truncation;
    a.known_weight = *known;
    a.image_weight = *weight;
    a.range = *range;
    a.packing = *packing;
    return a;
  }
  /// The number that its packets carry: the same for all that agree.
  std::uint32_t number() const {
    std::uint64_t h = 0;
    for (const char c : team + kComma + agreed()) h = mix64(h ^ static_cast<unsigned char>(c));
    return static_cast<std::uint32_t>(h);
  }

 private:
  friend std::optional<std::string> disagreement(const TeamAgreement&, const TeamAgreement&);
  static constexpr const char* kMark = "surfleet";
  static constexpr char kComma = ',';
  static constexpr std::size_t kLongest = 512;
  /// The shortest that reads back as the same value.
  static std::string exact(double v) {
    std::array<char, 40> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), v).ptr};
  }
  std::string agreed() const {
    return std::to_string(protocol) + kComma + std::to_string(robots) + kComma + exact(voxel) +
           kComma + exact(truncation) + kComma + exact(known_weight) + kComma +
           exact(image_weight) + kComma + exact(range) + kComma + std::to_string(packing);
  }
};

/// Why a robot cannot join one that is there, in one line; nothing if it can. A network carries one
/// team, as robots of two would know nothing of each other.
inline std::optional<std::string> disagreement(const TeamAgreement& ours,
                                               const TeamAgreement& theirs) {
  const std::string robot = "robot " + std::to_string(theirs.robot + 1) + " of team " + theirs.team;
  const auto differs = [&](const std::string& what, const std::string& is) {
    return robot + " has " + what + " " + is + "; expected the same of all";
  };
  if (theirs.team != ours.team) return robot + " flies here; expected the same team of all";
  if (theirs.protocol != ours.protocol) return differs("protocol", std::to_string(theirs.protocol));
  if (theirs.robot == ours.robot) return robot + " is alive elsewhere; expected another id";
  if (theirs.robots != ours.robots) return differs("a team of", std::to_string(theirs.robots));
  if (theirs.voxel != ours.voxel) return differs("voxels of", TeamAgreement::exact(theirs.voxel));
  if (theirs.truncation != ours.truncation)
    return differs("a truncation of", TeamAgreement::exact(theirs.truncation));
  if (theirs.known_weight != ours.known_weight)
    return differs("a known weight of", TeamAgreement::exact(theirs.known_weight));
  if (theirs.image_weight != ours.image_weight)
    return differs("images that weigh at 2 m", TeamAgreement::exact(theirs.image_weight));
  if (theirs.range != ours.range)
    return differs("sensors with a range of", TeamAgreement::exact(theirs.range));
  if (theirs.packing != ours.packing)
    return differs("patches packed by", std::to_string(theirs.packing));
  return std::nullopt;
}
}  // namespace surfleet
