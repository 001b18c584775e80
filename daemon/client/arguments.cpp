#include "client/arguments.h"

#include "limb_ring/host_port.h"

namespace limb_ring::client {

namespace {

constexpr std::uint8_t kPriorities = 4;
constexpr std::uint8_t kChannels = 64;
constexpr std::uint8_t kControlChannel = 1;
constexpr std::uint8_t kFactors = 8;

}  // namespace

std::optional<Problem> send_problem(std::size_t size, std::uint8_t priority, std::uint8_t channel) {
  if (size == 0 || size > kMaxPayload)
    return Problem{Reason::bad_size, "size " + std::to_string(size) + ": a packet holds 1 to 512 bytes"};
  if (priority >= kPriorities)
    return Problem{Reason::bad_priority, "priority " + std::to_string(priority) + ": allowed are 0 (highest) to 3"};
  if (channel >= kChannels)
    return Problem{Reason::bad_channel, "channel " + std::to_string(channel) + ": allowed are 0 to 63"};
  if (channel == kControlChannel)
    return Problem{Reason::bad_channel,
                   "channel 1 is the network controllers' own: allowed are 0 and 2 to 63"};
  return std::nullopt;
}

std::optional<Problem> interrupt_problem(std::uint8_t factor) {
  if (factor < kFactors) return std::nullopt;
  return Problem{Reason::bad_factor, "factor " + std::to_string(factor) + ": allowed are 0 to 7"};
}

std::optional<Problem> pull_problem(std::uint8_t input) {
  if (input < kFactors) return std::nullopt;
  return Problem{Reason::input_unwired, "input " + std::to_string(input) + ": allowed are 0 to 7"};
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

}  // namespace limb_ring::client
