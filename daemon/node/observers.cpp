#include "node/observers.h"

#include <algorithm>
#include <utility>

#include "node/request_fields.h"

namespace limb_ring::runtime {

void Observers::set(host::ClientId client, const std::set<std::string>& kinds) {
  told_ = {};
  if (kinds.empty()) return remove(client);
  wanted_[client] = kinds;
}

bool Observers::wants(const std::string& kind) const {
  return std::any_of(wanted_.begin(), wanted_.end(),
                     [&](const auto& client) { return client.second.count(kind) != 0; });
}

void Observers::tell(const std::string& kind, nlohmann::json what) {
  if (!wants(kind)) return;
  what["kind"] = kind;
  what["time_ns"] = clock_.wall_ns(clock_.now());
  const std::string line = text_of(what);
  for (const auto& [client, kinds] : wanted_)
    if (kinds.count(kind) != 0) host_.observed(client, line);
}

void Observers::tell_changes(const NodeDriver& driver) {
  if (!any()) return;
  Figures now;
  now.ring_size = driver.controller().membership().ring_size();
  now.crc_errors = driver.controller().counters().crc_errors;
  now.line_corrupted = driver.breaker(core::Line::first).counters().line_corrupted;
  const Figures before = std::exchange(told_, now);
  if (now.ring_size != before.ring_size) tell("ring", {{"ring_size", now.ring_size}});
  if (now.crc_errors != before.crc_errors || now.line_corrupted != before.line_corrupted)
    tell("noise", {{"crc_errors", now.crc_errors}, {"line_corrupted", now.line_corrupted}});
}

}  // namespace limb_ring::runtime
