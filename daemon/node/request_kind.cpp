#include "node/request_kind.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "config/names.h"
#include "node/request_fields.h"

namespace limb_ring::runtime {

const std::vector<RequestKind>& request_kinds() {
  static const std::vector<RequestKind> kinds{
      {"allow", {"outer_zero_ns", "until_ns"}, false},
      {"clear_faults", {}, true},
      {"clock", {}, false},
      {"config", {}, false},
      {"fault", {"fault"}, true},
      {"faults", {}, false},
      {"latch", {}, false},
      {"pace", {"pace"}, false},
      {"pause", {}, false},
      {"ping", {"count", "deadline_ms", "duration_ms", "interval_us", "priority", "size", "to"}, true},
      {"remove_fault", {"id"}, true},
      {"reset", {"node", "timeout_ms"}, true},
      {"run", {}, false},
      {"setup", {}, false},
      {"shutdown", {}, false},
      {"status", {}, false},
      {"step", {"time_ns"}, false},
      {"stop", {"node"}, true},
      {"stop_latched", {"latched"}, false},
      {"sync", {}, true},
      {"went_on_without", {"whom"}, false}};
  return kinds;
}

const RequestKind* find_request_kind(const nlohmann::json& request) {
  const auto name = request.find("do");
  if (name == request.end() || !name->is_string()) return nullptr;
  const auto& kinds = request_kinds();
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const RequestKind& kind) { return *name == kind.name; });
  return found == kinds.end() ? nullptr : &*found;
}

void require_known_members(const nlohmann::json& request, const RequestKind& kind) {
  std::vector<std::string> known = kind.members;
  known.emplace_back("do");
  if (const auto unknown = unknown_member(request, known))
    throw RequestError(kind.name + ": '" + *unknown + "' is unknown; " +
                       (kind.members.empty() ? "it takes nothing" : "it takes: " + config::join(kind.members)));
}

}  // namespace limb_ring::runtime
