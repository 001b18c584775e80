#include <array>
#include <csignal>

#include "config/sections.h"

namespace limb_ring::config {
namespace {

using Action = PinConfig::Action;

const char* const kAllowedPins = "none, reset, stop, notify, sync, {signal: NAME} or {exec: [PROGRAM, ARGUMENT, ...]}";

struct Signal {
  const char* name;
  int number;
};
constexpr std::array<Signal, 10> kSignals{{{"HUP", SIGHUP},
                                           {"INT", SIGINT},
                                           {"QUIT", SIGQUIT},
                                           {"USR1", SIGUSR1},
                                           {"USR2", SIGUSR2},
                                           {"ALRM", SIGALRM},
                                           {"TERM", SIGTERM},
                                           {"CONT", SIGCONT},
                                           {"STOP", SIGSTOP},
                                           {"KILL", SIGKILL}}};

int read_signal(const Entry& entry) {
  std::vector<std::string> names;
  for (const Signal& signal : kSignals) names.emplace_back(signal.name);
  return kSignals[read_choice(entry, names)].number;
}

/// `{signal: USR1}` or `{exec: [...]}`, one of them.
PinConfig read_pin_map(const Entry& entry) {
  check_names(entry, {"signal", "exec"}, {});
  const auto signal = entry.find("signal"), exec = entry.find("exec");
  if (signal.has_value() == exec.has_value())
    entry.refuse(signal ? "signal and exec are both given" : "the map is empty", kAllowedPins);
  PinConfig pin;
  pin.action = signal ? Action::signal : Action::exec;
  if (signal) pin.signal = read_signal(*signal);
  if (exec) pin.command = read_command(*exec);
  return pin;
}

PinConfig read_pin(const Entry& entry) {
  if (entry.is_map()) return read_pin_map(entry);
  constexpr std::array<Action, 5> actions{Action::none, Action::reset, Action::stop, Action::notify, Action::sync};
  const std::string text = entry.text(kAllowedPins);
  if (text == "signal" || text == "exec") entry.refuse_value("says not which", kAllowedPins);
  PinConfig pin;
  pin.action = actions[read_choice(entry, {"none", "reset", "stop", "notify", "sync"})];
  return pin;
}

const char* default_pin(std::size_t factor) {
  constexpr std::array<const char*, 3> wired{"reset", "stop", "sync"};
  return factor < wired.size() ? wired[factor] : "none";
}

InputConfig read_input(const Entry& entry) {
  InputConfig input;
  read_section(entry, input_section(), input);
  return input;
}

void read_input_target(const Entry& entry, InputConfig& input) {
  input.broadcast = entry.is_scalar() && entry.text("") == "all";
  if (!input.broadcast) input.node = read_node(entry, ", or all");
}

Section<NodeConfig> make_pins() {
  Section<NodeConfig> section;
  for (std::size_t factor = 0; factor < kPins; ++factor)
    section.push_back({std::to_string(factor), default_pin(factor), kAllowedPins,
                       "What INT" + std::to_string(factor) + " from the ring does at this node.",
                       [factor](const Entry& entry, NodeConfig& node) { node.pins[factor] = read_pin(entry); }});
  return section;
}

Section<NodeConfig> make_inputs() {
  Section<NodeConfig> section;
  for (std::size_t input = 0; input < kPins; ++input)
    section.push_back({std::to_string(input), "wired to nothing", "a map, see below",
                       "Where interrupt input " + std::to_string(input) + " leads.",
                       [input](const Entry& entry, NodeConfig& node) { node.inputs[input] = read_input(entry); }});
  return section;
}

}  // namespace

const Section<NodeConfig>& pins_section() {
  static const Section<NodeConfig> section = make_pins();
  return section;
}

const Section<NodeConfig>& inputs_section() {
  static const Section<NodeConfig> section = make_inputs();
  return section;
}

const Section<InputConfig>& input_section() {
  static const Section<InputConfig> section = [] {
    Option<InputConfig> factor =
        integer_option("factor", &InputConfig::factor, {0, 7}, "The pin pulled there. Not a reset of all nodes.");
    factor.fallback = kRequired;
    return Section<InputConfig>{
        {"to", kRequired, "id or name of a node, or all", "The destination of the INTP.", read_input_target}, factor};
  }();
  return section;
}

}  // namespace limb_ring::config
