#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <boost/intrusive/list.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "judge/promise.h"
#include "wire/packet.h"

namespace limb_ring::promises {

/// A promise that was not kept.
struct Breach {
  Promise promise;
  std::uint8_t node = 0;    ///< at which
  std::uint8_t source = 0;  ///< of the packet
  std::int64_t at_ns = 0;   ///< by the nodes' clock
  std::string what;         ///< the packet, and what became of it
};

/// Why something could not be judged.
enum class Unjudged : std::uint8_t {
  receiver_unknown,    ///< nobody looks at the receiver, or not long enough
  receiver_restarted,  ///< the receiver or its CPU was restarted meanwhile
  source_unknown,      ///< nobody looks at the source, or not long enough
  observations_lost,   ///< they came too fast
  ring_changed,        ///< a broadcast, while nodes came or went
  alike,               ///< beside others of the same data, of which one may have been taken or not
  too_many             ///< too much is under way
};
constexpr std::size_t kUnjudged = 7;
const char* to_string(Unjudged why);

/// What was judged, and what was not.
struct JudgeCounts {
  std::uint64_t sends = 0;    ///< asked for
  std::uint64_t judged = 0;   ///< of those
  std::uint64_t packets = 0;  ///< given to CPUs; and pins pulled
  std::uint64_t lost = 0;     ///< observations
  std::uint64_t breaches = 0;
  std::array<std::uint64_t, kUnjudged> unjudged{};  ///< sends and packets, by why

  std::uint64_t all_unjudged() const;
};
/// "1200 sends, 1180 packets; not judged: 3 (the receiver was restarted)"
std::string describe(const JudgeCounts& counts);

/// Where the judge reports broken promises, and counts what it could not judge.
class JudgeReport {
 public:
  using OnBreach = std::function<void(const Breach&)>;
  /// @param told_again for this time, a breach of the same promise at the same node and source is not told again
  JudgeReport(OnBreach on_breach, std::chrono::nanoseconds told_again)
      : on_breach_(std::move(on_breach)), told_again_(told_again) {}

  void break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at, std::string what);
  /// Counts something that cannot be judged. @return true, for callers that return whether they are done with it
  bool leave_unjudged(Unjudged why) {
    ++counts.unjudged[static_cast<std::size_t>(why)];
    return true;
  }

  JudgeCounts counts;

 private:
  OnBreach on_breach_;
  std::chrono::nanoseconds told_again_;
  std::map<std::tuple<Promise, std::uint8_t, std::uint8_t>, std::int64_t> told_;  ///< when, of node and source
};

/// How long the judge waits before it is sure, by the nodes' clock.
struct JudgeTimes {
  std::chrono::nanoseconds copies_last = std::chrono::seconds(1);  ///< on the lines, of a send that has ended
  std::chrono::nanoseconds kept =
      std::chrono::milliseconds(500);  ///< what is done with, so that a second copy is known
  std::chrono::nanoseconds step = std::chrono::milliseconds(250);  ///< in a longer one a node was stopped
  std::chrono::nanoseconds told_again = std::chrono::seconds(1);   ///< the same of a node and source
};

/// What a receiver sees of a packet's content.
constexpr std::uint64_t content_of(const Observation& seen) {
  return std::uint64_t{seen.checksum} << 32 | std::uint64_t{seen.size} << 8 | seen.channel;
}

using Round = std::uint32_t;
constexpr std::size_t kQueues = 5, kNodes = 256;

/// At which nodes a broadcast was.
struct ByNode {
  std::array<std::uint16_t, kNodes> taken_in{};
  std::bitset<kNodes> passed;
};

/// One send as its source was asked for it, and what was seen of it since.
struct Sent {
  using Link = boost::intrusive::list_member_hook<boost::intrusive::link_mode<boost::intrusive::normal_link>>;

  Observation asked;
  std::uint64_t index = 0;  ///< in the order of asking, within its queue; from 1
  Round asked_round = 0, ended_round = 0;
  std::int64_t asked_alive = 0, ended_at = 0, taken_at = 0;
  bool ended = false, judged = false, cut_short = false;
  wire::Outcome outcome{};
  std::uint8_t tries = 0;
  std::uint16_t taken_life = 0;     ///< of the receiver, in which it took it; 0: it has not
  std::unique_ptr<ByNode> by_node;  ///< of a broadcast
  Link among_alike;

  /// Life of that receiver in which it took it; 0: it has not.
  std::uint16_t& taken_in(std::uint8_t receiver) { return by_node ? by_node->taken_in[receiver] : taken_life; }
  /// It has ended, and nobody has taken it: it was refused, met nobody, or never left.
  bool is_untaken() const;
  void end(wire::Outcome how, Round round, std::int64_t at) {
    ended = true;
    outcome = how;
    ended_round = round;
    ended_at = at;
  }
  /// Ends it although its result will never be seen.
  void cut(Round round, std::int64_t at) {
    end(wire::Outcome::cancelled, round, at);
    cut_short = true;
  }
};

/// Sends of one content, in the order of asking.
using Alike = boost::intrusive::list<Sent, boost::intrusive::member_hook<Sent, Sent::Link, &Sent::among_alike>>;

/// Sends of one source, queue and destination, in the order of asking.
struct Flow {
  std::uint8_t source, queue, destination;
  std::deque<Sent> sends = {};
  /// Those in `sends` by content_of(), in the order of asking. Nothing tells which of several a receiver has taken: the
  /// one that a taken packet is found to be is a guess, which may be corrected, and their order is not judged.
  std::unordered_map<std::uint64_t, Alike> alike = {};
  std::size_t first_open = 0;      ///< those before it have ended
  std::size_t first_unjudged = 0;  ///< those before it are judged
  bool listed = false;             ///< in SeenRing::active

  Sent& add(const Observation& asked);
  /// Null if it has none of that content.
  Alike* find_alike(const Observation& like);
  void pop_front();
  void clear();
};

/// How many sends of one content were forgotten while others of it are still known. Of none of them it is certain
/// whether it was taken; `taken` were found to be, `untaken` were not.
struct Former {
  unsigned taken = 0, untaken = 0;
};

/// Something that was taken, but whose send has not been found yet.
struct Pending {
  Observation seen;
  Round round;
  std::uint16_t life;     ///< of the receiver
  std::int64_t empty_at;  ///< when the receiver's buffers were last seen empty
};

/// A node, and what was seen at it.
struct SeenNode {
  bool known = false, closing = false;
  bool after_loss = false;                       ///< known again from the next observation on
  bool seen_before = false;                      ///< it has begun once at least
  Unjudged before = Unjudged::receiver_unknown;  ///< why what was at it before `known_at` is not judged
  Round known_round = 0, flushed_round = 0, state_round = 0, empty_round = 0, seen_round = 0;
  std::int64_t known_at = 0, at = 0, empty_at = 0;
  std::int64_t alive = 0;  ///< for so long it was seen to go on, ns
  std::int64_t longest_send = 0;
  std::uint8_t state = 0;
  std::uint16_t life = 1;
  std::vector<std::unique_ptr<Flow>> flows;  ///< by queue and destination
  std::array<std::uint64_t, kQueues> asked{};
  std::array<std::int64_t, kQueues> proven_at{};  ///< since then nothing is under way that was not seen; 0: never
  std::vector<std::uint64_t> newest;              ///< index of what it took last, by source and queue
  std::deque<Pending> pending;
  std::map<std::tuple<std::uint8_t, std::uint8_t, std::uint8_t, std::uint64_t>, Former> former;  ///< SeenRing::key()

  /// Something of that flow was taken, and it is not known yet which send it was.
  bool has_pending(const Flow& flow) const;
};

/// All that was seen of a ring and is not done with. (ours)
struct SeenRing {
  Round round = 10;
  std::vector<SeenNode> nodes{kNodes};
  std::vector<std::uint8_t> known;  ///< ids
  std::vector<Flow*> active;        ///< in which something is not done with

  SeenNode& at(std::uint8_t id) { return nodes[id]; }
  const SeenNode& at(std::uint8_t id) const { return nodes[id]; }
  Flow& flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination);
  /// Null if nothing was asked for in it.
  Flow* find_flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) const;
  /// Visits the sends that look the same at the receiver: a pin does not show whether the INTP was a broadcast.
  /// @param visit returns true to stop @return whether one did
  template <class Visit>
  bool any_alike(const Flow& flow, std::uint8_t receiver, const Observation& like, Visit visit) const {
    const std::uint8_t other_way = flow.destination == wire::kBroadcast ? receiver : std::uint8_t{wire::kBroadcast};
    for (const std::uint8_t destination : {flow.destination, other_way}) {
      const bool told_apart = flow.queue != Observation::kInterrupt && destination != flow.destination;
      Flow* one = told_apart ? nullptr : find_flow(flow.source, flow.queue, destination);
      Alike* alike = one == nullptr ? nullptr : one->find_alike(like);
      if (alike != nullptr && std::any_of(alike->begin(), alike->end(), visit)) return true;
    }
    return false;
  }
  /// What those have in common that look the same as such a packet: source, queue, destination, content.
  static auto key(const Flow& flow, const Observation& like) {
    const bool interrupt = flow.queue == Observation::kInterrupt;
    return std::make_tuple(flow.source, flow.queue, interrupt ? std::uint8_t{0} : flow.destination, content_of(like));
  }
  bool has_former(const Flow& flow, std::uint8_t receiver, const Observation& like) const {
    return at(receiver).former.count(key(flow, like)) != 0;
  }
  /// What was taken may be a forgotten send that was not found to be taken: it is from now on.
  bool stands_for_former(const Flow& flow, std::uint8_t receiver, const Observation& taken);
  /// The other way: a forgotten one was found to be taken that need not have been, and this send was meant.
  bool former_stands_for(const Flow& flow, std::uint8_t receiver, const Observation& missing);
  /// Index of what that receiver took last from that source and queue.
  std::uint64_t& newest(std::uint8_t receiver, std::uint8_t source, std::uint8_t queue);
};

/// "DATP of node 3 to 12, priority 0, channel 4, 100 bytes"
std::string name_of(const Observation& packet, std::uint8_t source);
/// The same, with its token.
std::string name_of(const Flow& flow, const Sent& sent);

}  // namespace limb_ring::promises
