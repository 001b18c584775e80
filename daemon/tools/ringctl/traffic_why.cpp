#include "tools/ringctl/traffic_why.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "config/quantity.h"
#include "config/urdf_joints.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/common/timeline.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/screen.h"
#include "wire/packet.h"
#include "wire/pcapng.h"
#include "wire/traced_ring.h"

namespace limb_ring::ringctl {
namespace {

using capture::Hop;
using capture::PacketTrace;
using capture::RingNames;
using capture::SeenPacket;
using capture::TripEnd;
using std::to_string;

constexpr std::size_t kMostNamed = 3;  // of the packets in its way at one node

std::string number_of(std::uint8_t code) {
  const wire::Code fields = wire::code_of(code);
  return to_string(fields.attempt) + "/" + to_string(fields.sequence);
}

std::string kind_of(std::uint8_t code, const std::optional<SeenPacket::Trailer>& trailer) {
  if (!wire::code_of(code).interrupt) return "DATP " + number_of(code);
  return "INT" + (trailer ? to_string(trailer->last) : "?") + " " + number_of(code);
}

std::string destination_of(const std::optional<SeenPacket::Trailer>& trailer, const RingNames& names) {
  if (!trailer) return "?";
  return trailer->destination == wire::kBroadcast ? "all" : names.of(trailer->destination);
}

void add(std::string& sentence, const std::string& part) { sentence += (sentence.empty() ? "" : "; ") + part; }

std::string place_of(const SeenPacket& packet, const RingNames& names) {
  return (packet.info.input ? "coming into " : "going out of ") + names.of(packet.seen_by());
}

std::string damage_of(const SeenPacket& packet) {
  if (packet.info.crc_bad) return "bad CRC";
  if (packet.info.aborted) return "aborted";
  return packet.info.truncated ? "truncated" : "";
}

std::string in_front(const SeenPacket& packet, const Hop& hop, const RingNames& names) {
  const SeenPacket& out = *hop.out;
  const bool carrier = out.info.embedded && packet.source == out.info.carrier_source &&
                       packet.code == out.info.carrier_code && !packet.interrupt();
  if (carrier) return "a word of its carrier";
  return (packet.info.own ? "own " : "") + packet_words(packet, names);
}

std::string behind_words(const Hop& hop, const RingNames& names) {
  std::string list;
  for (std::size_t i = 0; i < hop.behind.size() && i < kMostNamed; ++i)
    list += (i == 0 ? "behind " : ", ") + in_front(hop.behind[i], hop, names);
  if (hop.behind.size() > kMostNamed) list += " and " + to_string(hop.behind.size() - kMostNamed) + " more";
  if (list.empty() && hop.waited() && hop.waited()->count() > 0) return "nothing else was on its line";
  return list;
}

std::string embedded_words(const SeenPacket& packet, const RingNames& names) {
  if (!packet.info.embedded) return {};
  return "in DATP " + number_of(packet.info.carrier_code) + " of " + names.of(packet.info.carrier_source) +
         " behind byte " + to_string(packet.info.carrier_offset);
}

/// One line of at least three took more than half of it all.
bool mostly_on_line(const PacketTrace& trace, std::size_t hop) {
  const auto line = trace.on_line(hop);
  return line && trace.hops.size() > 3 && 2 * *line > trace.ended - trace.began;
}

std::string why_again(TripEnd end, std::chrono::nanoseconds after, const SeenPacket& last, const RingNames& names) {
  if (end == TripEnd::not_home)
    return "no return within " + in_us(after) + " us, last seen " + place_of(last, names) + ": sent again";
  const std::string again = end == TripEnd::refused ? ": sent again as a new packet" : ": sent again";
  return std::string(to_string(end)) + ", " + in_us(after) + " us later" + again;
}

}  // namespace

std::string in_us(std::chrono::nanoseconds time) {
  const std::int64_t ns = time.count() < 0 ? -time.count() : time.count();
  const std::string rest = to_string(ns % 1000);
  return (time.count() < 0 ? "-" : "") + to_string(ns / 1000) + "." + std::string(3 - rest.size(), '0') + rest;
}

std::string packet_words(const SeenPacket& packet, const RingNames& names) {
  const std::string size =
      packet.interrupt() || !packet.trailer ? "" : ", " + to_string(packet.size - wire::kOverhead) + " B";
  return kind_of(packet.code, packet.trailer) + " of " + names.of(packet.source) + " to " +
         destination_of(packet.trailer, names) + size;
}

std::string title_of(const PacketTrace& trace, const RingNames& names) {
  std::string title = names.of(trace.source) + " -> " + destination_of(trace.trailer, names) + "  " +
                      kind_of(trace.code, trace.trailer);
  if (wire::code_of(trace.code).interrupt || !trace.trailer) return title;
  return title + "  p" + to_string(wire::priority_of(trace.trailer->last)) + " " +
         app::channel_name(wire::channel_of(trace.trailer->last)) + "  " + to_string(trace.size - wire::kOverhead) +
         " B";
}

std::string end_words(const PacketTrace& trace, const RingNames& names) {
  if (trace.came_home())
    return std::string(to_string(trace.end)) + " after " + in_us(trace.ended - trace.sent()) + " us, waited " +
           in_us(trace.waited()) + " us";
  const Hop& last = trace.hops.back();
  return "was not seen coming home; last seen " + place_of(last.out ? *last.out : *last.in, names) + " after " +
         in_us(trace.ended - trace.began) + " us";
}

std::vector<std::string> retry_words(const PacketTrace& trace, const RingNames& names) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < trace.earlier.size(); ++i) {
    const PacketTrace::Earlier& tried = trace.earlier[i];
    const auto next = i + 1 < trace.earlier.size() ? trace.earlier[i + 1].began : trace.began;
    words.push_back("try " + number_of(tried.code) + ", " + in_us(trace.began - tried.began) + " us before: " +
                    why_again(tried.end,
                              tried.end == TripEnd::not_home ? next - tried.began : tried.last_seen.last - tried.began,
                              tried.last_seen, names));
  }
  const std::uint8_t first = trace.earlier.empty() ? trace.code : trace.earlier.front().code;
  if (wire::code_of(first).attempt > 0) words.insert(words.begin(), "the tries before are not in this capture");
  return words;
}

std::string hop_words(const PacketTrace& trace, std::size_t place, const RingNames& names) {
  const Hop& hop = trace.hops[place];
  std::string words;
  if (hop.unseen != 0)
    add(words, to_string(hop.unseen) + (hop.unseen == 1 ? " node" : " nodes") + " before it not in this capture");
  if (mostly_on_line(trace, place)) add(words, "most of the time on the line here, or until this node's process ran");
  const std::string damage = damage_of(hop.in ? *hop.in : *hop.out);
  if (!damage.empty()) add(words, damage);
  const std::string behind = behind_words(hop, names);
  if (!behind.empty()) add(words, behind);
  const std::string embedded = hop.out ? embedded_words(*hop.out, names) : "";
  if (!embedded.empty()) add(words, embedded);
  for (const SeenPacket& cut : hop.cut_by)
    add(words, "cut into by " + std::string(cut.info.own ? "own " : "") + packet_words(cut, names) + " after " +
                   in_us(cut.began - hop.out->began) + " us, behind byte " + to_string(cut.info.carrier_offset));
  if (!hop.in || !hop.in->home()) return words;
  add(words, "home");
  if (hop.in->trailer && hop.in->trailer->fbc == wire::kFbcUntaken) add(words, "nobody took it");
  if (hop.in->trailer && hop.in->trailer->fbc == 0) add(words, "refused");
  return words;
}

namespace {

std::string time_or_dash(const std::optional<capture::SeenPacket>& seen, std::chrono::nanoseconds since) {
  return seen ? in_us(seen->began - since) : "-";
}

std::string us_or_dash(const std::optional<std::chrono::nanoseconds>& time) { return time ? in_us(*time) : "-"; }

/// A trace as text for people: what it is, a line for each node, times in us since it went out.
std::string trace_text(const capture::PacketTrace& trace, const capture::RingNames& names) {
  std::string text = title_of(trace, names) + "  " + end_words(trace, names) + "\n";
  for (const std::string& words : retry_words(trace, names)) text += words + "\n";
  std::vector<std::vector<std::string>> rows{{"node", "line, us", "in, us", "out, us", "waited", "why"}};
  for (std::size_t i = 0; i < trace.hops.size(); ++i) {
    const Hop& hop = trace.hops[i];
    rows.push_back({names.of(hop.node), us_or_dash(trace.on_line(i)), time_or_dash(hop.in, trace.began),
                    time_or_dash(hop.out, trace.began), us_or_dash(hop.waited()), hop_words(trace, i, names)});
  }
  return text + app::text_table(rows);
}

using std::chrono::nanoseconds;

// In pixels.
constexpr double kLabels = 130, kWidth = 760, kRow = 26, kBar = 16, kTop = 56, kMargin = 20, kThinnest = 2;
constexpr std::int64_t kMostTicks = 8;

constexpr const char* kPacket = "#1f6fb2";
constexpr const char* kWaiting = "#bcd9f0";
constexpr const char* kOther = "#9a9a9a";
constexpr const char* kInterrupt = "#d02020";

/// 1, 2 or 5 times a power of ten, so that not too many ticks fit into the time.
std::int64_t tick_of(nanoseconds time) {
  for (std::int64_t tick = 1;; tick *= 10)
    for (const std::int64_t step : {tick, 2 * tick, 5 * tick})
      if (time.count() / step <= kMostTicks) return step;
}

class Picture {
 public:
  Picture(const capture::PacketTrace& trace, const capture::RingNames& names) : trace_(trace), names_(names) {}

  std::string draw() {
    const double height = kTop + kRow * static_cast<double>(trace_.hops.size()) + 2 * kRow;
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << kLabels + kWidth + kMargin << "\" height=\""
         << height << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
         << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    text(kMargin, 20, title_of(trace_, names_), "start");
    text(kMargin, 38, end_words(trace_, names_), "start");
    axis();
    for (std::size_t row = 0; row < trace_.hops.size(); ++row) hop(row);
    out_ << "</svg>\n";
    return out_.str();
  }

 private:
  double x(nanoseconds time) const {
    const double whole = std::max<double>(1, static_cast<double>((trace_.ended - trace_.began).count()));
    const double share = static_cast<double>((time - trace_.began).count()) / whole;
    return kLabels + kWidth * std::clamp(share, 0.0, 1.0);
  }
  static double y(std::size_t row) { return kTop + kRow * static_cast<double>(row); }

  void text(double x, double y, const std::string& words, const char* anchor) {
    out_ << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << config::xml_text(words)
         << "</text>\n";
  }

  void bar(nanoseconds from, nanoseconds to, std::size_t row, const char* colour, const std::string& title) {
    const double left = x(from), width = std::max(kThinnest, x(to) - left);
    out_ << "<rect x=\"" << left << "\" y=\"" << y(row) << "\" width=\"" << width << "\" height=\"" << kBar
         << "\" fill=\"" << colour << "\"><title>" << config::xml_text(title) << "</title></rect>\n";
  }

  void axis() {
    const double bottom = y(trace_.hops.size());
    const std::int64_t tick = tick_of(trace_.ended - trace_.began);
    for (nanoseconds at{0}; at <= trace_.ended - trace_.began; at += nanoseconds(tick)) {
      const double place = x(trace_.began + at);
      out_ << "<path d=\"M" << place << " " << kTop - 6 << "V" << bottom << "\" stroke=\"#dddddd\"/>\n";
      text(place, bottom + 16, in_us(at), "middle");
    }
    text(kMargin, bottom + 16, "us", "start");
  }

  void seen(const SeenPacket& packet, std::size_t row, const char* colour) {
    bar(packet.began, packet.last, row, packet.interrupt() ? kInterrupt : colour, packet_words(packet, names_));
  }

  void hop(std::size_t row) {
    const Hop& hop = trace_.hops[row];
    text(kLabels - 8, y(row) + kBar - 4, names_.of(hop.node), "end");
    for (const SeenPacket& other : hop.behind) seen(other, row, kOther);
    if (hop.waited()) wait(hop, row);
    if (hop.out || hop.in) bar(line(hop).began, line(hop).last, row, kPacket, hop_words(trace_, row, names_));
    for (const SeenPacket& cut : hop.cut_by) seen(cut, row, kInterrupt);
  }

  /// Draws the wait below the packets that it waited for, so that these stay visible.
  void wait(const Hop& hop, std::size_t row) {
    const double left = x(hop.in->began), width = x(hop.out->began) - left;
    if (width <= 0) return;
    out_ << "<rect x=\"" << left << "\" y=\"" << y(row) + kBar << "\" width=\"" << width << "\" height=\"4\" fill=\""
         << kWaiting << "\"><title>waited " << in_us(*hop.waited()) << " us</title></rect>\n";
  }

  static const SeenPacket& line(const Hop& hop) { return hop.out ? *hop.out : *hop.in; }

  const capture::PacketTrace& trace_;
  const capture::RingNames& names_;
  std::ostringstream out_;
};

/// A trace as a picture, SVG: nodes downwards in the order of the path, time to the right. On each node's
/// line out the packet's bar, light before it while it waited, grey what was in its way, INTPs as marks.
std::string trace_svg(const capture::PacketTrace& trace, const capture::RingNames& names) {
  return Picture(trace, names).draw();
}

using nlohmann::json;

json packet_row(const SeenPacket& packet, const RingNames& names) {
  const wire::Code code = wire::code_of(packet.code);
  json row{{"kind", code.interrupt ? "INTP" : "DATP"},
           {"source", names.of(packet.source)},
           {"try", code.attempt},
           {"sequence", +code.sequence},
           {"own", packet.info.own},
           {"began_ns", packet.began.count()},
           {"last_ns", packet.last.count()}};
  if (packet.info.embedded) row["offset"] = packet.info.carrier_offset;
  return row;
}

json rows_of(const std::vector<SeenPacket>& packets, const RingNames& names) {
  json rows = json::array();
  for (const SeenPacket& packet : packets) rows.push_back(packet_row(packet, names));
  return rows;
}

json hop_row(const capture::PacketTrace& trace, std::size_t place, const RingNames& names) {
  const capture::Hop& hop = trace.hops[place];
  const auto line = trace.on_line(place);
  const auto waited = hop.waited();
  return {{"node", names.of(hop.node)},
          {"unseen_before", hop.unseen},
          {"line_ns", line ? json(line->count()) : json()},
          {"in_ns", hop.in ? json(hop.in->began.count()) : json()},
          {"out_ns", hop.out ? json(hop.out->began.count()) : json()},
          {"waited_ns", waited ? json(waited->count()) : json()},
          {"behind", rows_of(hop.behind, names)},
          {"cut_by", rows_of(hop.cut_by, names)},
          {"why", hop_words(trace, place, names)}};
}

/// The same as a line of JSON, times in ns by the capture's clock.
std::string trace_json(const capture::PacketTrace& trace, const RingNames& names) {
  const wire::Code code = wire::code_of(trace.code);
  json row{{"packet", title_of(trace, names)},
           {"source", names.of(trace.source)},
           {"try", code.attempt},
           {"sequence", +code.sequence},
           {"end", to_string(trace.end)},
           {"sent_ns", trace.sent().count()},
           {"began_ns", trace.began.count()},
           {"ended_ns", trace.ended.count()},
           {"waited_ns", trace.waited().count()},
           {"retries", retry_words(trace, names)},
           {"hops", json::array()}};
  for (std::size_t place = 0; place < trace.hops.size(); ++place) row["hops"].push_back(hop_row(trace, place, names));
  return row.dump();
}

using std::chrono::milliseconds;
using std::chrono::steady_clock;

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

/// If one is asked for and it is not open yet. @throw UsageError
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

}  // namespace

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

}  // namespace limb_ring::ringctl
