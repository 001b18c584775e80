#include <nlohmann/json.hpp>

#include "tools/ringctl/trace_words.h"

namespace limb_ring::ringctl {

namespace {

using capture::RingNames;
using capture::SeenPacket;
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

}  // namespace

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

}  // namespace limb_ring::ringctl
