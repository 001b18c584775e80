#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "io/datagram_input.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// A node that is not ours on a virtual ring: its code is a shared library with the three functions that `ringctl
/// conform
/// --library` calls, too (tiny_node/examples/library_node.c). It is called with the ring's time, at every millisecond
/// and for every slice, and sees datagrams as from UDP lines (protocol.md section 6.5). So a run with it is the same
/// each time. Its neighbours' ends of these lines are played here. (ours)
class LibraryNode final : private sim::Guest {
 public:
  /// Puts it into the ring, switched off. @param ring, config, node outlive this
  /// @pre the ring does not fold back, and runs all of the time in which this lives
  LibraryNode(sim::VirtualRing& ring, const config::RingConfig& config, const config::NodeConfig& node);
  ~LibraryNode() override;

  /// Its firmware starts, in memory of its own, as after power-on.
  /// @throw std::runtime_error if the file is no such library: names it and what is missing
  void switch_on();
  /// Its neighbours bypass it.
  void switch_off();
  /// It stands still, and its neighbours bypass it; later it goes on where it stood.
  void freeze();
  void thaw();

 private:
  struct Code;
  struct FarEnd;

  void wired_from(wire::NodeId from) override;
  void input_gone() override { before_.reset(); }
  void wired_to(wire::NodeId to) override;
  void output_gone() override;
  void receive(const wire::Slice& slice, core::Time now) override;
  void give_out(wire::SliceWriter& slices) override { slices.take(out_); }

  /// The asking end of the line into it.
  struct NearEnd {
    wire::NodeId id;
    std::uint64_t session;
    bool accepted = false;
    std::uint32_t sequence = 0;
    link::Silence silence;
  };

  void wake_at(core::Time when);
  void turn();
  void keep_lines();
  void sent(std::uint32_t to, wire::ByteView datagram);
  void take_of_input(const link::LinkHeader& header);
  link::LinkHeader header(link::LinkHeaderType type) const;
  void ask();
  void send_slices(wire::ByteView slices);
  void tell(std::uint32_t from, wire::ByteView datagram);
  void lost(std::string_view reason);
  template <class Call>
  void call(Call function);
  std::uint32_t milliseconds() const;
  link::Time link_time() const;
  link::Identity identity(wire::NodeId id) const;

  sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  const config::NodeConfig& node_;
  wire::NodeId id_;
  link::Timing timing_;
  link::Agreement agreement_;
  std::unique_ptr<Code> code_;             ///< null: switched off
  std::shared_ptr<LibraryNode*> running_;  ///< for what comes at a later instant
  std::uint64_t starts_ = 0, asked_ = 0;
  std::unique_ptr<NearEnd> before_;
  std::unique_ptr<FarEnd> after_;
  std::vector<std::pair<std::uint32_t, std::vector<std::uint8_t>>> inbox_;  ///< answers: they come at its next turn
  wire::SliceWriter out_;
  bool lost_ = false;  ///< one of its lines, in this turn
};

}  // namespace limb_ring::virtual_host
