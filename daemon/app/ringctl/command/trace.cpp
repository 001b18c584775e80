#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>

#include "app/common/out_file.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/dump_filter.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/seen_packets.h"
#include "app/ringctl/tell_user.h"
#include "app/ringctl/trace_svg.h"
#include "app/ringctl/trace_words.h"
#include "capture/trip_choice.h"
#include "cli/output.h"
#include "cli/values.h"
#include "config/quantity.h"

namespace limb_ring::ringctl {

namespace {

using std::chrono::nanoseconds;

constexpr double kUsualLook = 5;  // s

struct TraceOptions {
  std::string file, source, at, over, svg;
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

/// With a unit, the time since the first packet; without, seconds as `dump` prints them. Parsed by hand, as a double
/// would lose the ns.
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
                     "'ringctl dump' prints it");
  return std::chrono::seconds(*whole) + nanoseconds(*parts);
}

capture::TripChoice choice_of(const TraceOptions& options, const SeenPackets& seen) {
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

void check(const TraceOptions& options) {
  if (options.live != options.file.empty())
    throw UsageError("trace: either FILE, a capture, or --live: choose one of them");
  if (options.lasts_s && !options.live) throw UsageError("--for: how long to capture, with --live");
  if (app::is_same_file(options.file, options.svg))
    throw UsageError("--svg names the capture itself: " + options.svg + " would be lost; draw into another file");
  if (!options.live) return;
  if (!options.at.empty()) throw UsageError("--at: of a capture; what is to come with --live has no time yet");
}

SeenPackets seen_packets(const Context& context, const TraceOptions& options) {
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
void open_picture(std::ofstream& picture, const TraceOptions& options) {
  if (options.svg.empty() || picture.is_open()) return;
  const std::string problem = app::open_for_writing(picture, options.svg);
  if (!problem.empty()) throw UsageError(problem);
}

void show(const capture::TracedRing& ring, const std::vector<std::size_t>& trips, const TraceOptions& options,
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
          const TraceOptions& options) {
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

int run(const Context& context, const TraceOptions& options) {
  check(options);
  // A live capture takes a while: whether the picture can be written shows before. Opening it empties an older one,
  // so where a capture file is read, which may fail, it is opened after that.
  std::ofstream picture;
  if (options.live) open_picture(picture, options);
  SeenPackets seen = seen_packets(context, options);
  const capture::TripChoice choice = choice_of(options, seen);
  if (seen.lost != 0) tell_user(std::to_string(seen.lost) + " packets are missing in this capture; paths have gaps");
  const bool any = !seen.packets.empty();
  const auto sorted_ring = sorted(std::move(seen.packets));
  const capture::TracedRing& ring = *sorted_ring;
  if (any && !ring.outputs_seen())
    throw UsageError(options.file +
                     ": what packets waited for shows only where they go out too; 'ringctl dump all "
                     "--at in,out -w FILE' captures that, or --capture FILE --outputs under the virtual clock");
  const std::vector<std::size_t> trips = chosen_trips(ring, choice, options.count);
  open_picture(picture, options);
  show(ring, trips, options, seen);
  if (picture.is_open()) draw(ring.trace(trips.front()), seen.names, picture, options);
  return kDone;
}

void add_options(CLI::App& command, TraceOptions& options) {
  command.add_option("FILE", options.file, "A capture, pcapng, of inputs and outputs");
  command.add_flag("--live", options.live, "Look at all lines of the running ring instead");
  command.add_option("--for", options.lasts_s, "With --live: how long; default 5s")
      ->transform(cli::seconds(0.001, 1e6));
  command.add_option("--over", options.over, "Only round trips above that, as 200us; all, unless -n is given");
  command.add_option("--source", options.source, "Only packets of that node, id or name");
  command.add_option("--sequence", options.sequence, "Only those of that sequence, 0 to 7")
      ->transform(cli::whole(0, 7));
  command.add_option("--at", options.at,
                     "Only those on their way then: 12.5ms since the first packet, or as dump -t a");
  command.add_option("-n,--count", options.count, "At most so many, the slowest first; default 1; 0: all")
      ->transform(cli::whole(0, 1000000000));
  command.add_option("--svg", options.svg, "Draw the first of them there");
  add_json(command, options.json);
}

}  // namespace

void add_trace(CLI::App& app, Context& context) {
  auto options = std::make_shared<TraceOptions>();
  CLI::App* command =
      add_command(app, "trace", "Why was it late: the path of the slowest packet, hop by hop, and what it waited for");
  add_options(*command, *options);
  command->callback([&context, command, options] {
    if (!options->over.empty() && command->count("--count") == 0) options->count = 0;
    context.action = [&context, options] { return run(context, *options); };
  });
}

}  // namespace limb_ring::ringctl
