#include "tools/firmware/options.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "config/load_ring.h"
#include "tools/common/command_line.h"

namespace limb_ring::firmware {

namespace {

constexpr double kLongest = 1e9;  // seconds
constexpr const char* kOnPurpose =
    "A user packet (channel 0) \"hang\" makes it hang: it reads nothing, says nothing and ignores SIGTERM.";
constexpr const char* kExitCodes =
    "Exit codes: 0 on SIGTERM and SIGINT, 1 if its daemon is gone or not there, 2 on wrong arguments or configuration, "
    "N if a user packet says \"exit N\".";

/// What is asked for instead of a run; empty if nothing is.
std::string read(CLI::App& app, int argc, const char* const* argv) {
  try {
    return cli::read(app, {argv + 1, argv + argc}).value_or("");
  } catch (const cli::WrongCommandLine& wrong) {
    throw OptionsError(wrong.what());
  }
}

}  // namespace

Options parse_options(int argc, const char* const* argv) {
  Options options;
  double hang_after_s = 0, endless_loop_at_s = 0;
  CLI::App app("The CPU of a limb node, with simulated joints.", "limb_firmware");
  app.footer(cli::footer(kOnPurpose, "limb_firmware --ring leg8 --node left_knee", kExitCodes));
  std::string config;
  app.add_option("--config", config, "YAML of the ring, for its name; what it says of the node comes from the daemon")
      ->envname("LIMB_RING_CONFIG");
  app.add_option("--node", options.node, "The node this is the CPU of, id or name")->envname("LIMB_RING_NODE");
  app.add_option("--ring", options.ring, "Name of the ring, if several run")->envname("LIMB_RING_RING");
  const CLI::Option* hang = app.add_option("--hang-after", hang_after_s,
                                           "Hang on purpose this long after the start, such as 1.5s; 0 to 1e9 s")
                                ->transform(cli::seconds(0, kLongest));
  const CLI::Option* loop =
      app.add_option("--endless-loop-at", endless_loop_at_s,
                     "On a virtual ring: be caught in an endless loop at that instant of its clock, such as 20s; a "
                     "process that starts later is not; 0 to 1e9 s")
          ->transform(cli::seconds(0, kLongest));
  app.add_option("--command-log", options.command_log,
                 "Append a line to this file for each joint command obeyed: when it came, and its stamp, both in ns of "
                 "the clock of stamps");
  options.print = read(app, argc, argv);
  if (hang->count() > 0) options.hang_after = std::chrono::nanoseconds(std::llround(hang_after_s * 1e9));
  if (loop->count() > 0) options.endless_loop_at = std::chrono::nanoseconds(std::llround(endless_loop_at_s * 1e9));
  if (options.node.empty() && options.print.empty())
    throw OptionsError("which node is this the CPU of? Give --node ID or NAME, or LIMB_RING_NODE");
  if (options.ring.empty() && !config.empty() && options.print.empty()) options.ring = config::load_ring(config).ring;
  return options;
}

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
