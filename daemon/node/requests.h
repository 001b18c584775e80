#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "config/ring_config.h"
#include "node/clock_control.h"
#include "node/cpu_socket.h"
#include "node/daemon_interrupts.h"
#include "node/event_router.h"
#include "node/fault_requests.h"
#include "node/node_driver.h"
#include "node/pin_board.h"
#include "node/send_reason.h"
#include "node/status.h"
#include "node/traffic.h"

namespace limb_ring::runtime {

/// Answers what a client asks the daemon (docs/reference/requests.md).
class Requests {
 public:
  /// What requests are for. All must outlive this.
  struct Targets {
    const config::RingConfig& ring;
    const config::NodeConfig& node;
    NodeDriver& driver;
    CpuSocket& cpu;
    EventRouter& events;
    const PinBoard& pins;
    Traffic& traffic;
    DaemonInterrupts& interrupts;
    const SendReasons& reasons;
    FaultTargets faults;
    StatusSources status;
    ClockControl* virtual_clock;  ///< null on a live ring
  };
  explicit Requests(Targets targets) : to_(std::move(targets)) {}

  /// `answer` is called exactly once, now or later; with {"error": ...} where it cannot be done.
  /// @param of_cpu asked by the CPU itself
  void handle(const std::string& text, bool of_cpu, const Answer& answer);
  /// Whether the request changes something, rather than only asking.
  static bool changes_something(const std::string& text);

 private:
  using Json = nlohmann::json;
  void clock(const Json& request, const Answer& answer);
  void config(const Json& request, const Answer& answer);
  void latch(const Json& request, const Answer& answer);
  void ping(const Json& request, const Answer& answer);
  void reset(const Json& request, const Answer& answer);
  void setup(const Json& request, const Answer& answer);
  void shutdown(const Json& request, const Answer& answer);
  void stop_latched(const Json& request, bool of_cpu, const Answer& answer);
  void status(const Json& request, const Answer& answer);
  void stop(const Json& request, const Answer& answer);
  void sync(const Json& request, const Answer& answer);

  Json end_of(const core::SendEnded& ended) const;

  Targets to_;
  std::shared_ptr<void> here_ = std::make_shared<char>();  ///< gone with this: a virtual node may die before an answer
};

}  // namespace limb_ring::runtime
