#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "tools/cli/values.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/channel.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/hex.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/results.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

namespace {

struct SendOptions {
  std::string from, to, text, hex;
  unsigned priority = 2, channel = 0, size = 0, count = 1;
  double interval_s = 0;
  bool json = false;
};

/// `size` bytes 0, 1, 2 ... 255, 0 ...
std::vector<std::uint8_t> pattern(unsigned size) {
  std::vector<std::uint8_t> bytes(size);
  for (unsigned i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i);
  return bytes;
}

std::vector<std::uint8_t> data_of(const SendOptions& options) {
  if (options.size > 0) return pattern(options.size);
  if (!options.hex.empty()) return parse_hex(options.hex);
  return {options.text.begin(), options.text.end()};
}

std::vector<std::uint8_t> checked_data(const SendOptions& options) {
  const std::vector<std::uint8_t> data = data_of(options);
  if (!data.empty() && data.size() <= kMaxPayload) return data;
  throw UsageError(std::to_string(data.size()) + " bytes of data; a packet holds 1 to " + std::to_string(kMaxPayload));
}

int run(const Context& context, const SendOptions& options) {
  const std::vector<std::uint8_t> data = checked_data(options);
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const std::uint8_t to = ring.destination(options.to);
  HostPort port = ring.connect(ring.node(options.from), Stay::for_long);
  const auto send = [&] {
    return port.send(to, data, static_cast<std::uint8_t>(options.priority), static_cast<std::uint8_t>(options.channel));
  };
  const std::chrono::nanoseconds interval(std::llround(options.interval_s * 1e9));
  return report(send_and_explain(port, ring, to, options.count, send, interval), options.json);
}

const CLI::App& add_data_options(CLI::App& command, SendOptions& options) {
  CLI::App& data = *command.add_option_group("data", "What to send, one of:");
  data.add_option("--size", options.size, "So many bytes 0, 1, 2 ..., 1 to 512")->transform(cli::whole(1, kMaxPayload));
  data.add_option("--data", options.text, "This text, 1 to 512 bytes");
  data.add_option("--hex", options.hex, "These bytes, two hexadecimal digits each");
  return data;
}

void require_one(const CLI::App& data) {
  const auto options = data.get_options();
  const auto given =
      std::count_if(options.begin(), options.end(), [](const CLI::Option* one) { return one->count() > 0; });
  if (given == 1) return;
  throw UsageError(std::string(given == 0 ? "nothing to send was given" : "only one thing can be sent at a time") +
                   "; --size, --data or --hex is needed");
}

}  // namespace

void add_send(CLI::App& app, Context& context) {
  auto options = std::make_shared<SendOptions>();
  CLI::App* command = add_command(app, "send", "Send data packets, and print how each ended",
                                  "ringctl send --from head --to left_knee --data hello");
  command->add_option("--from", options->from, "Node that sends, id or name")->required();
  command->add_option("--to", options->to, "Node to send to, id or name, or all")->required();
  command->add_option("--priority", options->priority, "0 (highest) to 3; default 2")->transform(cli::whole(0, 3));
  command->add_option("--channel", options->channel, "0 (user, default), 2 to 63; joint is 2, topic is 3")
      ->transform(channel_of_clients());
  command->add_option("-c,--count", options->count, "How many, 1 to 1000000; default 1")
      ->transform(cli::whole(1, 1000000));
  command
      ->add_option("-i,--interval", options->interval_s,
                   "Time between two, 0 to 3600 s, as 5ms or 0.2; default 0: as fast as they end")
      ->transform(cli::seconds(0, 3600));
  const CLI::App& data = add_data_options(*command, *options);
  add_json(*command, options->json);
  command->callback([&context, &data, options] {
    context.action = [&context, &data, options] {
      require_one(data);
      return run(context, *options);
    };
  });
}

}  // namespace limb_ring::ringctl
