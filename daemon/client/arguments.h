#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace limb_ring::client {

/// What is wrong with the arguments of a call, in words; nothing where they are right. Both ends
/// of a host port ask here, so that a bad call says the same wherever it is caught.
std::optional<std::string> send_problem(std::size_t size, std::uint8_t priority,
                                        std::uint8_t channel);
std::optional<std::string> interrupt_problem(std::uint8_t factor);
std::optional<std::string> pull_problem(std::uint8_t input);

}  // namespace limb_ring::client
