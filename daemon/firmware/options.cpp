#include "firmware/options.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include <boost/program_options.hpp>

namespace limb_ring::firmware {
namespace {

namespace po = boost::program_options;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

po::options_description description() {
  const auto text = [](const char* variable) {
    const auto shown = std::string("$") + variable;
    return po::value<std::string>()->default_value(environment(variable), shown);
  };
  po::options_description options("limb_firmware: the CPU of a limb node, with simulated joints");
  options.add_options()
      ("config", text("LIMB_RING_CONFIG"), "YAML of the ring; without one there are no joints")
      ("node", text("LIMB_RING_NODE"), "the node this is the CPU of: id or name")
      ("ring", text("LIMB_RING_RING"), "name of the ring, where several run")
      ("hang-after", po::value<double>(), "hang on purpose so many seconds after the start")
      ("help", "print this");
  return options;
}

po::variables_map parse(int argc, const char* const* argv) {
  po::variables_map values;
  try {
    const auto none = po::positional_options_description();
    po::store(po::command_line_parser(argc, argv).options(description()).positional(none).run(),
              values);
  } catch (const po::error& error) {
    throw OptionsError(std::string(error.what()) + "; see --help");
  }
  return values;
}

std::chrono::nanoseconds hang_time(double seconds) {
  constexpr double kMost = 1e9;
  if (!(seconds >= 0 && seconds <= kMost))
    throw OptionsError("--hang-after takes 0 to 1e9 seconds");
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

}  // namespace

Options parse_options(int argc, const char* const* argv) {
  const auto values = parse(argc, argv);
  Options options;
  options.help = values.count("help") > 0;
  options.ring = values["ring"].as<std::string>();
  options.node = values["node"].as<std::string>();
  options.config = values["config"].as<std::string>();
  if (values.count("hang-after") > 0)
    options.hang_after = hang_time(values["hang-after"].as<double>());
  if (options.node.empty() && !options.help)
    throw OptionsError("which node is this the CPU of? Give --node ID or NAME, or LIMB_RING_NODE");
  return options;
}

std::string usage() {
  std::ostringstream text;
  text << description()
       << "\nEnds with 0 on SIGTERM and SIGINT, 1 when its daemon is gone or not there, 2 on\n"
          "wrong arguments or configuration, N when a user packet (channel 0) says \"exit N\".\n"
          "A user packet \"hang\" makes it hang: reads nothing, says nothing, ignores SIGTERM.\n";
  return text.str();
}

}  // namespace limb_ring::firmware
