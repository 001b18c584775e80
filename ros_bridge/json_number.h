#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

namespace limb_ring::bridge {

/// A member of what a daemon says, where that is a whole number.
inline std::int64_t number_of(const nlohmann::json& said, const char* member, std::int64_t otherwise) {
  const auto found = said.find(member);
  return found != said.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

}  // namespace limb_ring::bridge
