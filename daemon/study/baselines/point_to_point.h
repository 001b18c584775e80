#pragma once

#include <queue>
#include <vector>

#include "study/baselines/deliveries.h"

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

}  // namespace limb_ring::study
