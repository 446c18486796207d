// SPDX-License-Identifier: MIT
/// @file
/// @brief A set of patch names in little space: runs of numbers for each robot and incarnation.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/mapping/detail/hit_codec.hpp>
#include <surfleet/mapping/map_patch.hpp>

namespace surfleet {
/// Space and bytes grow with the number of runs, whatever the numbers: a set that claims millions
/// of patches costs no more than one that claims two.
class PatchIdSet {
 public:
  /// Most runs of a set that is read from bytes.
  static constexpr std::size_t kMostRuns = 4096;

  bool contains(const PatchKey& key) const {
    const auto source = runs_.find({key.robot, key.incarnation});
    if (source == runs_.end()) return false;
    const auto after = source->second.upper_bound(key.number);
    return after != source->second.begin() && std::prev(after)->second >= key.number;
  }
  /// Whether it was new. O(log runs).
  bool insert(const PatchKey& key) {
    if (contains(key)) return false;
    Runs& runs = runs_[{key.robot, key.incarnation}];
    std::uint32_t first = key.number, last = key.number;
    auto next = runs.upper_bound(key.number);
    if (next != runs.end() && next->first == key.number + 1) {
      last = next->second;
      next = runs.erase(next);
    }
    if (next != runs.begin() && std::prev(next)->second + 1 == key.number)
      first = std::prev(next)->first;
    runs[first] = last;
    ++size_;
    return true;
  }
  std::uint64_t size() const { return size_; }
  bool operator==(const PatchIdSet& o) const { return runs_ == o.runs_; }

  /// `fn(key)` for what this has and `other` has not, in order; as long as it returns true.
  /// O(runs of both + calls).
  template <typename Fn>
  void for_each_beyond(const PatchIdSet& other, Fn&& fn) const {
    for (const auto& [source, runs] : runs_) {
      const auto theirs = other.runs_.find(source);
      for (const auto& [first, last] : runs)
        for (std::uint64_t n = first; n <= last; ++n) {
          const auto number = static_cast<std::uint32_t>(n);
          if (theirs != other.runs_.end()) {
            const auto after = theirs->second.upper_bound(number);
            if (after != theirs->second.begin() && std::prev(after)->second >= number) {
              n = std::prev(after)->second;
              continue;
            }
          }
          if (!fn(PatchKey{source.first, source.second, number})) return;
        }
    }
  }

  void put(ByteWriter& out) const {
    detail::put_varint(out, runs_.size());
    for (const auto& [source, runs] : runs_) {
      detail::put_varint(out, source.first);
      detail::put_varint(out, source.second);
      detail::put_varint(out, runs.size());
      std::uint64_t at = 0;
      for (const auto& [first, last] : runs) {
        detail::put_varint(out, first - at);
        detail::put_varint(out, last - first);
        at = std::uint64_t{last} + 1;
      }
    }
  }
  /// Throws `Error` that begins with `what` on anything but a set of at most `kMostRuns` runs.
  static PatchIdSet get(ByteReader& in, const std::string& what) {
    constexpr std::uint64_t kMax = 0xFFFFFFFF;
    const auto sound = [&](bool ok) {
      if (!ok) throw Error(what + ": expected sets of patches in order");
    };
    PatchIdSet set;
    std::size_t left = kMostRuns;
    const std::uint64_t sources = detail::get_varint(in, what);
    sound(sources <= left);
    for (std::uint64_t s = 0; s < sources; ++s) {
      const std::uint64_t robot = detail::get_varint(in, what);
      const std::uint64_t incarnation = detail::get_varint(in, what);
      const std::uint64_t count = detail::get_varint(in, what);
      sound(robot <= kMax && incarnation <= kMax && count > 0 && count <= left);
      left -= static_cast<std::size_t>(count);
      const std::pair source{static_cast<RobotId>(robot), static_cast<std::uint32_t>(incarnation)};
      sound(set.runs_.empty() || set.runs_.rbegin()->first < source);
      Runs& runs = set.runs_[source];
      std::uint64_t at = 0;
      for (std::uint64_t r = 0; r < count; ++r) {
        const std::uint64_t skip = detail::get_varint(in, what);
        sound((r == 0 || skip > 0) && at <= kMax && skip <= kMax - at);
        const std::uint64_t first = at + skip, more = detail::get_varint(in, what);
        sound(more <= kMax - first);
        runs.emplace_hint(runs.end(), static_cast<std::uint32_t>(first),
                          static_cast<std::uint32_t>(first + more));
        at = first + more + 1;
        set.size_ += more + 1;
      }
    }
    return set;
  }

 private:
  using Runs = std::map<std::uint32_t, std::uint32_t>;  // first to last, both included
  std::map<std::pair<RobotId, std::uint32_t>, Runs> runs_;
  std::uint64_t size_ = 0;
};
}  // namespace surfleet
