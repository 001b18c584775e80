#include "node/observe_filter.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "client/event_kinds.h"
#include "config/names.h"
#include "node/request_fields.h"
#include "wire/data_packet.h"

namespace limb_ring::runtime {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const Words kKinds{"data", "control", "interrupt"};  // by capture::Kind
const Words kLines{"in", "out"};
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();

const Words kMembers{"kinds", "packets", "promises"};
const Words kOfPackets{"at", "kinds", "source", "destination", "priority", "channel", "sample", "limit_per_s"};

void refuse_unknown(const json& from, const Words& allowed, const std::string& what) {
  if (const auto unknown = unknown_member(from, allowed))
    throw RequestError(what + ": '" + *unknown + "' is unknown; there are " + config::join(allowed));
}

json list_in(const json& from, const char* field) {
  if (!from.contains(field)) return json::array();
  if (!from[field].is_array()) throw RequestError(std::string("observe: ") + field + " is a list");
  return from[field];
}

std::set<std::size_t> words_in(const json& from, const char* field, const Words& allowed) {
  std::set<std::size_t> found;
  for (const json& word : list_in(from, field)) {
    const auto place = std::find(allowed.begin(), allowed.end(), word.is_string() ? word.get<std::string>() : "");
    if (place == allowed.end())
      throw RequestError(std::string("observe: ") + field + ": there is no " + word.dump() + "; there are " +
                         config::join(allowed));
    found.insert(static_cast<std::size_t>(place - allowed.begin()));
  }
  return found;
}

template <std::size_t N>
std::bitset<N> numbers_in(const json& from, const char* field) {
  std::bitset<N> found;
  for (const json& number : list_in(from, field)) found.set(number_in({{field, number}}, field, 0, 0, N - 1));
  return found;
}

/// A source may be an id that is not configured: so stray packets can be found.
std::bitset<256> nodes_of(const config::RingConfig& ring, const json& from, const char* field) {
  std::bitset<256> found;
  for (const json& node : list_in(from, field))
    found.set(node.is_number() ? number_in({{field, node}}, field, 0, 0, 255) : nodes_in(ring, {{field, node}}, field));
  return found;
}

capture::Choice choice_of(const config::RingConfig& ring, const json& packets) {
  if (!packets.is_object()) throw RequestError("observe: packets is an object");
  refuse_unknown(packets, kOfPackets, "observe: packets");
  capture::Choice choice;
  if (const auto at = words_in(packets, "at", kLines); !at.empty()) {
    choice.filter.input = at.count(0) != 0;
    choice.filter.output = at.count(1) != 0;
  }
  for (const std::size_t kind : words_in(packets, "kinds", kKinds)) choice.filter.kinds.set(kind);
  choice.filter.source = nodes_of(ring, packets, "source");
  choice.filter.destination = nodes_of(ring, packets, "destination");
  choice.filter.priority = numbers_in<4>(packets, "priority");
  choice.filter.channel = numbers_in<64>(packets, "channel");
  choice.sample = static_cast<std::uint32_t>(number_in(packets, "sample", 1, 1, kMost));
  choice.limit_per_s = static_cast<std::uint32_t>(number_in(packets, "limit_per_s", 0, 0, kMost));
  return choice;
}

}  // namespace

ObserveFilter read_observe_filter(const config::RingConfig& ring, const std::string& text) {
  const json order = object_in(text.empty() ? "{}" : text, "an observe filter is a JSON object");
  refuse_unknown(order, kMembers, "observe");
  ObserveFilter read;
  const Words& events = client::event_kinds();
  for (const std::size_t kind : words_in(order, "kinds", events)) read.kinds.insert(events[kind]);
  const bool packets = order.contains("packets");
  if (order.contains("promises")) {
    if (!order["promises"].is_boolean()) throw RequestError("observe: promises is true or false");
    read.promises = order["promises"].get<bool>();
  }
  if (read.kinds.empty() && !packets && !order.contains("promises")) read.kinds.insert(events.begin(), events.end());
  if (packets && !order["packets"].is_null()) read.packets = choice_of(ring, order["packets"]);
  return read;
}

}  // namespace limb_ring::runtime
