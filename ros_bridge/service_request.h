#pragma once

#include <ros/duration.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "ring/status_rows.h"

namespace limb_ring::bridge {

/// @name What callers of services write. @throw std::invalid_argument saying what is allowed
///@{

constexpr std::chrono::seconds kServiceAnswer{10};  ///< a send ends after timeouts.queue and its tries

/// The time-out that was asked for; 0: the usual one. Very short ones are refused: rosservice reads a whole number as
/// nanoseconds, which nobody means here.
std::chrono::milliseconds timeout_of(const ros::Duration& asked, std::chrono::seconds usual = kServiceAnswer);

/// Id of a node by id or name.
std::uint8_t one_node(const config::RingConfig& ring, const std::string& node);
/// The same, or kBroadcast for "all".
std::uint8_t destination_of(const config::RingConfig& ring, const std::string& node);
/// The one of that id or name; all for "all" and where none is named.
std::vector<ask::Node> nodes_to_ask(const config::RingConfig& ring, const std::string& which = "");

///@}

}  // namespace limb_ring::bridge
