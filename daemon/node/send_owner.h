#pragma once

#include <cstdint>

#include "core/events.h"
#include "node/host_handler.h"

namespace limb_ring::runtime {

/// Who asked the network controller for a send, and so who is told how it ended. The core carries it as an opaque
/// core::Owner; that is made and read here alone. (ours)
struct SendOwner {
  enum class Kind : std::uint8_t {
    client,             ///< of the host port: a tool or the CPU, also where it pulls an interrupt input
    traffic,            ///< packets that the daemon makes to time them
    daemon_interrupts,  ///< interrupts that the daemon itself sends
    babbling_cpu,       ///< packets of a CPU that babbles on purpose
    ring_user           ///< who asks a virtual ring itself, such as a scenario
  };
  Kind kind = Kind::client;
  host::ClientId client = 0;  ///< of a client: which; they count up from 1

  static constexpr SendOwner of(host::ClientId client) { return {Kind::client, client}; }
  static constexpr SendOwner of(Kind kind) { return {kind, 0}; }

  constexpr core::Owner to_core() const {
    return kind == Kind::client ? client : kFirstInternal + static_cast<core::Owner>(kind);
  }
  /// @pre made by to_core()
  static constexpr SendOwner from_core(core::Owner owner) {
    return owner < kFirstInternal ? of(owner) : of(static_cast<Kind>(owner - kFirstInternal));
  }

 private:
  static constexpr core::Owner kFirstInternal = 0xFFFFFF00;
};

}  // namespace limb_ring::runtime
