#include "node/cpu_watch.h"

#include <algorithm>

#include "client/command_filter.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::runtime {
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
