#include "tools/firmware/fault_command.h"

#include <charconv>
#include <string_view>

namespace limb_ring::firmware {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank(" \t\r\n\0", 5);
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::optional<FaultCommand> exit_command(std::string_view number) {
  int code = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), code);
  const bool whole = error == std::errc{} && end == number.data() + number.size();
  if (!whole || code < 0 || code > 255) return std::nullopt;
  return FaultCommand{FaultCommand::Kind::exit, code};
}

}  // namespace

std::optional<FaultCommand> parse_fault_command(payload::ByteView bytes) {
  constexpr std::string_view kExit = "exit ";
  const auto text = trimmed({reinterpret_cast<const char*>(bytes.data), bytes.size});
  if (text == "hang") return FaultCommand{FaultCommand::Kind::hang, 0};
  if (text.substr(0, kExit.size()) == kExit) return exit_command(text.substr(kExit.size()));
  return std::nullopt;
}

}  // namespace limb_ring::firmware
