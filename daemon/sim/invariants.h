#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "sim/forwarding_checker.h"
#include "sim/ledger.h"
#include "sim/receive_buffers.h"
#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Checks every promise of the ring at every event of a virtual ring, from outside: it reads the
/// slices on the lines, what CPUs ask for and get, and how many buffers are free. The first broken
/// promise is kept.
class Invariants : public Observer {
 public:
  /// Watches `ring` from now on; must live as long as it runs.
  explicit Invariants(VirtualRing& ring);

  const std::optional<Violation>& violation() const { return violation_; }
  /// At the end, when nothing is under way any more: everything asked for must have ended.
  void finish();

  void asked(NodeId node, const core::SendRequest& request, Time now) override;
  void asked(NodeId node, const core::InterruptRequest& request, Time now) override;
  void leaves(NodeId node, const wire::Slice& slice, Time now) override;
  void arrives(NodeId node, const wire::Slice& slice, Time now) override;
  void has_arrived(NodeId node, const wire::Slice& slice, Time now) override;
  void event(NodeId node, const core::Event& event) override;
  void packet(NodeId node, const core::ReceivedPacket& packet) override;
  void incident(NodeId node, Incident incident, Time now, Line line) override;

 private:
  /// What the node had counted, and how many buffers were free, before a slice came in.
  struct Before {
    std::uint64_t taken, refused, repeated, bad, pulled, returned, dropped, stray;
    std::size_t free;
  };
  struct Node {
    Node(const core::Settings& settings, Ledger& ledger, const Complain& complain)
        : forwarding(settings.id, settings.byte_time_out, settings.byte_time_in, complain),
          buffers(settings.id, ledger, complain) {}
    ForwardingChecker forwarding;
    ReceiveBuffers buffers;
    std::optional<PacketHeader> coming;  ///< header of the DATP that is coming in
    bool passes_on = false;              ///< it is not dropped
    std::uint64_t no_output = 0;         ///< dropped for that when something last came in
    std::size_t coming_size = 0;         ///< bytes of it that have come
    PacketHeader going;                  ///< of the one that is leaving
    Time going_since{};
    std::size_t going_size = 0;      ///< bytes of it that have left
    Time interrupt_free{};           ///< its last own INTP ended
    std::optional<Time> away_since;  ///< killed or frozen
    Before before{};
  };

  static bool whole_or_end(const wire::Slice& slice) {
    return slice.kind == wire::SliceKind::whole || slice.kind == wire::SliceKind::end;
  }
  Before count(NodeId node, wire::Priority priority) const;
  Node& at(NodeId node) { return *nodes_[node]; }
  void check_head(NodeId node, const PacketHeader& head);
  void check_source(NodeId node, const PacketHeader& head, Time now);
  void data_leaves(NodeId node, const wire::Slice& slice, Time now);
  void interrupt_leaves(NodeId node, const wire::Slice& slice, Time now);
  void data_has_arrived(NodeId node, const wire::Slice& slice, const Before& after, Time now);
  void interrupt_has_arrived(NodeId node, const wire::Slice& slice, const Before& after, Time now);
  int due_fbc(NodeId node, const Sent* sent, const PacketTrailer& tail, const Before& after) const;
  Time last_bit(NodeId node, std::size_t tail_size, Time now) const;
  void check_insertion(NodeId node);
  void complain(Promise promise, std::string what);

  VirtualRing& ring_;
  Complain complain_;
  Ledger ledger_;
  std::vector<std::unique_ptr<Node>> nodes_;
  bool faults_ = false;  ///< something was lost, damaged or ended: some bounds are wider
  Time late_{};          ///< a line has let go of what it held back
  std::optional<Violation> violation_;
};

}  // namespace limb_ring::sim
