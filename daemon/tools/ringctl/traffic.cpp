#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/arguments.h"
#include "config/ring_config.h"
#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"
#include "wire/packet.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

struct ShowOptions {
  std::vector<std::string> nodes;
  FilterWords filter;
  app::PacketTextOptions text;
  std::uint64_t count = 0;
  std::string write, read;
  bool events = false, json = false, log = false;
};

std::unique_ptr<CaptureSink> sink_of(const ShowOptions& options, const capture::RingNames& names) {
  if (!options.write.empty()) return file_sink(names, options.write);
  if (options.json) return json_sink(names);
  app::PacketTextOptions text = options.text;
  text.colour = app::colour_wanted(STDOUT_FILENO);
  return text_sink(names, text);
}

/// One node's input shows every packet of a closed ring once: the supervisor's, if none is named.
std::vector<NodeName> nodes_of(const RingAccess& ring, const std::vector<std::string>& words) {
  if (words.empty()) {
    HostPort port = ring.connect(ring.source(""));
    return {ring.node(std::to_string(ask(port, {{"do", "config"}}, kAnswerTime).at("supervisor").get<unsigned>()))};
  }
  if (words.size() == 1 && words.front() == "all") return ring.nodes_here();
  if (std::count(words.begin(), words.end(), "all") != 0)
    throw UsageError("all: every node is meant, so none can be named beside it");
  std::vector<NodeName> nodes;
  for (const std::string& word : words) nodes.push_back(ring.node(word));
  return nodes;
}

int show_live(const Context& context, const ShowOptions& options) {
  const std::string first = options.nodes.empty() ? "" : options.nodes.front();
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), first);
  const capture::RingNames names = names_of(ring);
  nlohmann::json order{{"packets", ringctl::order_of(choice_of(options.filter, names))}};
  // Who reads a file later wants to know what else happened.
  if (options.events || !options.write.empty()) order["kinds"] = {"state", "link", "pin", "cpu"};
  const auto sink = sink_of(options, names);
  const DumpTotals totals = LiveDump(ring, nodes_of(ring, options.nodes), order, *sink).run(options.count);
  const bool written = sink->flush();
  if (!sink->wanted()) return kDone;
  tell_user(summary(totals));
  if (!written) throw NotDone(sink->problem());
  if (totals.all_gone) throw HostPortError("no daemon is left to look at");
  return kDone;
}

/// Of a file all lines are shown where the command line does not choose.
capture::Choice file_choice(const ShowOptions& options, const capture::RingNames& names) {
  capture::Choice choice = choice_of(options.filter, names);
  if (options.filter.at.empty()) choice.filter.output = true;
  return choice;
}

/// @param shown counts also if this throws. @throw capture::CaptureFileError
void show_records(capture::PcapngReader& reader, const ShowOptions& options, capture::Selection& selection,
                  CaptureSink& sink, std::uint64_t& shown) {
  while (const auto record = reader.next()) {
    if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) {
      if (options.events || !options.write.empty()) sink.event(*event);
      continue;
    }
    const auto& packet = std::get<CapturedPacket>(*record);
    const wire::ByteView bytes = app::bytes_of(packet);
    if (!selection.takes({std::chrono::nanoseconds(packet.time_ns), packet.info, bytes})) continue;
    sink.packet(packet);
    if (++shown == options.count || !sink.wanted()) break;
  }
}

void tell_fifo(const std::string& file) {
  std::error_code unknown;
  if (std::filesystem::is_fifo(file, unknown)) tell_user(file + " is a FIFO: waiting for what somebody writes into it");
}

int show_file(const Context& context, const ShowOptions& options) {
  if (!context.ring.empty()) throw UsageError("-r reads a file, --ring names a ring: choose one of them");
  if (!options.nodes.empty()) throw UsageError("-r reads a file, which has its own nodes: leave NODE out");
  if (app::is_same_file(options.read, options.write))
    throw UsageError("-r and -w name the same file: " + options.write + " would be lost; write to another one");
  tell_fifo(options.read);
  capture::CaptureFile file(options.read);
  capture::PcapngReader& reader = file.reader();
  const auto sink = sink_of(options, reader.names());
  capture::Selection selection(file_choice(options, reader.names()));
  DumpTotals totals;
  std::exception_ptr damaged;
  try {
    show_records(reader, options, selection, *sink, totals.shown);
  } catch (const capture::CaptureFileError&) {
    damaged = std::current_exception();
  }
  totals.nodes = selection.counts();
  const bool written = sink->flush();
  if (!sink->wanted()) return kDone;
  tell_problems(reader);
  tell_user(summary(totals));
  if (damaged) std::rethrow_exception(damaged);
  if (!written) throw NotDone(sink->problem());
  return kDone;
}

/// "traffic-2026-11-22_061508.pcapng"
std::string named_by_date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  char text[64];
  std::strftime(text, sizeof text, "traffic-%Y-%m-%d_%H%M%S.pcapng", &local);
  return text;
}

int run(const Context& context, ShowOptions options) {
  if (options.log && !options.write.empty()) throw UsageError("-l and -w: choose one of them");
  if (options.log) tell_user("writing " + (options.write = named_by_date()));
  if (options.json && (options.text.ascii || options.text.decode))
    throw UsageError("--json goes without -a and -d: it has all bytes of a packet, as a program wants them");
  if (options.json && !options.write.empty()) throw UsageError("--json and -w: choose one of them");
  return options.read.empty() ? show_live(context, options) : show_file(context, options);
}

void add_filter(CLI::App& command, FilterWords& words) {
  command.add_option("--at", words.at, "in, out or in,out; default in: there each packet of a closed ring passes once")
      ->delimiter(',')
      ->transform(cli::one_of(kLines));
  command.add_option("--kind", words.kinds, "data, control (hellos, beacons), interrupt; default all")
      ->delimiter(',')
      ->transform(cli::one_of(kKinds));
  command.add_option("--from", words.from, "Only of these sources, id or name")->delimiter(',');
  command.add_option("--to", words.to, "Only to these destinations; all: broadcasts")->delimiter(',');
  command.add_option("--priority", words.priority, "Only data packets of these, 0 to 3")
      ->delimiter(',')
      ->transform(cli::whole(0, 3));
  command.add_option("--channel", words.channel, "Only data packets of these, 0 to 63, or user, control, joint, topic")
      ->delimiter(',')
      ->transform(any_channel());
  command.add_option("--sample", words.sample, "Only every N-th of those")->transform(cli::whole(1, 1000000));
  command.add_option("--limit", words.limit, "At most N a second from each node; default 0: no limit")
      ->transform(cli::whole(0, 1000000000));
}

void add_options(CLI::App& command, ShowOptions& options) {
  command.add_option("NODE", options.nodes,
                     "Nodes to look at, id or name, or all of this host; default: the supervisor");
  const std::map<std::string, app::Stamps> stamps{
      {"a", app::Stamps::absolute}, {"d", app::Stamps::delta}, {"z", app::Stamps::zero}};
  command.add_option("-t,--time", options.text.stamps, "Times: a absolute, d since the one before, z since the first")
      ->transform(cli::word_of(stamps));
  command.add_flag("-d,--decode", options.text.decode, "Hellos, beacons, joints, sensors and topics in words");
  command.add_flag("-e,--events", options.events, "Changes of state, links, pins and CPUs too; -w always writes them");
  command.add_option("-n,--count", options.count, "End after N packets; default 0: never")
      ->transform(cli::whole(0, 1000000000));
  command.add_flag("-a,--ascii", options.text.ascii, "Data as characters too");
  command.add_flag("-l,--log", options.log, "As -w, into a file named by date and time, here");
  command.add_option("-w,--write", options.write, "Write pcapng there instead of text; - is standard output");
  command.add_option("-r,--read", options.read, "Read a pcapng file instead of a ring; - is standard input");
  add_filter(command, options.filter);
  command.add_flag("--json", options.json, "A line of JSON for each packet, for programs");
}

void add_traffic_show(CLI::App& app, Context& context) {
  auto options = std::make_shared<ShowOptions>();
  CLI::App* command = add_command(app, "show", "Print the packets on lines of nodes, or of a capture",
                                  "ringctl traffic show left_knee --kind data --count 10 --decode",
                                  "Goes on until Ctrl-C, or the end of the file.");
  add_options(*command, *options);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

struct EventsOptions {
  std::string node;
  std::vector<std::string> kinds;
  std::uint64_t count = 0;
};

void print_lost(const ObservedLost& lost) { tell_user("read too slowly, " + std::to_string(lost.count) + " left out"); }

/// Lines until `count` are out (0: without end), Ctrl-C, nobody reads them, or the daemon is gone.
int print_lines(HostPort& port, std::uint64_t count) {
  const process::SignalWait signals;
  for (std::uint64_t lines = 0; app::is_output_read() && (count == 0 || lines < count);) {
    const auto message = port.receive(process::SignalWait::kTick);
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0)))) return kDone;
    if (!message) continue;
    if (const auto* seen = std::get_if<Observed>(&*message)) {
      const auto event = nlohmann::json::parse(seen->json, nullptr, /*allow_exceptions=*/false);
      if (event.is_object() && event.contains("error")) throw UsageError(event["error"].get<std::string>());
      std::cout << seen->json << std::endl;
      ++lines;
    } else if (const auto* lost = std::get_if<ObservedLost>(&*message)) {
      print_lost(*lost);
    } else if (const auto* end = std::get_if<Disconnected>(&*message)) {
      throw gone(port, end->reason);
    }
  }
  return kDone;
}

int run(const Context& context, const EventsOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.node);
  HostPort port = ring.connect(ring.node(options.node), Stay::for_long);
  nlohmann::json filter = nlohmann::json::object();
  if (!options.kinds.empty()) filter["kinds"] = options.kinds;
  port.observe(filter.dump());
  return print_lines(port, options.count);
}

void add_traffic_events(CLI::App& app, Context& context) {
  auto options = std::make_shared<EventsOptions>();
  CLI::App* command = add_command(app, "events", "Print the events of a node, a line of JSON each",
                                  "ringctl traffic events left_knee --kinds state,cpu", "Goes on until Ctrl-C.");
  command->add_option("NODE", options->node, "Node, id or name")->required();
  command
      ->add_option("--kinds", options->kinds, "Only these kinds of events, of: " + config::join(client::event_kinds()))
      ->delimiter(',')
      ->transform(cli::one_of(client::event_kinds()));
  command->add_option("-n,--count", options->count, "End after N lines; default 0: never")
      ->transform(cli::whole(0, 1000000000));
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace

void add_traffic(CLI::App& app, Context& context) {
  CLI::App& traffic = add_group(app, "traffic", "Show packets, explain delays, judge promises, send again",
                                "ringctl traffic show left_knee -d");
  add_traffic_show(traffic, context);
  add_traffic_events(traffic, context);
  add_traffic_why(traffic, context);
  add_traffic_judge(traffic, context);
  add_traffic_again(traffic, context);
}

}  // namespace limb_ring::ringctl
