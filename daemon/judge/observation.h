#pragma once

#include <cstdint>
#include <type_traits>

namespace limb_ring::promises {

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

  bool same_content(const Observation& other) const {
    return checksum == other.checksum && size == other.size && channel == other.channel;
  }
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
