#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::live {

/// What a node's daemon lets see (`observe`), which may die, stand still and come back. (ours)
class ObservedDaemon {
 public:
  /// @param node its id
  /// @param what it is asked to let see, in JSON
  /// @param runtime as ConnectOptions
  ObservedDaemon(const std::string& ring, std::uint8_t node, std::string what, const std::string& runtime = {});

  bool connected() const { return port_.has_value(); }
  /// Looks for it, four times a second at most, and waits 200 ms at most for its answer. @return true where it is there
  /// now
  bool look_for();
  /// The next of what it has let see. @return nothing where no more is there now, and where it is gone
  std::optional<std::string> next();
  /// To be looked for again.
  void drop() { port_.reset(); }
  /// From its clock to dates since 1970. @pre connected()
  std::chrono::nanoseconds to_date() const { return port_->stamp() - port_->now(); }

 private:
  using Clock = std::chrono::steady_clock;

  ConnectOptions daemon_;
  std::string folder_;
  std::uint8_t node_;
  std::string what_;
  std::optional<HostPort> port_;
  Clock::time_point next_try_{};
};

}  // namespace limb_ring::live
