#pragma once

#include "config/option.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// The one table of options, a section per map of the YAML file.
const Section<RingConfig>& ring_section();
const Section<Limits>& limits_section();
const Section<Timeouts>& timeouts_section();
/// The entry `links`: what every node's link has unless it says otherwise.
const Section<LinkConfig>& links_section();
const Section<Firmware>& firmware_section();
const Section<Realtime>& realtime_section();
const Section<RecorderConfig>& recorder_section();
const Section<SupervisorConfig>& supervisor_section();
const Section<VirtualClockConfig>& virtual_clock_section();
const Section<BridgeConfig>& bridge_section();
const Section<TopicConfig>& topic_section();
/// The entry `traffic`, a list.
Option<RingConfig> traffic_option();
const Section<TrafficConfig>& traffic_section();
const Section<NodeConfig>& node_section();
/// The entry `hosts`, a list.
Option<RingConfig> hosts_option();
const Section<HostConfig>& host_section();
/// A host of this ring, by name. @return its place in `hosts`. @throw ConfigError
std::size_t read_host(const Entry& entry);
/// The entry `expected` of a link.
const Section<ExpectedConfig>& expected_section();
/// The entry `link` of one node.
const Section<LinkConfig>& link_section();
const Section<CpuConfig>& cpu_section();
const Section<JointConfig>& joint_section();
const Section<SensorConfig>& sensor_section();
/// What each of a node's eight pins drives.
const Section<NodeConfig>& pins_section();
/// Where each of a node's eight interrupt inputs leads.
const Section<NodeConfig>& inputs_section();
const Section<InputConfig>& input_section();

}  // namespace limb_ring::config
