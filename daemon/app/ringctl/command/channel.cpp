#include "app/ringctl/command/channel.h"

#include "app/capture_text/packet_text.h"
#include "cli/values.h"
#include "config/names.h"
#include "wire/data_packet.h"

namespace limb_ring::ringctl {

CLI::Validator channel(bool control) {
  return CLI::Validator(
      [control](std::string& text) -> std::string {
        std::vector<std::string> names;
        for (const auto& [name, number] : app::named_channels()) {
          names.push_back(name);
          if (text == name) text = std::to_string(number);
        }
        if (!control && text == std::to_string(static_cast<int>(wire::Channel::control)))
          return "channel 1 (control) belongs to the network controllers; 0 and 2 to 63 are allowed";
        const std::string wrong = cli::whole(0, 63)(text);
        return wrong.empty() ? wrong : wrong + ", or one of: " + config::join(names);
      },
      "");
}

}  // namespace limb_ring::ringctl
