#include "node/pin_commands.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "io/find_program.h"

namespace limb_ring::runtime {

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
  spdlog::warn("command '{}' of a pin: {}", slot.name, status.text);
}

void PinCommands::timed_out(Slot& slot) {
  // Ignores a handler that was queued for the previous command in this slot.
  if (!slot.child.running() || slot.deadline.expiry() > std::chrono::steady_clock::now()) return;
  ++counters_.timed_out;
  spdlog::warn("command '{}' of a pin is killed: not done in {} ms", slot.name, deadline_.count());
  slot.child.signal_group(SIGKILL);
}

void PinCommands::stop() {
  for (Slot& slot : slots_) slot.child.signal_group(SIGKILL);
}

PinCommands::Slot* PinCommands::free_slot() {
  const auto slot = std::find_if(slots_.begin(), slots_.end(), [](const Slot& each) { return !each.child.running(); });
  return slot == slots_.end() ? nullptr : &*slot;
}

}  // namespace limb_ring::runtime
