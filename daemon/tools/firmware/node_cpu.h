#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "tools/firmware/fault_command.h"
#include "tools/firmware/limb.h"
#include "tools/firmware/periodic.h"
#include "tools/firmware/simulated_sensor.h"

namespace limb_ring::firmware {

/// What the CPU of one node is made of.
struct NodeSetup {
  config::NodeConfig node;
  config::Firmware firmware;
  nanoseconds command_timeout{0};
  std::uint8_t state_to = 0;  ///< destination of states and readings
};

/// The firmware without its IO: packets, interrupts and time go in, packets come out.
///
/// States go out at priority 0 and firmware.state_rate, readings at the rate and priority of
/// their sensor, all on channel 2. A sample of either kind is left out, and counted, while 64
/// packets are without a result: fresh values are worth more than old ones in a queue. What is left
/// out is missing in the sequence numbers.
class NodeCpu {
 public:
  struct Outgoing {
    std::uint8_t destination = 0;
    std::uint8_t priority = 0;
    std::uint8_t channel = 0;
    std::vector<std::uint8_t> data;
  };
  struct Counters {
    std::uint64_t sent = 0;
    std::uint64_t not_delivered = 0;  ///< results other than `delivered`
    std::uint64_t skipped = 0;        ///< samples left out, the ring being too slow
    std::uint64_t unreadable = 0;     ///< samples that could not be put into bytes
    std::uint64_t ignored = 0;        ///< packets that are nothing for this CPU
    std::uint64_t stops = 0;
    std::uint64_t notifies = 0;
  };

  /// @throw std::invalid_argument where the node has more joints than one packet carries
  NodeCpu(const NodeSetup& setup, const Timestamps& now);

  void receive(const Packet& packet, const Timestamps& now);
  void receive(const Interrupt& interrupt, const Timestamps& now);
  void receive(const limb_ring::Result& result);
  /// Simulates up to `now` and samples what is due.
  void advance(const Timestamps& now);
  /// What is to be sent; each of them gives one Result later.
  std::vector<Outgoing> take_outgoing();
  /// When advance() is to be called next, at the latest; nothing where never.
  std::optional<nanoseconds> due() const;

  const std::optional<FaultCommand>& fault_command() const { return fault_command_; }
  std::uint8_t node() const { return node_; }  ///< its id
  const Limb& limb() const { return limb_; }
  const Counters& counters() const { return counters_; }
  /// One line for people.
  std::string summary() const;

 private:
  void sample_states(const Timestamps& now);
  void sample(SimulatedSensor& sensor, const Timestamps& now);
  bool may_send();
  void send(const payload::Encoded& bytes, std::uint8_t priority);
  std::uint64_t left_out() const;

  std::uint8_t node_;  ///< id
  Limb limb_;
  std::uint8_t state_to_;
  std::optional<Periodic> states_;  // none without joints
  std::vector<SimulatedSensor> sensors_;
  std::vector<Outgoing> outgoing_;
  std::size_t without_result_ = 0;
  std::optional<FaultCommand> fault_command_;
  Counters counters_;
};

}  // namespace limb_ring::firmware
