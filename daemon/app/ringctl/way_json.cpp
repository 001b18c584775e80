#include <nlohmann/json.hpp>

#include "app/ringctl/way_words.h"

namespace limb_ring::ringctl {

namespace {

using capture::RingNames;
using capture::SeenPacket;
using nlohmann::json;

json packet_row(const SeenPacket& packet, const RingNames& names) {
  const wire::Code code = wire::code_of(packet.code);
  json row{{"kind", code.interrupt ? "INTP" : "DATP"}, {"source", names.of(packet.source)},
           {"try", code.attempt}, {"sequence", code.sequence}, {"own", packet.info.own},
           {"began_ns", packet.began.count()}, {"last_ns", packet.last.count()}};
  if (packet.info.embedded) row["offset"] = packet.info.carrier_offset;
  return row;
}

json rows_of(const std::vector<SeenPacket>& packets, const RingNames& names) {
  json rows = json::array();
  for (const SeenPacket& packet : packets) rows.push_back(packet_row(packet, names));
  return rows;
}

json hop_row(const capture::Way& way, std::size_t place, const RingNames& names) {
  const capture::Hop& hop = way.hops[place];
  const auto line = way.on_line(place);
  const auto waited = hop.waited();
  return {{"node", names.of(hop.node)},
          {"unseen_before", hop.unseen},
          {"line_ns", line ? json(line->count()) : json()},
          {"in_ns", hop.in ? json(hop.in->began.count()) : json()},
          {"out_ns", hop.out ? json(hop.out->began.count()) : json()},
          {"waited_ns", waited ? json(waited->count()) : json()},
          {"behind", rows_of(hop.behind, names)},
          {"cut_by", rows_of(hop.cut_by, names)},
          {"why", hop_words(way, place, names)}};
}

}  // namespace

std::string way_json(const capture::Way& way, const RingNames& names) {
  const wire::Code code = wire::code_of(way.code);
  json row{{"packet", title_of(way, names)}, {"source", names.of(way.source)}, {"try", code.attempt},
           {"sequence", code.sequence}, {"end", to_string(way.end)}, {"sent_ns", way.sent().count()},
           {"began_ns", way.began.count()}, {"ended_ns", way.ended.count()}, {"waited_ns", way.waited().count()},
           {"retries", retry_words(way, names)}, {"hops", json::array()}};
  for (std::size_t place = 0; place < way.hops.size(); ++place) row["hops"].push_back(hop_row(way, place, names));
  return row.dump();
}

}  // namespace limb_ring::ringctl
