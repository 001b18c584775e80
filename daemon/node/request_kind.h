#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace limb_ring::runtime {

constexpr const char* kRequestRule = "a request is a JSON object {\"do\": \"...\", ...}";

/// A request that a daemon answers (docs/reference/requests.md).
struct RequestKind {
  std::string name;                  ///< its `do`
  std::vector<std::string> members;  ///< what else it may have
  bool changes_something;            ///< of the ring; its clock aside
};

/// All of them, by name.
const std::vector<RequestKind>& request_kinds();

/// @return that of an object's `do`; null where there is no such request
const RequestKind* find_request_kind(const nlohmann::json& request);

/// @throw RequestError naming a member that requests of this kind do not take, and those they take
void require_known_members(const nlohmann::json& request, const RequestKind& kind);

}  // namespace limb_ring::runtime
