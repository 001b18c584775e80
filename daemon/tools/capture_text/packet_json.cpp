#include <nlohmann/json.hpp>

#include "tools/capture_text/packet_bytes.h"
#include "tools/capture_text/packet_text.h"
#include "tools/capture_text/payload_words.h"
#include "wire/data_packet.h"

namespace limb_ring::app {

using capture::RingNames;
using nlohmann::json;

namespace {

void add_trailer(json& row, const wire::PacketFields& fields, const RingNames& names) {
  const std::uint8_t to = fields.destination();
  row["destination"] = to == wire::kBroadcast ? "all" : names.of(to);
  row["did"] = to;
  row["fbc"] = fields.fbc();
  if (fields.code().interrupt) {
    row["factor"] = fields.last();
    return;
  }
  row["priority"] = +wire::priority_of(fields.last());
  row["channel"] = +wire::channel_of(fields.last());
  row["data"] = hex_words(fields.data());
}

}  // namespace

std::string packet_json(const CapturedPacket& packet, const RingNames& names) {
  const wire::ByteView bytes = bytes_of(packet);
  const CaptureInfo& info = packet.info;
  const wire::PacketFields fields{bytes};
  const wire::Code code = fields.code();
  json row{{"time_ns", packet.time_ns},
           {"line", {names.of(info.from), names.of(info.to)}},
           {"at", info.input ? "in" : "out"},
           {"kind", code.interrupt ? "INTP" : "DATP"},
           {"source", names.of(fields.source())},
           {"sid", +fields.source()},
           {"hop", fields.hop()},
           {"try", code.attempt},
           {"sequence", +code.sequence},
           {"size", packet.bytes.size()},
           {"span_ns", info.span.count()},
           {"crc_bad", info.crc_bad},
           {"aborted", info.aborted},
           {"truncated", info.truncated},
           {"retry", info.retry},
           {"own", info.own},
           {"lost_before", packet.lost_before}};
  if (info.embedded) row["inside"] = {{"sid", info.carrier_source}, {"offset", info.carrier_offset}};
  if (capture::PacketView{{}, info, bytes}.whole()) add_trailer(row, fields, names);
  return row.dump();
}

std::string event_json(const capture::CapturedEvent& event, const RingNames& names) {
  return json{{"time_ns", event.time_ns}, {"node", names.of(event.node)}, {"event", event.what}}.dump();
}

}  // namespace limb_ring::app
