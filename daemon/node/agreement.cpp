#include "node/agreement.h"

#include <string>

namespace limb_ring::setup {
namespace {

using config::JointConfig;
using config::NodeConfig;
using config::PinConfig;
using config::RingConfig;
using config::SensorConfig;

/// A line of text for each node in ring order: its id and what `rest` says of it.
template <typename Rest>
std::string line_per_node(const RingConfig& ring, Rest rest) {
  std::string text;
  for (const NodeConfig& node : ring.nodes) text += std::to_string(node.id) + rest(node) + '\n';
  return text;
}

std::string redundancy_text(const RingConfig& ring) { return ring.folds_back() ? "foldback\n" : "none\n"; }

std::string timeouts_text(const config::Timeouts& t) {
  std::string text;
  for (const auto time :
       {t.send, t.stall, t.idle, t.silence, t.first_successor, t.break_grace, t.fold_permission, t.beacon})
    text += std::to_string(time.count()) + '\n';
  return text;
}

std::string line_text(const NodeConfig& node) {
  return ' ' + std::to_string(node.link.rate) + ' ' + std::to_string(node.link.whole_delay().count());
}

std::string joints_text(const NodeConfig& node) {
  std::string text;
  for (const JointConfig& joint : node.joints) text += (joint.slides() ? " slide " : " joint ") + joint.name;
  for (const SensorConfig& sensor : node.sensors)
    text += (sensor.kind == SensorConfig::Kind::imu ? " imu " : " force ") + sensor.name;
  return text;
}

const char* action_name(PinConfig::Action action) {
  switch (action) {
    case PinConfig::Action::none:
      return " none";
    case PinConfig::Action::reset:
      return " reset";
    case PinConfig::Action::stop:
      return " stop";
    case PinConfig::Action::signal:
      return " signal";
    case PinConfig::Action::notify:
      return " notify";
    case PinConfig::Action::sync:
      return " sync";
    case PinConfig::Action::exec:
      return " exec";
  }
  return "";
}

std::string pins_text(const NodeConfig& node) {
  std::string text;
  for (const PinConfig& pin : node.pins) text += action_name(pin.action);
  return text;
}

}  // namespace

link::Agreement agreement_of(const RingConfig& ring) {
  return {{link::text_hash(line_per_node(ring, [](const NodeConfig& node) { return ' ' + node.name; })),
           link::text_hash(redundancy_text(ring)), link::text_hash(timeouts_text(ring.timeouts)),
           link::text_hash(line_per_node(ring, line_text)), link::text_hash(line_per_node(ring, joints_text)),
           link::text_hash(line_per_node(ring, pins_text)),
           link::text_hash(std::to_string(config::supervisor_of(ring).id) + '\n')}};
}

}  // namespace limb_ring::setup
