#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::promises {

/// What the ring promises at every moment. (protocol.md sections 2 to 5)
enum class Promise {
  one_result,       ///< every send ends in exactly one result
  true_result,      ///< which says what has happened
  undamaged,        ///< what a CPU gets is what was sent, whole, and to it
  exactly_once,     ///< a packet is taken, a pin pulled, once, also if the receiver restarts
  in_order,         ///< packets of a source and priority leave, and are taken, in the order of asking
  priority_first,   ///< of what waits the highest priority goes first, onto the line and to the CPU
  interrupt_wait,   ///< an INTP waits for other INTPs and at most for odd bytes, trailer and CRC
  insertion_bound,  ///< of the insertion buffer
  no_circling,      ///< no packet goes on after its source is gone
  true_fbc,         ///< FBC goes on as the receivers' buffers say
  whole_again       ///< when all is mended the ring closes, and falls silent
};

constexpr const char* to_string(Promise promise) {
  switch (promise) {
    case Promise::one_result:
      return "every send ends in exactly one result";
    case Promise::true_result:
      return "a result says what has happened";
    case Promise::undamaged:
      return "nothing corrupted, truncated or sent to another node is delivered";
    case Promise::exactly_once:
      return "exactly once";
    case Promise::in_order:
      return "order is kept per source and priority";
    case Promise::priority_first:
      return "the highest priority goes first";
    case Promise::interrupt_wait:
      return "an INTP waits at most for other INTPs and for a piece of a DATP";
    case Promise::insertion_bound:
      return "the insertion buffer keeps its bound";
    case Promise::no_circling:
      return "no packet goes on round the ring after its source is gone";
    case Promise::true_fbc:
      return "FBC is truthful";
    case Promise::whole_again:
      return "when all is mended the ring closes and falls silent";
  }
  return "";
}

/// One thing that was seen at a node from outside its network controller: what its CPU asked for and was told, what its
/// CPU was given, its pins. All that judging the ring's promises needs, in as few bytes as possible. (ours)
struct Observation {
  enum class Kind : std::uint8_t {
    asked,    ///< its CPU, or a helper, asks for a send
    ended,    ///< and is told how that ended
    taken,    ///< its CPU gets a packet
    pin,      ///< a pin is pulled
    passed,   ///< the first try of a broadcast of another node has come in, whole and with a good CRC
    circles,  ///< a packet has come in that has gone all the way round
    flushed,  ///< its CPU was reset: the receive buffers are emptied
    state,    ///< it shows another state
    goes_on   ///< nothing but that; at least every 50 ms while the node does anything
  };
  static constexpr std::uint8_t kInterrupt = 4;  ///< as `queue`

  std::int64_t at_ns = 0;      ///< by the node's clock; nodes of one host share it
  std::uint32_t checksum = 0;  ///< CRC-32 of the data
  std::uint32_t owner = 0, token = 0;
  std::uint16_t size = 0;  ///< bytes of data; circles: HOP
  Kind kind = Kind::goes_on;
  std::uint8_t source = 0;       ///< taken, pin, passed, circles
  std::uint8_t destination = 0;  ///< 255: all
  std::uint8_t queue = 0;        ///< priority 0..3, or kInterrupt; ended: 0 or kInterrupt
  std::uint8_t channel = 0;      ///< of an INTP its factor
  std::uint8_t detail = 0;  ///< ended: wire::Outcome; state: core::NodeState; goes_on: the receive buffers are empty
  std::uint8_t tries = 0;   ///< ended

  /// One was asked for, and the other is its end. @pre both of one node
  bool same_send(const Observation& other) const { return token == other.token && owner == other.owner; }
};
static_assert(sizeof(Observation) == 32 && std::is_trivially_copyable_v<Observation>);

/// Gets observations of one node, in their order.
class ObservationSink {
 public:
  virtual ~ObservationSink() = default;
  virtual void put(const Observation& seen) = 0;
};

}  // namespace limb_ring::promises

namespace limb_ring::sim {

using promises::Promise;
using promises::to_string;

/// A sentence, and where in it nodes are named by their ids. Who knows other names for them puts these there.
class Words {
 public:
  /// An id of `size` digits, from byte `at` of the text on.
  struct Mention {
    std::size_t at = 0, size = 0;
    wire::NodeId node{0};

    template <class Archive>
    void archive(Archive& a) {
      a("at", at)("size", size)("node", node);
    }
  };

  Words() = default;
  Words(std::string text) : text_(std::move(text)) {}
  Words(const char* text) : text_(text) {}
  operator const std::string&() const { return text_; }

  const std::string& text() const { return text_; }
  /// In the order in which they stand there.
  const std::vector<Mention>& mentions() const { return mentions_; }

  friend Words operator+(Words one, const Words& other) {
    for (const Mention& mention : other.mentions_)
      one.mentions_.push_back({one.text_.size() + mention.at, mention.size, mention.node});
    one.text_ += other.text_;
    return one;
  }
  /// "node 5"
  friend Words node_words(wire::NodeId node) {
    Words words = "node ";
    const std::string id = std::to_string(node);
    words.mentions_.push_back({words.text_.size(), id.size(), node});
    words.text_ += id;
    return words;
  }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("text", text_)("mentions", mentions_);
  }

 private:
  std::string text_;
  std::vector<Mention> mentions_;
};
Words node_words(wire::NodeId node);

/// A promise that was broken.
struct Violation {
  Promise promise;
  core::Time at;
  Words words;  ///< the nodes and packets involved

  const std::string& what() const { return words.text(); }
};
using Complain = std::function<void(Promise, Words)>;

}  // namespace limb_ring::sim
