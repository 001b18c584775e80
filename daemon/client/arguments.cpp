#include "client/arguments.h"

#include "limb_ring/host_port.h"
#include "wire/packet.h"

namespace limb_ring::client {
namespace {

constexpr std::uint8_t kControlChannel = wire::id_of(wire::Channel::control);

/// "size 513: a packet carries 1 to 512 bytes"
Problem problem(const char* argument, std::size_t value, Reason why) {
  return {why, std::string(argument) + ' ' + std::to_string(value) + ": " + sentence(why)};
}

}  // namespace

std::optional<Problem> send_problem(std::size_t size, std::uint8_t priority, std::uint8_t channel) {
  if (size == 0 || size > kMaxPayload) return problem("size", size, Reason::bad_size);
  if (priority >= wire::kPriorities) return problem("priority", priority, Reason::bad_priority);
  if (channel >= wire::kChannels || channel == kControlChannel) return problem("channel", channel, Reason::bad_channel);
  return std::nullopt;
}

std::optional<Problem> interrupt_problem(std::uint8_t factor) {
  if (factor < wire::kFactors) return std::nullopt;
  return problem("factor", factor, Reason::bad_factor);
}

std::optional<Problem> pull_problem(std::uint8_t input) {
  if (input < wire::kFactors) return std::nullopt;
  return problem("input", input, Reason::input_unwired);
}

std::optional<std::string> json_problem(std::string_view json) {
  std::size_t levels = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') quoted = !quoted;
    if (c == '\\' && quoted) ++i;
    if (quoted) continue;
    if (c == '[' || c == '{') ++levels;
    if ((c == ']' || c == '}') && levels > 0) --levels;
    if (levels > kMostJsonLevels)
      return "JSON: lists and objects are nested too deep; allowed: " + std::to_string(kMostJsonLevels) + " levels";
  }
  return std::nullopt;
}

const std::vector<std::string>& event_kinds() {
  static const std::vector<std::string> kinds{"state", "ring", "link", "noise", "pin", "cpu", "watchdog", "sent"};
  return kinds;
}

}  // namespace limb_ring::client
