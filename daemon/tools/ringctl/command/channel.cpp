#include "tools/ringctl/command/channel.h"

#include "config/names.h"
#include "tools/capture_text/packet_text.h"
#include "tools/cli/values.h"
#include "wire/data_packet.h"

namespace limb_ring::ringctl {

namespace {

/// Makes a plain number of `text`. @return what is wrong with it; empty: nothing
std::string read_channel(std::string& text) {
  std::vector<std::string> names;
  for (const auto& [name, number] : app::named_channels()) {
    names.push_back(name);
    if (text == name) text = std::to_string(number);
  }
  const std::string wrong = cli::whole(0, 63)(text);
  return wrong.empty() ? wrong : wrong + ", or one of: " + config::join(names);
}

std::string read_channel_of_clients(std::string& text) {
  const std::string wrong = read_channel(text);
  if (!wrong.empty() || text != std::to_string(wire::id_of(wire::Channel::control))) return wrong;
  return "channel 1 (control) belongs to the network controllers; 0 and 2 to 63 are allowed";
}

}  // namespace

CLI::Validator any_channel() { return CLI::Validator(read_channel, ""); }

CLI::Validator channel_of_clients() { return CLI::Validator(read_channel_of_clients, ""); }

}  // namespace limb_ring::ringctl
