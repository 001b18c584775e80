#include "node/request_fields.h"

#include <algorithm>

#include "client/arguments.h"
#include "config/characters.h"
#include "wire/packet.h"

namespace limb_ring::runtime {
namespace {

std::string word(const nlohmann::json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

std::string names_of(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes) names += (names.empty() ? "" : ", ") + std::to_string(node.id) + " " + node.name;
  return names;
}

}  // namespace

std::string text_of(const nlohmann::json& answer) {
  return answer.dump(-1, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json object_in(const std::string& text, const char* problem) {
  if (const auto deep = client::json_problem(text)) throw RequestError(*deep);
  nlohmann::json object = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw RequestError(problem);
  return object;
}

std::optional<std::string> unknown_member(const nlohmann::json& object, const std::vector<std::string>& known) {
  for (const auto& [member, value] : object.items())
    if (std::find(known.begin(), known.end(), member) == known.end()) return config::printable(member);
  return std::nullopt;
}

std::uint64_t number_in(const nlohmann::json& request, const std::string& field, std::uint64_t otherwise,
                        std::uint64_t least, std::uint64_t most) {
  if (!request.contains(field)) return otherwise;
  const auto& value = request[field];
  if (value.is_number_integer() && value.get<std::int64_t>() >= 0 && value.get<std::uint64_t>() >= least &&
      value.get<std::uint64_t>() <= most)
    return value.get<std::uint64_t>();
  throw RequestError(field + ": " + word(value) + " is not a whole number from " + std::to_string(least) + " to " +
                     std::to_string(most));
}

const config::NodeConfig& node_in(const config::RingConfig& ring, const nlohmann::json& request,
                                  const std::string& field) {
  if (!request.contains(field)) throw RequestError(field + " is missing: a node's id or name");
  const config::NodeConfig* node = ring.find(word(request[field]));
  if (node == nullptr)
    throw RequestError(field + ": ring " + ring.ring + " has no node '" + word(request[field]) +
                       "'; it has: " + names_of(ring));
  return *node;
}

std::uint8_t nodes_in(const config::RingConfig& ring, const nlohmann::json& request, const std::string& field) {
  if (!request.contains(field) || request[field] == "all") return wire::kBroadcast;
  return node_in(ring, request, field).id;
}

}  // namespace limb_ring::runtime
