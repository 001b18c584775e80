#pragma once

#include <limb_ring/RingStatus.h>
#include <std_msgs/ColorRGBA.h>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// The condition of a node, each shown in a colour of its own.
enum class Condition {
  well,     ///< up, and its CPU runs
  unclear,  ///< joining, in an open chain, folded, its CPU boots or is not there
  hung,     ///< its network controller relays, its CPU does not answer
  down      ///< not heard, alone, or with a duplicate id
};

Condition condition_of(const config::NodeConfig& node, const RingStatus& ring);
std_msgs::ColorRGBA colour_of(Condition condition, float alpha = 1);
std_msgs::ColorRGBA colour(float red, float green, float blue, float alpha = 1);

}  // namespace limb_ring::bridge
