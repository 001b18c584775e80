#pragma once

#include <XmlRpcValue.h>

#include <string>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// Which frames are published: the private parameters below `frames`, all of which may be left out.
///
///   nodes        names or ids, or `all`: whose lines are observed; default: the bridge's own node, whose
///                input every packet of a closed ring passes once
///   at           in, out; default in
///   kinds        data, control, interrupt; default all
///   source       names or ids; default all
///   destination  names or ids, `all`: broadcasts; default all
///   priority, channel   numbers, of data packets; default all
///   sample       n: every n-th of those, from 1; default 1
///   limit        at most so many a second from each node, 0: no limit; default 1000
///
/// A list of one may be given without brackets.
struct FrameFilter {
  std::vector<const config::NodeConfig*> nodes;
  std::string order;  ///< as HostPort::observe() takes it
};

/// @throw std::invalid_argument naming parameter, value and what would be right
FrameFilter read_frame_filter(XmlRpc::XmlRpcValue parameters, const config::RingConfig& ring,
                              const config::NodeConfig& own);

}  // namespace limb_ring::bridge
