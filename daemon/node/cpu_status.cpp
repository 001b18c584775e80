#include "node/cpu_status.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "config/ring_config.h"
#include "io/program.h"

namespace limb_ring::runtime {

SilenceWatch::SilenceWatch(event_loop::NodeClock& clock, std::function<void()> on_silent)
    : clock_(clock), on_silent_(std::move(on_silent)), timer_(clock.timer([this] { time_over(); })) {}

void SilenceWatch::begin(milliseconds alive_period) {
  timer_->cancel();
  alive_period_ = alive_period;
  spoke_ = clock_.now();
  silent_ = false;
  watch();
}

bool SilenceWatch::spoke(Time now) {
  spoke_ = now;
  if (!std::exchange(silent_, false)) return false;
  watch();
  return true;
}

SilenceWatch::Time SilenceWatch::silent_at() const {
  return spoke_ + config::CpuConfig::kSilentPeriods * alive_period_;
}

void SilenceWatch::watch() {
  if (alive_period_.count() > 0) watch_until(silent_at());
}

void SilenceWatch::watch_until(Time when) {
  over_at_ = when;
  timer_->expires_at(when);
}

void SilenceWatch::time_over() {
  const Time now = clock_.now();
  if (now < silent_at()) return watch();  // it spoke meanwhile
  // If this daemon itself was not scheduled in time, the CPU perhaps was not either: give it another period.
  const bool late = now - over_at_ > alive_period_ / 4;
  if (late) return watch_until(now + alive_period_);
  silent_ = true;
  on_silent_();
}

PinCommands::PinCommands(boost::asio::io_context& io, std::chrono::milliseconds deadline, process::ProcessHandle::By by)
    : deadline_(deadline), slots_{Slot{io, by}, Slot{io, by}, Slot{io, by}, Slot{io, by}} {
  static_assert(kAtOnce == 4);
}

std::string PinCommands::run(const std::vector<std::string>& command, process::SpawnRequest request) {
  if (command.empty()) return refuse("the pin's command is empty");
  Slot* slot = free_slot();
  if (slot == nullptr) return refuse(std::to_string(kAtOnce) + " commands of pins are running already");
  request.path = process::find_program(command.front());
  if (request.path.empty()) return refuse(process::no_program(command.front()));
  request.arguments = command;
  request.output = STDERR_FILENO;
  start(*slot, request);
  return {};
}

std::string PinCommands::refuse(std::string why) {
  ++counters_.refused;
  return why;
}

void PinCommands::start(Slot& slot, const process::SpawnRequest& request) {
  slot.name = request.arguments.front();
  slot.child.start(request, [this, &slot](const process::ExitStatus& status) { ended(slot, status); });
  slot.deadline.expires_after(deadline_);
  slot.deadline.async_wait([this, &slot, alive = std::weak_ptr(alive_)](const auto& error) {
    if (!error && !alive.expired()) timed_out(slot);
  });
}

void PinCommands::ended(Slot& slot, const process::ExitStatus& status) {
  slot.deadline.cancel();
  if (status.clean) return;
  ++counters_.failed;
  warn(slot, status.text);
}

void PinCommands::timed_out(Slot& slot) {
  // Ignores a handler that was queued for the previous command in this slot.
  if (!slot.child.running() || slot.deadline.expiry() > std::chrono::steady_clock::now()) return;
  ++counters_.timed_out;
  warn(slot, "killed, since it was not done in " + std::to_string(deadline_.count()) + " ms");
  slot.child.signal_group(SIGKILL);
}

void PinCommands::warn(const Slot& slot, const std::string& what) {
  const auto held_back = lines_.allow();
  if (held_back) spdlog::warn("command '{}' of a pin: {}{}", slot.name, what, process::and_more(*held_back));
}

void PinCommands::stop() {
  for (Slot& slot : slots_) slot.child.signal_group(SIGKILL);
}

PinCommands::Slot* PinCommands::free_slot() {
  const auto slot = std::find_if(slots_.begin(), slots_.end(), [](const Slot& each) { return !each.child.running(); });
  return slot == slots_.end() ? nullptr : &*slot;
}

}  // namespace limb_ring::runtime
