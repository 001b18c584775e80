#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::runtime {

/// A request that cannot be done; what() is its answer.
struct RequestError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// JSON for a client. Bytes that are no UTF-8, as in a path, become U+FFFD.
std::string text_of(const nlohmann::json& answer);

/// What a client wrote, an object. @param problem says what it should be
/// @throw RequestError where it is none, or nested too deep
nlohmann::json object_in(const std::string& text, const char* problem);

/// The first member that is not among these, printable; nothing where all are.
std::optional<std::string> unknown_member(const nlohmann::json& object, const std::vector<std::string>& known);

/// A whole number within `least` and `most`, `otherwise` where the field is missing.
/// @throw RequestError naming the field and what is allowed
std::uint64_t number_in(const nlohmann::json& request, const std::string& field, std::uint64_t otherwise,
                        std::uint64_t least, std::uint64_t most);

/// The node a field names, by id or name. @throw RequestError listing the nodes there are
const config::NodeConfig& node_in(const config::RingConfig& ring, const nlohmann::json& request,
                                  const std::string& field);

/// As node_in, or every node: "all", or the field is missing. @return its id, or wire::kBroadcast
std::uint8_t nodes_in(const config::RingConfig& ring, const nlohmann::json& request, const std::string& field);

}  // namespace limb_ring::runtime
