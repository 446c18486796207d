// SPDX-License-Identifier: MIT
/// @file
/// @brief How the robots of a team come to hold the same patches, whatever gets lost
/// [000 §4.4.1].
///
/// A robot that closes a patch sends it once. All say from time to time, and soon after a change,
/// what they hold; one that misses something asks the nearest that has it, after a time the next.
/// One request a patch is out at a time; when all were asked, it waits longer and longer. A mate
/// that is asked for enough already is passed over, so that who misses much is served by all.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/patch_ids.hpp>
#include <surfleet/mapping/patch_codec.hpp>

namespace surfleet {
struct PatchSyncOptions {
  double digest_period = 1.0;       ///< Between messages of what is held, if nothing changes [s].
  double digest_gap = 0.25;         ///< At least, if something does [s].
  double first_timeout = 2.0;       ///< For an answer of one that never answered [s].
  double least_timeout = 0.25;      ///< [s]
  double longest_timeout = 30.0;    ///< Also of the pause when all were asked in vain [s].
  double silence = 3.0;             ///< One not heard for so long is not asked [s].
  double grace = 0.5;               ///< For what is announced to come by itself [s].
  std::size_t requests = 8;         ///< Most patches asked of one mate at a time.
  std::size_t known_missing = 512;  ///< Most of one mate's patches that are kept in mind.
  std::size_t answers = 64;         ///< Most answers to one mate that wait.
  std::size_t answer_bytes = 64 * 1024;  ///< Sent in answers at one `speak`, and one patch more.
  std::size_t patches = 1 << 20;         ///< Most that are held.
  std::size_t stored_bytes = std::size_t{1} << 31;  ///< The same, in bytes.
  RobotId robots = 256;                             ///< Producers' ids are below this.
  /// How often this robot was started before: it alone makes patches of that name, and holds all.
  std::uint32_t incarnation = 0;
};

/// One robot's part. It knows no clock but the times it is told, and no transport: `hear` what has
/// come in, then `speak`. Of two contents under one name, the first to come stays.
template <BytePacker Packer = AnyPacker>
class PatchSync {
 public:
  Packer packer;
  PatchLimits limits;  ///< What others' patches may be.
  /// How far away a mate is [m]: the nearest is asked first; if not given, all are as near.
  std::function<double(RobotId)> distance;

  explicit PatchSync(RobotId self, PatchSyncOptions options = {}, PatchLimits l = {}, Packer p = {})
      : packer(std::move(p)), limits(l), self_(self), options_(options) {}

  /// Takes a patch of our own, which goes out with the next `speak`. Throws `Error` if one of its
  /// name is held. Returns its full name.
  PatchId publish(const MapPatch& patch) {
    EncodedPatch e = encode_patch(patch, packer);
    require(!held_.contains(e.id.key), to_string(e.id.key) + ": is held already");
    fresh_.push_back(e.id.key);
    keep(e.id, std::move(e.bytes));
    return e.id;
  }
  /// Others' patches since the last call, in the order they came.
  std::vector<MapPatch> take_arrived() { return std::exchange(arrived_, {}); }

  /// A digest, a request or a patch; others are none of its business. Never throws on what a
  /// message says.
  void hear(const Envelope& message, double now) {
    if (message.sender == self_) return;
    drops_.reading([&] {
      if (message.kind == MessageKind::digest) hear_digest(message, now);
      if (message.kind == MessageKind::request) hear_request(message);
      if (message.kind == MessageKind::patch) hear_patch(message, now);
    });
  }
  /// What there is to say, the most urgent first.
  std::vector<Outgoing> speak(double now) {
    std::vector<Outgoing> out;
    if (now >= next_digest_ || (changed_ && now >= last_digest_ + options_.digest_gap)) {
      ByteWriter body;
      body.put(digest());
      held_.put(body);
      out.push_back({MessageKind::digest, std::nullopt, body.take()});
      last_digest_ = now;
      // Mates that started together do not speak together for good.
      Random luck(mix64(self_) + said_++);
      next_digest_ = now + options_.digest_period * luck.uniform(0.9, 1.1);
      changed_ = false;
    }
    ask(now, out);
    for (const PatchKey& key : fresh_)
      out.push_back({MessageKind::patch, std::nullopt, *store_.at(key).bytes});
    fresh_.clear();
    std::size_t bytes = 0;
    while (!answers_.empty() && bytes < options_.answer_bytes) {
      const auto [to, key] = answers_.front();
      answers_.pop_front();
      --mates_[to].waiting;
      const Bytes& patch = *store_.at(key).bytes;
      bytes += patch.size();
      out.push_back({MessageKind::patch, to, patch});
    }
    return out;
  }

  // -- what is held ------------------------------------------------------------------------------
  /// Equal for equal sets of names and contents, whatever their order.
  std::uint64_t digest() const { return mix64(sum_ ^ held_.size()); }
  const PatchIdSet& held() const { return held_; }
  bool holds(const PatchKey& key) const { return held_.contains(key); }
  /// The bytes of a patch that is held; throws `Error` if it is not.
  std::shared_ptr<const Bytes> bytes(const PatchKey& key) const {
    const auto it = store_.find(key);
    require(it != store_.end(), to_string(key) + ": is not held");
    return it->second.bytes;
  }
  /// The patch of a name. Throws as `bytes` does.
  MapPatch patch(const PatchKey& key) const { return decode_patch(*bytes(key), limits, packer); }
  /// What a mate said to hold, last; nothing if it said nothing for `silence`.
  std::optional<std::uint64_t> digest_of(RobotId mate, double now) const {
    const auto it = mates_.find(mate);
    if (it == mates_.end() || !it->second.digest || now - it->second.heard > options_.silence)
      return std::nullopt;
    return it->second.digest;
  }
  std::size_t missing() const { return wanted_.size(); }  ///< That others are known to hold.
  std::size_t stored_bytes() const { return stored_bytes_; }
  const MessageDrops& drops() const { return drops_; }
  std::uint64_t duplicates() const { return duplicates_; }  ///< Patches that were there already.

 private:
  struct Stored {
    std::uint64_t hash = 0;
    std::shared_ptr<const Bytes> bytes;
  };
  struct Mate {
    PatchIdSet holds;
    std::optional<std::uint64_t> digest;
    double heard = -std::numeric_limits<double>::infinity();  // its digest [s]
    std::optional<double> response;                           // mean time to an answer [s]
    double deviation = 0.0;
    std::size_t waiting = 0;  // answers to it

    void note_response(double took) {
      deviation =
          response ? deviation + 0.25 * (std::abs(took - *response) - deviation) : 0.5 * took;
      response = response ? *response + 0.125 * (took - *response) : took;
    }
  };
  struct Want {
    struct Try {
      double time = 0.0;
      int round = 0;
    };
    std::optional<RobotId> asked;
    double deadline = 0.0;  // of the one asked
    double next_try = 0.0, pause = 0.0;
    int round = 1;  // of asking all
    std::map<RobotId, Try> tries;
  };

  void keep(const PatchId& id, Bytes bytes) {
    stored_bytes_ += bytes.size();
    store_[id.key] = {id.hash, std::make_shared<const Bytes>(std::move(bytes))};
    held_.insert(id.key);
    const auto mix = [](std::uint64_t a, std::uint64_t b) { return mix64(a ^ mix64(b)); };
    sum_ +=
        mix(mix(std::uint64_t{id.key.robot} << 32 | id.key.incarnation, id.key.number), id.hash);
    wanted_.erase(id.key);
    changed_ = true;
  }
  void hear_digest(const Envelope& message, double now) {
    ByteReader in(message.body, "digest");
    const auto digest = in.get<std::uint64_t>();
    PatchIdSet holds = PatchIdSet::get(in, "digest");
    require(in.remaining() == 0, "digest: bytes after its end");
    if (message.sender >= options_.robots) {
      drops_.add(MessageDrop::beyond_limits);
      return;
    }
    Mate& mate = mates_[message.sender];
    mate.holds = std::move(holds);
    mate.digest = digest;
    mate.heard = now;
    std::size_t count = 0;
    mate.holds.for_each_beyond(held_, [&](const PatchKey& key) {
      if (key.robot >= options_.robots) {
        drops_.add(MessageDrop::beyond_limits);
        return false;  // and so are all that follow
      }
      if (is_own(key)) {
        if (count == 0) drops_.add(MessageDrop::impostor);
      } else if (const auto [want, fresh] = wanted_.try_emplace(key); fresh)
        want->second.next_try = now + options_.grace;
      return ++count < options_.known_missing;
    });
  }
  void hear_request(const Envelope& message) {
    ByteReader in(message.body, "request");
    const PatchIdSet asked = PatchIdSet::get(in, "request");
    require(in.remaining() == 0, "request: bytes after its end");
    if (message.sender >= options_.robots) {
      drops_.add(MessageDrop::beyond_limits);
      return;
    }
    Mate& mate = mates_[message.sender];
    std::size_t count = 0;
    asked.for_each_beyond({}, [&](const PatchKey& key) {
      if (!held_.contains(key)) {
        drops_.add(MessageDrop::in_vain);
      } else if (std::count(answers_.begin(), answers_.end(), std::pair(message.sender, key)) ==
                 0) {
        if (mate.waiting >= options_.answers) return false;
        answers_.emplace_back(message.sender, key);
        ++mate.waiting;
      }
      return ++count < options_.answers;
    });
  }
  bool is_own(const PatchKey& key) const {
    return key.robot == self_ && key.incarnation == options_.incarnation;
  }
  static MessageDrop drop_of(PatchFault fault) {
    switch (fault) {
      case PatchFault::checksum:
        return MessageDrop::checksum;
      case PatchFault::bomb:
        return MessageDrop::bomb;
      case PatchFault::out_of_reach:
        return MessageDrop::out_of_reach;
      case PatchFault::impossible_weight:
        return MessageDrop::impossible_weight;
      default:
        return MessageDrop::malformed;
    }
  }
  void hear_patch(const Envelope& message, double now) {
    MapPatch patch;
    try {
      patch = decode_patch(message.body, limits, packer);
    } catch (const PatchError& e) {
      throw MessageError(drop_of(e.fault()), e.what());
    }
    const PatchKey& key = patch.id.key;
    if (const auto held = store_.find(key); held != store_.end()) {
      if (held->second.hash == patch.id.hash)
        ++duplicates_;
      else
        drops_.add(MessageDrop::conflict);
      return;
    }
    if (is_own(key)) {
      drops_.add(MessageDrop::impostor);
      return;
    }
    if (key.robot >= options_.robots || store_.size() >= options_.patches ||
        stored_bytes_ + message.body.size() > options_.stored_bytes) {
      drops_.add(MessageDrop::beyond_limits);
      return;
    }
    if (const auto want = wanted_.find(key); want != wanted_.end())
      if (const auto t = want->second.tries.find(message.sender); t != want->second.tries.end())
        mates_[message.sender].note_response(now - t->second.time);
    keep(patch.id, Bytes(message.body.begin(), message.body.end()));
    arrived_.push_back(std::move(patch));
  }
  /// Late answers count, too, so it comes to fit the network.
  double timeout(const Mate& mate) const {
    return std::clamp(
        mate.response ? *mate.response + 4.0 * mate.deviation : options_.first_timeout,
        options_.least_timeout, options_.longest_timeout);
  }
  bool claims(const Mate& mate, const PatchKey& key, double now) const {
    return now - mate.heard <= options_.silence && mate.holds.contains(key);
  }
  bool held_by_any(const PatchKey& key, double now) const {
    return std::any_of(mates_.begin(), mates_.end(),
                       [&](const auto& mate) { return claims(mate.second, key, now); });
  }
  /// The nearest mate that has the patch, was not asked in this round and is not among the busy.
  std::optional<RobotId> holder(const PatchKey& key, const Want& want, double now,
                                const std::map<RobotId, std::size_t>& under_way = {}) const {
    std::optional<RobotId> best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [id, mate] : mates_) {
      if (!claims(mate, key, now)) continue;
      if (const auto t = want.tries.find(id);
          t != want.tries.end() && t->second.round == want.round)
        continue;
      if (const auto n = under_way.find(id); n != under_way.end() && n->second >= options_.requests)
        continue;
      const double d = distance ? distance(id) : 0.0;
      if (best && !(d < least)) continue;
      best = id;
      least = d;
    }
    return best;
  }
  void ask(double now, std::vector<Outgoing>& out) {
    std::map<RobotId, std::size_t> under_way;
    std::vector<std::pair<double, PatchKey>> due;
    for (auto it = wanted_.begin(); it != wanted_.end();) {
      Want& want = it->second;
      if (want.asked && now >= want.deadline) want.asked.reset();
      if (want.asked) {
        ++under_way[*want.asked];
      } else {
        if (!held_by_any(it->first, now)) {  // until a mate says again to have it
          it = wanted_.erase(it);
          continue;
        }
        if (now < want.next_try) {
          ++it;
          continue;
        }
        if (!holder(it->first, want, now)) {
          want.pause = std::min(std::max(2.0 * want.pause, options_.least_timeout),
                                options_.longest_timeout);
          want.next_try = now + want.pause;
          ++want.round;
        } else {
          due.emplace_back(want.next_try, it->first);
        }
      }
      ++it;
    }
    // A mate that claims what is not there keeps its own places busy, and no other's.
    std::stable_sort(due.begin(), due.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::map<RobotId, PatchIdSet> requests;
    for (const auto& [since, key] : due) {
      Want& want = wanted_.at(key);
      const std::optional<RobotId> mate = holder(key, want, now, under_way);
      if (!mate) continue;
      want.asked = mate;
      want.tries[*mate] = {now, want.round};
      want.deadline = now + timeout(mates_.at(*mate));
      requests[*mate].insert(key);
      ++under_way[*mate];
    }
    for (const auto& [to, set] : requests) {
      ByteWriter body;
      set.put(body);
      out.push_back({MessageKind::request, to, body.take()});
    }
  }

  RobotId self_;
  PatchSyncOptions options_;
  std::map<PatchKey, Stored> store_;
  PatchIdSet held_;
  std::uint64_t sum_ = 0;
  std::size_t stored_bytes_ = 0;
  std::map<RobotId, Mate> mates_;
  std::map<PatchKey, Want> wanted_;
  std::deque<std::pair<RobotId, PatchKey>> answers_;
  std::vector<PatchKey> fresh_;
  std::vector<MapPatch> arrived_;
  double last_digest_ = -std::numeric_limits<double>::infinity(), next_digest_ = last_digest_;
  std::uint64_t said_ = 0;
  bool changed_ = false;
  MessageDrops drops_;
  std::uint64_t duplicates_ = 0;
};
}  // namespace surfleet
