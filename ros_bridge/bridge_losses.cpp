#include "ros_bridge/bridge_losses.h"

#include <algorithm>
#include <utility>

#include "ros_bridge/node_health.h"

namespace limb_ring::bridge {

BridgeLosses::BridgeLosses() : recent_(kWarnFor) {}

// They begin at 0 together with this: the first report may tell of losses already.
void BridgeLosses::take(const Counters::Values& losses, Clock::time_point now) {
  for (const auto& [name, value] : losses) {
    const std::uint64_t before = std::exchange(last_[name], value);
    if (value > before) recent_.note(name, name + " +" + std::to_string(value - before), now);
  }
}

void BridgeLosses::tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now) {
  std::string lost;
  recent_.each(now, [&](const std::string& text) { lost += (lost.empty() ? "" : ", ") + text; });
  if (lost.empty()) return;
  constexpr int kWarn = diagnostic_msgs::DiagnosticStatus::WARN;
  out.summary(static_cast<unsigned char>(std::max<int>(out.level, kWarn)),
              out.message + "; lately lost by the bridge: " + lost);
}

}  // namespace limb_ring::bridge
