#pragma once

#include <array>
#include <bitset>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "promises/observation.h"
#include "promises/promise.h"

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
  too_many             ///< too much is under way
};
constexpr std::size_t kUnjudged = 6;
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

/// How long the judge waits before it is sure, by the nodes' clock.
struct JudgeTimes {
  std::chrono::nanoseconds copies_last = std::chrono::seconds(1);  ///< on the lines, of a send that has ended
  std::chrono::nanoseconds kept =
      std::chrono::milliseconds(500);  ///< what is done with, so that a second copy is known
  std::chrono::nanoseconds step = std::chrono::milliseconds(250);  ///< in a longer one a node was stopped
  std::chrono::nanoseconds told_again = std::chrono::seconds(1);   ///< the same of a node and source
};

/// Judges a ring's promises over all of its nodes together: each send has one result, what is delivered has arrived, at
/// most once and in order, pins are pulled once, nothing circles. It is told what was seen at each node, living or
/// recorded.
///
/// It compares no clocks of two nodes. Observations come in rounds: what a node has seen by the end of one round has
/// its causes at other nodes, and these have been seen by the end of the next. So whoever calls it reads in each round
/// from every node all there is, or in order of time where the clock is one. (ours)
class PromiseJudge {
 public:
  using OnBreach = std::function<void(const Breach&)>;
  /// @param fold_back the ring has a second line
  PromiseJudge(bool fold_back, OnBreach on_breach, const JudgeTimes& times = {})
      : fold_back_(fold_back), on_breach_(std::move(on_breach)), times_(times) {}

  /// From now on that node is seen. @param state as Observation::detail. @param longest_send see longest_send()
  void begins(std::uint8_t node, std::uint8_t state, std::chrono::nanoseconds longest_send, std::int64_t at_ns);
  void see(std::uint8_t node, const Observation& seen);
  /// Observations of that node are missing here.
  void lost(std::uint8_t node, std::uint64_t count);
  /// Its daemon has gone, or will: more of it may still be read, and another life of it may send already, unseen.
  void closes(std::uint8_t node) { at(node).closing = true; }
  /// It is dead; all there was has been told.
  void ends(std::uint8_t node);
  /// Nobody looks at it any more.
  void leaves(std::uint8_t node);
  void round_is_over();

  const JudgeCounts& counts() const { return counts_; }

 private:
  using Round = std::uint32_t;
  static constexpr std::size_t kQueues = 5, kNodes = 256;

  /// At which nodes a broadcast was.
  struct ByNode {
    std::array<std::uint16_t, kNodes> taken_in{};
    std::bitset<kNodes> passed;
  };
  struct Sent {
    Observation asked;
    std::uint64_t index = 0;  ///< in the order of asking, within its queue; from 1
    Round asked_round = 0, ended_round = 0;
    std::int64_t asked_alive = 0, ended_at = 0, taken_at = 0;
    bool ended = false, judged = false, cut_short = false;
    std::uint8_t outcome = 0, tries = 0;
    std::uint16_t taken_in = 0;       ///< life of the receiver in which it took it; 0: it has not
    std::unique_ptr<ByNode> by_node;  ///< of a broadcast
  };
  /// Sends of one source, queue and destination, in the order of asking.
  struct Flow {
    std::uint8_t source, queue, destination;
    std::deque<Sent> sends;
    std::size_t first_open = 0;  ///< those before it have ended
    bool listed = false;         ///< in active_
  };
  /// What was taken, and whose send has not been found yet.
  struct Pending {
    Observation seen;
    Round round;
    std::int64_t empty_at;  ///< when the receiver's buffers were last seen empty
  };
  struct Node {
    bool known = false, closing = false;
    Round known_round = 0, flushed_round = 0, state_round = 0, empty_round = 0, seen_round = 0;
    std::int64_t known_at = 0, at = 0, empty_at = 0;
    std::int64_t alive = 0;  ///< for so long it was seen to go on, ns
    std::int64_t longest_send = 0;
    std::uint8_t state = 0;
    std::uint16_t life = 1, pins_life = 1;
    std::vector<std::unique_ptr<Flow>> flows;  ///< by queue and destination
    std::array<std::uint64_t, kQueues> asked{};
    std::array<std::int64_t, kQueues> proven_at{};  ///< since then nothing is under way that was not seen; 0: never
    std::vector<std::uint64_t> newest;              ///< index of what it took last, by source and queue
    std::deque<Pending> pending;
  };

  Node& at(std::uint8_t id) { return nodes_[id]; }
  Flow& flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination);
  Flow* find_flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination);
  std::uint64_t& newest(std::uint8_t receiver, std::uint8_t source, std::uint8_t queue);
  std::uint16_t life_of(std::uint8_t receiver, std::uint8_t queue) const;
  static std::uint16_t& taken_in(Sent& sent, std::uint8_t receiver);

  void asked(std::uint8_t id, const Observation& seen);
  void ended(std::uint8_t id, const Observation& seen);
  Sent* find_open(std::uint8_t id, const Observation& seen);
  void ended_again(std::uint8_t id, const Observation& seen);
  void taken(std::uint8_t id, const Observation& seen);
  bool match(std::uint8_t receiver, const Observation& seen);
  Sent* next_in_order(std::uint8_t receiver, Flow* flow, const Observation& seen);
  void passed(std::uint8_t id, const Observation& seen);
  bool mark_passed(std::uint8_t id, const Observation& seen);
  void state(std::uint8_t id, std::uint8_t after);
  void forget_sends(Node& node, Unjudged why);

  void settle_pending(std::uint8_t receiver);
  void classify(std::uint8_t receiver, const Pending& pending);
  bool certain(std::uint8_t receiver, const Pending& pending) const;
  bool has_pending(const Node& receiver, const Flow& flow) const;

  void settle(Flow& flow);
  bool judge(Flow& flow, Sent& sent);
  bool judge_open(Flow& flow, Sent& sent);
  bool judge_unicast(Flow& flow, Sent& sent);
  bool judge_taken(Flow& flow, Sent& sent);
  bool judge_missing(Flow& flow, Sent& sent, std::uint8_t receiver);
  bool judge_broadcast(Flow& flow, Sent& sent);
  bool is_done_with(const Flow& flow, const Sent& sent) const;
  bool is_over_at(std::uint8_t receiver, const Flow& flow, const Sent& sent) const;
  bool is_over_everywhere(const Flow& flow, const Sent& sent) const;
  bool is_in_ring_since(std::uint8_t id, const Sent& sent) const;
  template <class Visit>
  bool any_alike(const Flow& flow, const Sent& sent, std::uint8_t receiver, Visit visit);
  bool taken_for_other(Flow& flow, Sent& sent, std::uint8_t receiver);
  bool other_was_meant(Flow& flow, Sent& sent, std::uint8_t receiver);

  std::string name(const Flow& flow, const Sent& sent) const;
  void break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at, std::string what);
  bool leave(Unjudged why) {
    ++counts_.unjudged[static_cast<std::size_t>(why)];
    return true;
  }

  bool fold_back_;
  OnBreach on_breach_;
  JudgeTimes times_;
  Round round_ = 10;
  std::vector<Node> nodes_{kNodes};
  std::vector<std::uint8_t> known_;  ///< ids
  std::vector<Flow*> active_;
  JudgeCounts counts_;
  std::map<std::tuple<Promise, std::uint8_t, std::uint8_t>, std::int64_t> told_;  ///< when, of node and source
};

}  // namespace limb_ring::promises
