#include "runtime/observers.h"

#include <chrono>
#include <stdexcept>

namespace limb_ring::runtime {
namespace {

const std::set<std::string>& all_kinds() {
  static const std::set<std::string> kinds{"state", "ring", "link", "noise", "pin", "cpu", "watchdog", "sent"};
  return kinds;
}

std::string named(const std::set<std::string>& kinds) {
  std::string names;
  for (const std::string& kind : kinds) names += (names.empty() ? "" : ", ") + kind;
  return names;
}

}  // namespace

void Observers::add(host::ClientId client, const std::string& filter) {
  const auto json = nlohmann::json::parse(filter.empty() ? "{}" : filter, nullptr, false);
  if (!json.is_object()) throw std::invalid_argument("an observe filter is a JSON object");
  std::set<std::string> kinds;
  for (const auto& kind : json.value("kinds", nlohmann::json::array())) {
    if (!kind.is_string() || all_kinds().count(kind.get<std::string>()) == 0)
      throw std::invalid_argument("observe: no kind " + kind.dump() + "; there are " + named(all_kinds()));
    kinds.insert(kind.get<std::string>());
  }
  wanted_[client] = kinds.empty() ? all_kinds() : kinds;
}

void Observers::tell(const std::string& kind, nlohmann::json what) {
  if (!any()) return;
  what["kind"] = kind;
  what["time_ns"] = std::chrono::duration_cast<std::chrono::nanoseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count();
  const std::string line = what.dump();
  for (const auto& [client, kinds] : wanted_)
    if (kinds.count(kind) != 0) host_.observed(client, line);
}

}  // namespace limb_ring::runtime
