#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/arguments.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/common/timeline.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/replay_plan.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"
#include "tools/ringctl/trace_views.h"
#include "wire/packet.h"
#include "wire/pcapng.h"
#include "wire/traced_ring.h"

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

/// One node's input shows every packet of a closed ring once: the supervisor's, where none is named.
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

/// @param shown counts also where this throws. @throw capture::CaptureFileError
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

constexpr double kUsualLook = 5;  // s

struct WhyOptions {
  std::string file, source, at, over, svg, perfetto;
  std::optional<double> lasts_s;  ///< of a living ring
  std::optional<unsigned> sequence;
  std::size_t count = 1;
  bool live = false, json = false;
};

nanoseconds time_over(const std::string& text) {
  const auto time = config::parse_time(text);
  if (!time) throw UsageError("--over " + text + ": not a time; one is 200us, 1.5ms or 5s");
  return *time;
}

/// With a unit, the time since the first packet; without, seconds as `traffic show` prints them. Parsed by hand, as a
/// double would lose the ns.
nanoseconds instant_of(const std::string& text, nanoseconds first) {
  constexpr std::size_t kDecimals = 9;
  constexpr std::int64_t kLatest = std::chrono::floor<std::chrono::seconds>(nanoseconds::max()).count() - 1;
  if (const auto since = config::parse_time(text)) return first + std::min(*since, nanoseconds::max() - first);
  const std::size_t point = text.find('.');
  std::string decimals = point == std::string::npos ? "" : text.substr(point + 1);
  decimals.resize(std::max(decimals.size(), kDecimals), '0');
  const auto whole = config::parse_integer(text.substr(0, point));
  const auto parts = config::parse_integer(decimals);
  const bool plain = text.find_first_not_of("0123456789.") == std::string::npos;  // -0.5 has a whole part of 0, too
  if (!plain || !whole || !parts || *whole > kLatest || decimals.size() != kDecimals)
    throw UsageError("--at " + text +
                     ": not a time; one is 12.5ms since the first packet, or 1763757352.123456789 as "
                     "'ringctl traffic show' prints it");
  return std::chrono::seconds(*whole) + nanoseconds(*parts);
}

capture::TripChoice choice_of(const WhyOptions& options, const SeenPackets& seen) {
  capture::TripChoice choice;
  if (!options.source.empty()) choice.source = node_of(options.source, seen.names);
  if (options.sequence) choice.sequence = static_cast<std::uint8_t>(*options.sequence);
  if (!options.over.empty()) choice.over = time_over(options.over);
  if (options.at.empty()) return choice;
  nanoseconds first = seen.packets.empty() ? nanoseconds(0) : seen.packets.front().began;
  for (const capture::SeenPacket& packet : seen.packets) first = std::min(first, packet.began);
  choice.at = instant_of(options.at, first);
  return choice;
}

void check(const Context& context, const WhyOptions& options) {
  if (options.live != options.file.empty())
    throw UsageError("traffic why: either FILE, a capture, or --live: choose one of them");
  if (!options.live && !context.ring.empty()) throw UsageError("traffic why: FILE and --ring: choose one of them");
  if (options.lasts_s && !options.live) throw UsageError("--for: how long to capture, with --live");
  for (const auto& [option, path] : {std::pair("--svg", options.svg), std::pair("--perfetto", options.perfetto)})
    if (app::is_same_file(options.file, path))
      throw UsageError(std::string(option) + " names the capture itself: " + path +
                       " would be lost; write into another file");
  if (!options.live) return;
  if (!options.at.empty()) throw UsageError("--at: of a capture; what is to come with --live has no time yet");
}

SeenPackets seen_packets(const Context& context, const WhyOptions& options) {
  if (!options.live) return packets_of_file(options.file);
  return packets_of_ring(context.ring, nanoseconds(std::llround(options.lasts_s.value_or(kUsualLook) * 1e9)));
}

/// Of many millions of packets that takes seconds.
std::unique_ptr<capture::TracedRing> sorted(std::vector<capture::SeenPacket> packets) {
  std::unique_ptr<capture::TracedRing> ring;
  const std::string what = "sorting " + std::to_string(packets.size()) + " packets";
  while_telling(
      {}, [&] { ring = std::make_unique<capture::TracedRing>(std::move(packets)); }, what);
  return ring;
}

/// Where one is asked for and it is not open yet. @throw UsageError
void open_picture(std::ofstream& picture, const WhyOptions& options) {
  const std::string& path = options.perfetto.empty() ? options.svg : options.perfetto;
  if (path.empty() || picture.is_open()) return;
  const std::string problem = app::open_for_writing(picture, path);
  if (!problem.empty()) throw UsageError(problem);
}

int write_timeline(const SeenPackets& seen, std::ofstream& file, const WhyOptions& options) {
  open_picture(file, options);
  app::write_timeline(file, seen.names, seen.packets, seen.events);
  const std::string problem = cli::finish_writing(file, options.perfetto);
  if (!problem.empty()) throw NotDone(problem);
  std::cout << "wrote " << options.perfetto << ", which ui.perfetto.dev opens" << std::endl;
  return kDone;
}

void show(const capture::TracedRing& ring, const std::vector<std::size_t>& trips, const WhyOptions& options,
          const SeenPackets& seen) {
  for (std::size_t i = 0; i < trips.size(); ++i) {
    const capture::PacketTrace trace = ring.trace(trips[i]);
    if (options.json)
      std::cout << trace_json(trace, seen.names) << '\n';
    else
      std::cout << (i == 0 ? "" : "\n") << trace_text(trace, seen.names);
  }
  std::cout << std::flush;
}

void draw(const capture::PacketTrace& trace, const capture::RingNames& names, std::ofstream& picture,
          const WhyOptions& options) {
  picture << trace_svg(trace, names);
  const std::string problem = cli::finish_writing(picture, options.svg);
  if (!problem.empty()) throw NotDone(problem);
}

/// At least one, and no more than were asked for. @throw NotDone
std::vector<std::size_t> chosen_trips(const capture::TracedRing& ring, const capture::TripChoice& choice,
                                      std::size_t count) {
  std::vector<std::size_t> trips = choose_trips(ring, choice);
  if (trips.empty()) throw NotDone("no such packet among " + std::to_string(ring.trips()) + " that were seen");
  if (count == 0 || trips.size() <= count) return trips;
  tell_user(std::to_string(count) + " of " + std::to_string(trips.size()) + " that fit; -n shows more");
  trips.resize(count);
  return trips;
}

int run(const Context& context, const WhyOptions& options) {
  check(context, options);
  // A live capture takes a while: whether the picture can be written shows before. Opening it empties an older one,
  // so where a capture file is read, which may fail, it is opened after that.
  std::ofstream picture;
  if (options.live) open_picture(picture, options);
  SeenPackets seen = seen_packets(context, options);
  const capture::TripChoice choice = choice_of(options, seen);
  if (seen.lost != 0) tell_user(std::to_string(seen.lost) + " packets are missing in this capture; paths have gaps");
  if (!options.perfetto.empty()) return write_timeline(seen, picture, options);
  const bool any = !seen.packets.empty();
  const auto sorted_ring = sorted(std::move(seen.packets));
  const capture::TracedRing& ring = *sorted_ring;
  if (any && !ring.outputs_seen())
    throw UsageError(options.file +
                     ": what packets waited for shows only where they go out too; 'ringctl traffic show all "
                     "--at in,out -w FILE' captures that, or --capture FILE --outputs under the virtual clock");
  const std::vector<std::size_t> trips = chosen_trips(ring, choice, options.count);
  open_picture(picture, options);
  show(ring, trips, options, seen);
  if (picture.is_open()) draw(ring.trace(trips.front()), seen.names, picture, options);
  return kDone;
}

void add_options(CLI::App& command, WhyOptions& options) {
  command.add_option("FILE", options.file, "A pcapng capture of inputs and outputs; - is standard input");
  command.add_flag("--live", options.live, "Look at all lines of the running ring instead");
  command.add_option("--for", options.lasts_s, "With --live: how long; default 5s")
      ->transform(cli::seconds(0.001, 1e6));
  command.add_option("--over", options.over, "Only round trips above that, as 200us; all, unless -n is given");
  command.add_option("--source", options.source, "Only packets of that node, id or name");
  command.add_option("--sequence", options.sequence, "Only those of that sequence, 0 to 7")
      ->transform(cli::whole(0, 7));
  command.add_option("--at", options.at,
                     "Only those that were under way then: 12.5ms since the first packet, or as traffic show -t a");
  command.add_option("-n,--count", options.count, "At most N, the slowest first; default 1; 0: all")
      ->transform(cli::whole(0, 1000000000));
  CLI::Option* svg = command.add_option("--svg", options.svg, "Draw the first of them there");
  command
      .add_option("--perfetto", options.perfetto,
                  "Instead, write all packets and events there as a timeline, which ui.perfetto.dev loads")
      ->excludes(svg);
  add_json(command, options.json);
}

void add_traffic_why(CLI::App& app, Context& context) {
  auto options = std::make_shared<WhyOptions>();
  CLI::App* command = add_command(app, "why", "Explain why packets were late, hop by hop",
                                  "ringctl traffic why --live --for 5s --count 3",
                                  "Shows the path of the slowest packet, and what it waited for at each node.");
  add_options(*command, *options);
  command->callback([&context, command, options] {
    if (!options->over.empty() && command->count("--count") == 0) options->count = 0;
    context.action = [&context, options] { return run(context, *options); };
  });
}

constexpr milliseconds kReplayTick{20};
/// Above all time-outs a send may have by default.
constexpr milliseconds kLastResults{30'000};
/// Far below what the clocks can hold, and more than anybody waits.
constexpr std::chrono::hours kLongestReplay{24 * 365};

struct AgainOptions {
  std::string file;
  double speed = 1;
  unsigned loop = 1;
  bool no_interrupts = false, json = false;
};

/// Sends of a plan through the ports of their sources, in their time.
class Replay {
 public:
  Replay(const RingAccess& ring, const ReplayPlan& plan) : plan_(plan), progress_(ring.ring()) {
    for (const ReplaySend& send : plan.sends)
      if (ports_.count(send.source) == 0)
        ports_.emplace(send.source, ring.connect(ring.node(std::to_string(send.source)), Stay::for_long));
    for (const auto& [node, port] : ports_) waiting_.push_back({port.fd(), POLLIN, 0});
  }

  /// @return false where somebody has asked it to end. @throw HostPortError where a daemon dies, as the next one
  bool run(double speed, process::SignalWait& signals) {
    const auto begin = steady_clock::now();
    standstill_ = process::Standstill(begin);
    for (const ReplaySend& send : plan_.sends) {
      const auto after_ns = static_cast<double>(std::max<std::int64_t>(0, send.after_ns));  // its line was read earlier
      const std::chrono::nanoseconds after(static_cast<std::int64_t>(after_ns / speed));
      if (!wait_until(begin + after, signals)) return false;
      put(send);
    }
    return true;
  }

  void wait_for_results(process::SignalWait& signals) {
    const auto deadline = steady_clock::now() + kLastResults;
    while (ended_ < sent_ && steady_clock::now() < deadline && !asked_to_end(signals)) take_results(kReplayTick);
  }

  std::uint64_t sent() const { return sent_; }
  std::uint64_t unanswered() const { return sent_ - ended_; }
  const std::map<Outcome, std::uint64_t>& outcomes() const { return outcomes_; }
  /// Why the others were not delivered, in words; where nobody says, the outcome.
  const std::map<std::string, std::uint64_t>& reasons() const { return reasons_; }

 private:
  static bool asked_to_end(process::SignalWait& signals) {
    return process::SignalWait::asks_to_end(signals.next(milliseconds(0)));
  }

  bool wait_until(steady_clock::time_point due, process::SignalWait& signals) {
    for (;;) {
      if (asked_to_end(signals)) return false;
      tell_standstill(standstill_.look(steady_clock::now()));
      const auto left = std::chrono::ceil<milliseconds>(due + standstill_.total() - steady_clock::now());
      take_results(std::clamp(left, milliseconds(0), kReplayTick));
      if (left <= milliseconds(0)) return true;
    }
  }

  void put(const ReplaySend& send) {
    HostPort& port = ports_.at(send.source);
    ++sent_;
    if (send.interrupt)
      port.interrupt(send.destination, send.last);
    else
      port.send(send.destination, send.data, wire::priority_of(send.last), wire::channel_of(send.last));
  }

  void take_results(milliseconds patience) {
    for (auto& [node, port] : ports_)
      while (const auto message = port.receive(milliseconds(0))) take(port, *message);
    progress_.tell();
    if (patience > milliseconds(0)) ::poll(waiting_.data(), waiting_.size(), static_cast<int>(patience.count()));
  }

  void take(const HostPort& port, const Message& message) {
    if (const auto* end = std::get_if<Disconnected>(&message)) throw gone(port, end->reason);
    const auto* result = std::get_if<Result>(&message);
    if (result == nullptr) return;
    ++ended_;
    ++outcomes_[result->outcome];
    if (result->outcome == Outcome::delivered) return;
    ++reasons_[result->reason.empty() ? to_string(result->outcome) : result->reason];
  }

  const ReplayPlan& plan_;
  Progress progress_;
  process::Standstill standstill_{steady_clock::now()};
  std::map<wire::NodeId, HostPort> ports_;
  std::vector<pollfd> waiting_;
  std::map<Outcome, std::uint64_t> outcomes_;
  std::map<std::string, std::uint64_t> reasons_;
  std::uint64_t sent_ = 0, ended_ = 0;
};

/// @throw UsageError where the last of a round would be sent more than kLongestReplay after the first
void require_an_end(const ReplayPlan& plan, const AgainOptions& options) {
  using Days = std::chrono::duration<double, std::ratio<86400>>;
  const auto later = [](const ReplaySend& one, const ReplaySend& other) { return one.after_ns < other.after_ns; };
  const auto last = std::max_element(plan.sends.begin(), plan.sends.end(), later);
  const Days apart = std::chrono::nanoseconds(last->after_ns);
  if (apart / options.speed <= Days(kLongestReplay)) return;
  throw UsageError(options.file + ": its packets are " + app::number(apart.count()) + " days apart, which at --speed " +
                   config::format_real(options.speed) + " takes more than a year; a larger --speed is needed");
}

ReplayPlan read_plan(const AgainOptions& options) {
  capture::CaptureFile file(options.file);
  ReplayPlan plan;
  while_telling(
      {}, [&] { plan = plan_replay(file.reader()); }, "reading " + options.file);
  tell_problems(file.reader());
  const auto unwanted = [&](const ReplaySend& send) { return options.no_interrupts && send.interrupt; };
  plan.sends.erase(std::remove_if(plan.sends.begin(), plan.sends.end(), unwanted), plan.sends.end());
  if (plan.sends.empty()) throw NotDone(options.file + ": holds nothing that can be sent again");
  require_an_end(plan, options);
  return plan;
}

nlohmann::json report_of(const Replay& replay, const ReplayPlan& plan) {
  nlohmann::json outcomes = nlohmann::json::object();
  for (const auto& [outcome, count] : replay.outcomes()) outcomes[to_string(outcome)] = count;
  return {{"sent", replay.sent()},
          {"outcomes", outcomes},
          {"reasons", replay.reasons()},
          {"unanswered", replay.unanswered()},
          {"left_out",
           {{"control", plan.control},
            {"broken", plan.broken},
            {"repeated", plan.repeated},
            {"on_other_lines", plan.elsewhere}}}};
}

void print_text(const nlohmann::json& report) {
  std::cout << "sent " << report["sent"];
  for (const auto& [outcome, count] : report["outcomes"].items()) std::cout << ", " << outcome << ' ' << count;
  if (report["unanswered"] != 0) std::cout << ", without a result " << report["unanswered"];
  for (const auto& [reason, count] : report["reasons"].items())
    if (report["outcomes"].count(reason) == 0) std::cout << "\n  " << count << ": " << reason;
  const nlohmann::json& left = report["left_out"];
  std::cout << "\nleft out of the file: " << left["control"] << " hellos and beacons, " << left["broken"] << " broken, "
            << left["repeated"] << " repeated, " << left["on_other_lines"] << " seen on other lines\n";
}

int run(const Context& context, const AgainOptions& options) {
  const ReplayPlan plan = read_plan(options);
  const RingAccess ring = RingAccess::open(choose_ring(context.ring));
  process::SignalWait signals;
  Replay replay(ring, plan);
  std::exception_ptr daemon_gone;
  try {
    bool go_on = true;
    for (unsigned i = 0; i < options.loop && go_on; ++i) go_on = replay.run(options.speed, signals);
    replay.wait_for_results(signals);
  } catch (const HostPortError&) {
    daemon_gone = std::current_exception();
  }
  const nlohmann::json report = report_of(replay, plan);
  if (options.json)
    std::cout << report.dump(2) << '\n';
  else
    print_text(report);
  if (daemon_gone) std::rethrow_exception(daemon_gone);
  const bool all = report["outcomes"].value("delivered", std::uint64_t{0}) == plan.sends.size() * options.loop;
  return all ? kDone : kNotDone;
}

void add_traffic_again(CLI::App& app, Context& context) {
  auto options = std::make_shared<AgainOptions>();
  CLI::App* command =
      add_command(app, "again", "Send the packets of a capture again", "ringctl traffic again walk.pcapng --speed 2",
                  "Each data packet and each interrupt is sent from its source, at its time.");
  command->add_option("FILE", options->file, "pcapng, of 'ringctl traffic show -w' or 'ring_sim run --capture'")
      ->required();
  command->add_option("--speed", options->speed, "N times as fast, 0.001 to 1000; default 1")
      ->transform(cli::real(0.001, 1000.0));
  command->add_option("--loop", options->loop, "N times, 1 to 1000000; default 1")->transform(cli::whole(1, 1000000));
  command->add_flag("--no-interrupts", options->no_interrupts, "Only data packets: interrupts may reset CPUs again");
  add_json(*command, options->json);
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
