#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <queue>
#include <vector>

#include "comparison/network.h"

namespace limb_ring::study {

/// Nodes in a ring of lines in both directions, cut-through, packets of one size: Responsive Link's
/// data links, or its event links.
class PointToPoint {
 public:
  /// @param packet on the line, @param data in it: bytes. All references must outlive this.
  PointToPoint(const Medium& medium, const std::vector<Message>& messages, unsigned packet, unsigned data,
               Deliveries& deliveries);

  /// Carries the messages of this kind, which are in the order of `asked`.
  void carry(bool interrupts);

 private:
  struct Packet {
    std::size_t message;
    unsigned line;  ///< that it waits for, or travels on: 2 * node + direction
    bool own;       ///< of the node it waits in: stands for all of its message not yet sent
    bool last;      ///< of its message
    Time ready;     ///< at the Packet Manager of the node it waits in
    std::uint64_t order;
  };
  struct Later {
    const std::vector<Message>* messages;
    bool operator()(const Packet& a, const Packet& b) const;
  };
  struct Line {
    explicit Line(Later later) : waiting(later) {}
    std::priority_queue<Packet, std::vector<Packet>, Later> waiting;
    Time free{};
  };
  struct Event {
    Time at;
    std::uint64_t order;
    bool arrival;  ///< of `packet` at the next node; else `packet.line` is free
    Packet packet;
    bool operator>(const Event& other) const { return at != other.at ? at > other.at : order > other.order; }
  };

  unsigned line_of(const Message& message) const;
  NodeId end_of(unsigned line) const;
  void ask(std::size_t message);
  void wait(Packet packet);
  void arrive(const Event& event);
  void start(unsigned line, Time now);

  const Medium& medium_;
  const std::vector<Message>& messages_;
  const Duration packet_time_;
  const unsigned data_;
  Deliveries& deliveries_;
  std::vector<unsigned> unsent_;  ///< packets of each message
  std::vector<Line> lines_;
  std::vector<unsigned> touched_;
  std::uint64_t order_ = 0;
  std::priority_queue<Event, std::vector<Event>, std::greater<Event>> events_;
};

/// Point-to-point links with priority overtaking and a separate event link: Responsive Link
/// (ISO/IEC 24740:2008; N. Yamasaki, "Responsive Link for Distributed Real-Time Processing", IWIA 2007).
///
/// The nodes form a ring of full-duplex links; a packet takes the shorter way, half-way round the
/// even nodes' the one and the odd nodes' the other. At every node the packets for a line wait by
/// priority, so a higher one overtakes all that have not begun; equal ones go in the order in which they
/// came, a tie to the node's own. A packet on the line is never interrupted. Events have lines and
/// packets of their own.
///
///   data packet   64 bytes: 56 of data, 8 of header and trailer; longer messages go as several
///   event packet  16 bytes
///
/// Assumed, in its favour: cut-through at the same relay delay d as ours; no line code and none of its
/// forward error correction; every line, event lines too, at the full rate R. So a node has four
/// lines out where our ring has one: twice the fibres and more, and several messages can be under
/// way on different parts of the ring at once. Its efficiency against R can exceed 1.
class ResponsiveLink : public Network {
 public:
  static constexpr unsigned kDataPacket = 64, kPacketData = 56, kEventPacket = 16;  ///< bytes

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// None: the lines out of a node are its own (hot plug). Routing tables are taken to know it already.
  Duration time_to_join(const Medium& medium) const override;
};

/// What the CPUs have asked for and a method has not taken yet: per node, interrupt-like messages
/// before data, then by priority, then in the order asked. (ours; every method is given the same)
class SendQueues {
 public:
  enum class Kind { all, data, interrupts };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// @param messages must outlive this
  SendQueues(const Medium& medium, const std::vector<Message>& messages, Kind kind = Kind::all);

  /// Index of the message that `node` would send at `now`, or kNone. @pre `now` never runs
  /// backwards for one node
  std::size_t head(NodeId node, Time now);
  /// Bytes of that message which were not taken yet.
  unsigned remaining(std::size_t message) const { return remaining_[message]; }
  /// Takes up to `most` bytes of a message. @return true if all of it is taken now
  bool take(std::size_t message, unsigned most);
  /// When the next message is asked for that no head() has seen yet; core::kNever: none.
  Time next_asked() const;

 private:
  struct Node {
    std::deque<std::size_t> to_come;
    std::array<std::deque<std::size_t>, kMessageClasses> asked;
  };

  const std::vector<Message>& messages_;
  std::vector<Node> nodes_;
  std::vector<unsigned> remaining_;
};

}  // namespace limb_ring::study
