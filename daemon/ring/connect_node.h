#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::live {

/// Whether somebody asks and goes, or needs its place for long: see ConnectOptions::asks_only.
enum class Stay : std::uint8_t { asks_only, for_long };

/// Connects to a node's daemon without waiting for one that is not there. @throw HostPortError
/// @param node id or name
/// @param meanwhile as ConnectOptions::meanwhile
HostPort connect_node(const std::string& ring, const std::string& node, Stay stay = Stay::asks_only,
                      std::function<void()> meanwhile = {});

/// The same to a virtual ring's own host port, which is of no node. @throw HostPortError
HostPort connect_ring(const std::string& ring);

/// As HostPort::ask(), but for people, who did not write the request: what goes wrong does not quote it.
nlohmann::json ask_for_people(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout);

}  // namespace limb_ring::live
