#include "tools/ringctl/trace_words.h"

#include "tools/capture_text/packet_text.h"
#include "wire/data_packet.h"

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

}  // namespace limb_ring::ringctl
