#pragma once

#include <map>
#include <memory>
#include <random>

#include "core/ring_fixture.h"

namespace limb_ring::core {

/// A ring under random traffic and random faults, all of it decided by the seed. It keeps a record
/// of every send and pin, and afterwards states what was broken of what the ring promises.
class RandomRun {
 public:
  explicit RandomRun(std::uint64_t seed);
  void run();
  /// One line per broken promise; empty where all were kept.
  const std::vector<std::string>& broken() const { return broken_; }
  /// Sends (not interrupts) that ended so.
  unsigned ended(Outcome outcome) const;
  std::string describe() const;

 private:
  struct Sent {
    NodeId source, destination;
    std::uint8_t priority;
    std::uint64_t source_life;
    Bytes data;
    bool ended = false;
    SendEnded end;
    std::map<std::pair<NodeId, std::uint64_t>, unsigned> receipts;  ///< by node and life
  };
  struct Interrupt {
    NodeId source, destination;
    std::uint8_t factor;
    std::uint64_t source_life;
    bool ended = false;
    SendEnded end;
  };
  struct Bounds {
    unsigned least = 0, most = 0;
  };
  using Key = std::pair<NodeId, std::uint32_t>;

  unsigned random(unsigned below) { return static_cast<unsigned>(random_() % below); }
  bool chance(double probability) { return std::uniform_real_distribution<>()(random_) < probability; }
  NodeId random_node() { return static_cast<NodeId>(random(nodes_)); }
  NodeId random_destination();

  void choose_mix();
  void make_ring();
  void arm_lines();
  void pass(NodeId node, const wire::Slice& slice, wire::SliceWriter& arriving);
  void act();
  void send();
  void interrupt();
  void fault();
  void kill(NodeId node);
  void restart(NodeId node);
  void freeze_or_return(NodeId node);
  void read_all(NodeId node);

  void on_event(NodeId node, const Event& event);
  void on_state(NodeId node, NodeState state);
  void on_packet(NodeId node, const ReceivedPacket& packet);
  void check_order(NodeId node, const ReceivedPacket& packet, std::uint32_t serial);

  void calm_down();
  void check_ends();
  void check_send(std::uint32_t serial, const Sent& sent);
  void check_interrupts();
  void add_bounds(const Interrupt& sent, unsigned node, Bounds& bounds) const;
  void check_silence();
  void complain(const std::string& what) { broken_.push_back(what); }

  std::uint64_t seed_;
  std::mt19937_64 random_;
  unsigned nodes_ = 16;
  bool paced_ = false;
  double drop_ = 0, damage_ = 0, trouble_ = 0;
  bool quiet_ = false;
  std::uint64_t slices_when_quiet_ = 0;
  std::unique_ptr<VirtualRing> ring_;
  std::vector<std::uint64_t> lives_;
  std::vector<bool> killed_;
  std::vector<bool> was_away_;             ///< killed or frozen at some time
  std::vector<Sent> sent_;                 ///< by serial number
  std::map<Key, std::uint32_t> serials_;   ///< by source and token
  std::map<Key, Interrupt> interrupts_;
  std::map<std::array<unsigned, 3>, unsigned> pulls_;  ///< by source, destination, factor
  std::map<std::array<std::uint64_t, 5>, std::uint32_t> newest_;
  std::vector<std::string> broken_;
};

}  // namespace limb_ring::core
