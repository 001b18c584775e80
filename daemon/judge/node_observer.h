#pragma once

#include <chrono>
#include <functional>

#include "core/journal.h"
#include "core/settings.h"
#include "judge/observation.h"
#include "wire/packet_assembler.h"

namespace limb_ring::promises {

/// Makes observations of what goes into a node's network controller and comes out of it: a living one's, or what a
/// flight recorder has written down of one. (ours)
class NodeObserver final : public core::Journal {
 public:
  /// @param settings,sink must outlive this
  /// @param zero the machine's time at 0 of the controller's
  /// @param waiting returns the number of packets in the receive buffers
  /// @param goes_on how often it reports that the node goes on, and whether the receive buffers are empty
  NodeObserver(const core::Settings& settings, std::chrono::nanoseconds zero, std::function<std::size_t()> waiting,
               ObservationSink& sink, core::Duration goes_on = std::chrono::milliseconds(50));

  void goes_in(const core::Input& input, core::Time now) override;
  void goes_out(core::Line, wire::ByteView) override {}
  void taken(const core::Event& event, core::Time now) override;
  void taken(const core::ReceivedPacket& packet, core::Time now) override;

 private:
  Observation at(Observation::Kind kind, core::Time now) const;
  void say_it_goes_on(core::Time now);
  void see(const core::input::Receive& call, core::Time now);
  void see(const core::input::Send& call, core::Time now);
  void see(const core::input::Interrupt& call, core::Time now);
  void see(const core::input::Pull& call, core::Time now);
  void see(const core::input::CpuReset& call, core::Time now);
  void see(const core::input::InputGap& call, core::Time now);
  void see(const core::input::InputLost& call, core::Time now);
  template <class Other>
  void see(const Other&, core::Time) {}
  void asks_for_interrupt(const core::InterruptRequest& request, core::Time now);
  void came(wire::ByteView packet, core::Time now);

  const core::Settings& settings_;
  std::chrono::nanoseconds zero_;
  std::function<std::size_t()> waiting_;
  ObservationSink& sink_;
  core::Duration goes_on_;
  core::Time next_{};     ///< when it says again that it goes on
  core::Time came_at_{};  ///< of what is put together
  capture::PacketAssembler cut_through_;
};

/// How long a send may take at most, from its request to its result. (protocol.md sections 4.3 to 4.6)
std::chrono::nanoseconds longest_send(const core::Settings& settings);

}  // namespace limb_ring::promises
