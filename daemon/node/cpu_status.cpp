#include "node/cpu_status.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "client/command_filter.h"
#include "config/ring_config.h"
#include "io/program.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

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

namespace {

constexpr const char *kUnfit = "cpu_unfit", *kSilent = "cpu_silent", *kObeysNone = "cpu_obeys_none",
                     *kTold = "cpu_says";

std::string source_of(const config::SensorConfig& sensor) {
  return sensor.topic.empty() ? "" : ", whose values the bridge takes from the topic " + sensor.topic;
}

/// Whether it is the value of a sensor of that node, whose values a bridge hands it.
bool is_for_a_topic(const payload::SensorReading& value, const config::NodeConfig* to) {
  return to && config::unfit(value, to->sensors).empty() && !to->sensors[value.sensor].topic.empty();
}

}  // namespace

void CpuWatch::begin(core::Time now) {
  warnings_.clear();
  runs_ = true;
  spoke_ = state_heard_ = now;
  std::fill(heard_.begin(), heard_.end(), now);
  has_states_ = commanded_ = false;
  commands_ = 0;
  refused_ = 0;
}

void CpuWatch::sent(const payload::Decoded<payload::JointState>& state, core::Time now) {
  spoke_ = now;
  if (!state)
    return warn(kUnfit,
                std::string("its CPU sends a joint state that cannot be read: ") + payload::to_string(state.error()));
  state_heard_ = now;
  has_states_ = true;
  refused_ = state->refused;
  commanded_ = state->mode.commanded;
  if (commanded_ || state->mode.stopped) {
    commands_ = 0;
    mended(kObeysNone);
  }
  if (state->joints.size() != node_.joints.size())
    warn(kUnfit, "its CPU sends the state of " + std::to_string(state->joints.size()) +
                     " joints, and the ring's file gives it " + std::to_string(node_.joints.size()) +
                     ": nobody takes it");
}

void CpuWatch::sent(const payload::Decoded<payload::SensorReading>& reading, std::uint8_t to, core::Time now) {
  spoke_ = now;
  if (!reading)
    return warn(kUnfit, std::string("its CPU sends a sensor reading that cannot be read: ") +
                            payload::to_string(reading.error()));
  const std::string unfit = config::unfit(*reading, node_.sensors);
  if (!unfit.empty()) {
    if (!is_for_a_topic(*reading, ring_.find(to))) warn(kUnfit, "its CPU sends " + unfit + ": nobody takes it");
    return;
  }
  heard_[reading->sensor] = now;
}

// While its CPU obeys, no command is looked into.
void CpuWatch::given(payload::ByteView data) {
  if (commanded_ || node_.joints.empty()) return;
  if (!firmware::command_for(node_.id, data)) return;
  if (commands_++ == 0) refused_at_first_ = refused_;
}

void CpuWatch::told(const std::string& text) { warn(kTold, text); }

void CpuWatch::look(core::Time now) {
  if (now - looked_ < kLook) return;
  looked_ = now;
  // A CPU that says nothing at all is silent as a whole, which its state tells.
  if (!runs_ || now - spoke_ > kLook) return;
  if (!node_.joints.empty()) look_at("joint states", state_rate_, state_heard_, now);
  for (std::size_t i = 0; i < heard_.size(); ++i)
    look_at("readings of " + node_.sensors[i].name + source_of(node_.sensors[i]), node_.sensors[i].rate, heard_[i],
            now);
  look_at_commands();
}

void CpuWatch::look_at(const std::string& what, double rate, core::Time heard, core::Time now) {
  const std::string text = "its CPU runs and sends no " + what;
  const double silent_s = std::chrono::duration<double>(now - heard).count();
  if (now - heard <= kSilence || silent_s <= 3 / rate) return mended(kSilent, text);
  warn(kSilent, text);
}

void CpuWatch::look_at_commands() {
  if (commands_ < kCommands) return;
  const auto refused = static_cast<std::uint16_t>(refused_ - refused_at_first_);
  const std::string why = !has_states_   ? "it sends no joint states that could say why"
                          : refused != 0 ? "it refuses them as stale, early, older, unfit or unreadable"
                                         : "its firmware neither takes nor refuses them";
  warn(kObeysNone, "its CPU was given commands for its joints and obeys none: " + why);
}

void CpuWatch::warn(const char* rule, const std::string& text) {
  const auto same = [&](const Warning& warning) { return warning.rule == rule && warning.text == text; };
  if (std::any_of(warnings_.begin(), warnings_.end(), same) || warnings_.size() == kMostWarnings) return;
  ++begun_;
  warnings_.push_back({rule, text});
  log_(text);
}

void CpuWatch::mended(const char* rule, const std::string& text) {
  const auto same = [&](const Warning& warning) {
    return warning.rule == rule && (text.empty() || warning.text == text);
  };
  warnings_.erase(std::remove_if(warnings_.begin(), warnings_.end(), same), warnings_.end());
}

}  // namespace limb_ring::runtime
