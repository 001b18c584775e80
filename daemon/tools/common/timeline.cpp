#include "tools/common/timeline.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <utility>

#include "tools/common/packet_text.h"
#include "wire/packet.h"
#include "wire/traced_ring.h"

namespace limb_ring::app {

namespace {

using capture::SeenPacket;
using nlohmann::json;
using Line = std::pair<std::uint8_t, std::uint8_t>;  // from, to

// Chrome's processes are groups of tracks in Perfetto.
constexpr int kLines = 1, kCpus = 2;

Line line_of(const SeenPacket& packet) { return {packet.info.from, packet.info.to}; }
int track_of(const Line& line) { return line.first * 256 + line.second + 1; }
/// None of a line's: a number may name one track only. Nor its group's number, which would make it the "main thread".
int track_of(std::uint8_t node) { return 0x10001 + node; }

/// So that both ways in which readers come to whole nanoseconds give the same: the digits up to the third behind the
/// point, and 1000 times the number, cut off. A slice that lasts 1 ns too long would not be shown at all.
double timestamp_us(std::chrono::nanoseconds time) {
  const auto ns = static_cast<double>(time.count());
  const double us = ns / 1000;
  return us * 1000 < ns ? std::nextafter(us, us + 1) : us;
}

class Timeline {
 public:
  Timeline(std::ostream& out, const capture::RingNames& names) : out_(out), names_(names) {}

  void write(std::vector<SeenPacket> packets, const std::vector<capture::CapturedEvent>& events) {
    keep_one_end(packets);
    std::stable_sort(packets.begin(), packets.end(),
                     [](const SeenPacket& a, const SeenPacket& b) { return a.began < b.began; });
    begin_ = packets.empty() ? std::chrono::nanoseconds::max() : packets.front().began;
    for (const auto& event : events) begin_ = std::min(begin_, std::chrono::nanoseconds(event.time_ns));
    if (packets.empty() && events.empty()) begin_ = {};
    out_ << R"({"displayTimeUnit": "ns", "otherData": {"begins_ns": )" << begin_.count() << R"(}, "traceEvents": [)";
    name_tracks(packets, events);
    const auto ends = nested_ends(packets);
    for (std::size_t i = 0; i < packets.size(); ++i) packet(packets[i], ends[i]);
    arrows(packets);
    for (const auto& event : events)
      instant(kCpus, track_of(event.node), event.what, std::chrono::nanoseconds(event.time_ns));
    out_ << "\n]}\n";
  }

 private:
  /// Of each line its inputs; its outputs if there are none.
  static void keep_one_end(std::vector<SeenPacket>& packets) {
    std::set<Line> with_inputs;
    for (const SeenPacket& packet : packets)
      if (packet.info.input) with_inputs.insert(line_of(packet));
    const auto other_end = [&](const SeenPacket& packet) {
      return !packet.info.input && with_inputs.count(line_of(packet)) != 0;
    };
    packets.erase(std::remove_if(packets.begin(), packets.end(), other_end), packets.end());
  }

  /// Slices of a track have to lie beside or inside each other: one that lasts into a later one that is not inside it
  /// ends where that begins.
  static std::vector<std::chrono::nanoseconds> nested_ends(const std::vector<SeenPacket>& packets) {
    std::vector<std::chrono::nanoseconds> ends;
    std::map<Line, std::vector<std::size_t>> open;  // outermost first
    for (std::size_t i = 0; i < packets.size(); ++i) {
      ends.push_back(packets[i].last);
      if (packets[i].interrupt()) continue;
      std::vector<std::size_t>& around = open[line_of(packets[i])];
      while (!around.empty() && ends[around.back()] < ends[i]) {
        ends[around.back()] = std::min(ends[around.back()], packets[i].began);
        around.pop_back();
      }
      around.push_back(i);
    }
    return ends;
  }

  void put(const json& event) {
    out_ << (first_ ? "\n" : ",\n") << event.dump();
    first_ = false;
  }

  void name(int group, int track, const std::string& text) {
    put({{"ph", "M"}, {"pid", group}, {"tid", track}, {"name", "thread_name"}, {"args", {{"name", text}}}});
    put({{"ph", "M"},
         {"pid", group},
         {"tid", track},
         {"name", "thread_sort_index"},
         {"args", {{"sort_index", track}}}});
  }

  void name_tracks(const std::vector<SeenPacket>& packets, const std::vector<capture::CapturedEvent>& events) {
    for (const auto& [group, text] : {std::pair(kLines, "lines"), std::pair(kCpus, "nodes and CPUs")})
      put({{"ph", "M"}, {"pid", group}, {"name", "process_name"}, {"args", {{"name", names_.ring + ": " + text}}}});
    std::set<Line> lines;
    for (const SeenPacket& packet : packets) lines.insert(line_of(packet));
    for (const Line& line : lines) name(kLines, track_of(line), names_.line(line.first, line.second));
    std::set<std::uint8_t> nodes;
    for (const auto& event : events) nodes.insert(event.node);
    for (const std::uint8_t node : nodes) name(kCpus, track_of(node), names_.of(node));
  }

  std::string destination(const SeenPacket& packet) const {
    if (!packet.trailer) return "?";
    return packet.trailer->destination == wire::kBroadcast ? "all" : names_.of(packet.trailer->destination);
  }

  std::string title(const SeenPacket& packet) const {
    const std::string factor = packet.trailer ? std::to_string(packet.trailer->last) : "?";
    return (packet.interrupt() ? "INT" + factor + " " : "") + names_.of(packet.source) + " -> " + destination(packet);
  }

  static json facts(const SeenPacket& packet) {
    const wire::Code code = wire::code_of(packet.code);
    json all{{"try", code.attempt}, {"sequence", +code.sequence}, {"hop", packet.hop}, {"bytes", packet.size}};
    if (packet.trailer) all["fbc"] = packet.trailer->fbc;
    if (packet.trailer && !code.interrupt) {
      all["priority"] = +wire::priority_of(packet.trailer->last);
      all["channel"] = channel_name(wire::channel_of(packet.trailer->last));
    }
    if (packet.info.crc_bad) all["damage"] = "bad CRC";
    if (packet.info.aborted) all["damage"] = "aborted";
    if (packet.info.truncated) all["damage"] = "truncated";
    return all;
  }

  void instant(int group, int track, const std::string& what, std::chrono::nanoseconds at, const json& args = {}) {
    json event{{"ph", "i"},   {"s", "t"}, {"pid", group}, {"tid", track}, {"ts", timestamp_us(at - begin_)},
               {"name", what}};
    if (!args.is_null()) event["args"] = args;
    put(event);
  }

  void packet(const SeenPacket& packet, std::chrono::nanoseconds end) {
    const int track = track_of(line_of(packet));
    if (packet.interrupt()) return instant(kLines, track, title(packet), packet.began, facts(packet));
    put({{"ph", "X"},
         {"pid", kLines},
         {"tid", track},
         {"ts", timestamp_us(packet.began - begin_)},
         {"dur", timestamp_us(end - packet.began)},
         {"name", title(packet)},
         {"args", facts(packet)}});
  }

  /// From each line that a packet was on to the next one.
  void arrows(const std::vector<SeenPacket>& packets) {
    const auto trips = capture::sort_into_trips(packets);
    for (std::size_t trip = 0; trip < trips.size(); ++trip) {
      const std::vector<std::size_t>& seen = trips[trip].seen;
      if (seen.size() < 2 || packets[seen.front()].interrupt()) continue;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const char* step = i == 0 ? "s" : i + 1 == seen.size() ? "f" : "t";
        put({{"ph", step},
             {"bp", "e"},
             {"cat", "hop"},
             {"name", "path"},
             {"id", trip},
             {"pid", kLines},
             {"tid", track_of(line_of(packets[seen[i]]))},
             {"ts", timestamp_us(packets[seen[i]].began - begin_)}});
      }
    }
  }

  std::ostream& out_;
  const capture::RingNames& names_;
  std::chrono::nanoseconds begin_{0};
  bool first_ = true;
};

}  // namespace

void write_timeline(std::ostream& out, const capture::RingNames& names, const std::vector<SeenPacket>& packets,
                    const std::vector<capture::CapturedEvent>& events) {
  Timeline(out, names).write(packets, events);
}

void write_timeline(std::ostream& out, std::istream& capture, const std::string& name) {
  capture::PcapngReader reader(capture, name);
  std::vector<SeenPacket> packets;
  std::vector<capture::CapturedEvent> events;
  while (const auto record = reader.next()) {
    if (const auto* packet = std::get_if<CapturedPacket>(&*record)) packets.push_back(capture::seen(*packet));
    if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) events.push_back(*event);
  }
  write_timeline(out, reader.names(), packets, events);
}

}  // namespace limb_ring::app
