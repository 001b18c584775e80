#include "ros_bridge/frames_out.h"

#include <ros/ros.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "config/ring_config.h"
#include "ros_bridge/parameters.h"
#include "wire/packet.h"

namespace limb_ring::bridge {
namespace {

constexpr std::uint32_t kFramesQueue = 1000;  // a second of them, by default

}  // namespace

FramesOut::FramesOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon,
                     FrameFilter filter, Counters& counters, const RosClock& clock)
    : ring_(ring),
      daemon_(daemon),
      filter_(std::move(filter)),
      counters_(counters),
      clock_(clock),
      nodes_(nodes),
      thread_(1, &queue_) {
  nodes_.setCallbackQueue(&queue_);
  const auto changed = [this](const ros::SingleSubscriberPublisher&) { on_subscribers(); };
  publisher_ = nodes_.advertise<Frame>("ring_frames", kFramesQueue, changed, changed);
  counters_.set("frames_watched_nodes", 0);
  thread_.start();
}

FramesOut::~FramesOut() { thread_.stop(); }

void FramesOut::on_subscribers() {
  const bool wanted = publisher_.getNumSubscribers() > 0;
  if (wanted == (listener_ != nullptr)) return;
  listener_.reset();
  counts_.clear();
  if (wanted)
    listener_ = std::make_unique<RingListener>(
        filter_.nodes, daemon_, filter_.order,
        [this](const config::NodeConfig& node, const Message& message) { take(node, message); });
  counters_.set("frames_watched_nodes", wanted ? filter_.nodes.size() : 0);
}

void FramesOut::take(const config::NodeConfig& node, const Message& message) {
  if (const auto* packet = std::get_if<CapturedPacket>(&message)) {
    publish(node, *packet);
  } else if (const auto* counts = std::get_if<CaptureCounts>(&message)) {
    counts_[node.id] = *counts;
  } else if (const auto* seen = std::get_if<Observed>(&message)) {
    ROS_WARN("node '%s' does not show its frames: %s", node.name.c_str(), seen->json.c_str());
  }
}

void FramesOut::publish(const config::NodeConfig& node, const CapturedPacket& packet) {
  CaptureCounts& counts = counts_[node.id];
  counts.lost += packet.lost_before;
  Frame frame = to_frame(packet, node, ring_);
  frame.header.stamp = clock_.to_ros(packet.time_ns);
  frame.filtered = counts.filtered;
  frame.sampled_out = counts.sampled_out;
  frame.limited = counts.limited;
  frame.lost = counts.lost;
  publisher_.publish(frame);
}

namespace {

using nlohmann::json;
using XmlRpc::XmlRpcValue;

constexpr int kLimit = 1000;  // frames a second that any reader keeps up with

const std::vector<std::string> kNames{"nodes",    "at",      "kinds",  "source", "destination",
                                      "priority", "channel", "sample", "limit"};

[[noreturn]] void refuse(const std::string& name, const std::string& value, const std::string& right) {
  throw std::invalid_argument("parameter ~frames/" + name + ": " + value + "; it must be " + right);
}

std::string text_of(const std::string& name, XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeString) return static_cast<std::string&>(value);
  if (value.getType() == XmlRpcValue::TypeInt) return std::to_string(static_cast<int&>(value));
  refuse(name, as_written(value), "a word or a number, or a list of them");
}

class Reader {
 public:
  Reader(XmlRpcValue& parameters, const config::RingConfig& ring) : parameters_(parameters), ring_(ring) {}

  std::vector<std::string> words(const std::string& name) const {
    std::vector<std::string> all;
    if (!parameters_.hasMember(name)) return all;
    XmlRpcValue& value = parameters_[name];
    if (value.getType() != XmlRpcValue::TypeArray) return {text_of(name, value)};
    for (int i = 0; i < value.size(); ++i) all.push_back(text_of(name, value[i]));
    return all;
  }

  json among(const std::string& name, const std::vector<std::string>& allowed) const {
    json list = json::array();
    for (const auto& word : words(name)) {
      if (std::find(allowed.begin(), allowed.end(), word) == allowed.end()) refuse(name, word, config::join(allowed));
      list.push_back(word);
    }
    return list;
  }

  const config::NodeConfig& node(const std::string& name, const std::string& word) const {
    if (const auto* found = ring_.find(word)) return *found;
    std::vector<std::string> there{"all"};
    for (const auto& each : ring_.nodes) there.push_back(each.name);
    refuse(name, word, "of: " + config::join(there));
  }

  json nodes(const std::string& name) const {
    json list = json::array();
    for (const auto& word : words(name)) {
      if (word == "all" && name == "destination")
        list.push_back("all");
      else
        list.push_back(node(name, word).id);
    }
    return list;
  }

  /// One named twice would be observed twice, and each of its frames shown twice.
  std::vector<const config::NodeConfig*> observed(const std::string& name) const {
    std::vector<const config::NodeConfig*> nodes;
    for (const auto& word : words(name)) {
      if (word == "all")
        for (const auto& each : ring_.nodes) nodes.push_back(&each);
      else
        nodes.push_back(&node(name, word));
    }
    for (auto each = nodes.begin(); each != nodes.end(); ++each)
      if (std::find(nodes.begin(), each, *each) != each)
        throw std::invalid_argument("parameter ~frames/" + name + ": node '" + (*each)->name + "' is named twice");
    return nodes;
  }

  json numbers(const std::string& name, int most) const {
    json list = json::array();
    for (const auto& word : words(name)) list.push_back(number(name, word, 0, most));
    return list;
  }

  int single(const std::string& name, int otherwise, int least) const {
    const auto all = words(name);
    if (all.empty()) return otherwise;
    if (all.size() > 1) refuse(name, config::join(all), "one number");
    return number(name, all.front(), least, 1000000);
  }

 private:
  static int number(const std::string& name, const std::string& word, int least, int most) {
    std::size_t end = 0;
    int value = -1;
    try {
      value = std::stoi(word, &end);
    } catch (const std::exception&) {
      end = 0;  // said below, with what would be right
    }
    if (end != word.size() || word.empty() || value < least || value > most)
      refuse(name, word, std::to_string(least) + " to " + std::to_string(most));
    return value;
  }

  XmlRpcValue& parameters_;
  const config::RingConfig& ring_;
};

void check_names(XmlRpcValue& parameters) {
  if (parameters.getType() != XmlRpcValue::TypeStruct)
    throw std::invalid_argument("parameter ~frames must be a map of: " + config::join(kNames));
  for (auto& [name, value] : parameters)
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end())
      throw std::invalid_argument("parameter ~frames/" + name + " does not exist; there are " + config::join(kNames));
}

}  // namespace

FrameFilter read_frame_filter(XmlRpcValue parameters, const config::RingConfig& ring, const config::NodeConfig& own) {
  if (!parameters.valid()) parameters.begin();  // nothing was given: an empty map
  check_names(parameters);
  const Reader reader(parameters, ring);
  FrameFilter filter;
  filter.nodes = reader.observed("nodes");
  if (filter.nodes.empty()) filter.nodes.push_back(&own);
  json packets{{"kinds", reader.among("kinds", {"data", "control", "interrupt"})},
               {"source", reader.nodes("source")},
               {"destination", reader.nodes("destination")},
               {"priority", reader.numbers("priority", 3)},
               {"channel", reader.numbers("channel", 63)},
               {"sample", reader.single("sample", 1, 1)},
               {"limit_per_s", reader.single("limit", kLimit, 0)}};
  if (auto at = reader.among("at", {"in", "out"}); !at.empty()) packets["at"] = at;
  filter.order = json{{"packets", packets}}.dump();
  return filter;
}

namespace {

void take_trailer(const wire::PacketFields& fields, Frame& frame) {
  frame.fbc = fields.fbc();
  frame.did = fields.destination();
  if (frame.kind == Frame::INTERRUPT) {
    frame.factor = fields.last();
    return;
  }
  frame.priority = wire::priority_of(fields.last());
  frame.channel = wire::channel_of(fields.last());
  if (frame.channel == static_cast<std::uint8_t>(wire::Channel::control)) frame.kind = Frame::CONTROL;
  const wire::ByteView data = fields.data();
  frame.payload.assign(data.begin(), data.end());
}

}  // namespace

Frame to_frame(const CapturedPacket& packet, const config::NodeConfig& node, const config::RingConfig& ring) {
  const CaptureInfo& info = packet.info;
  const wire::PacketFields fields{{packet.bytes.data(), packet.bytes.size()}};
  Frame frame;
  frame.header.stamp.fromNSec(static_cast<std::uint64_t>(packet.time_ns));
  frame.node = node.name;
  frame.line_from = ring.name_of(info.from);
  frame.line_to = ring.name_of(info.to);
  frame.direction = info.input ? Frame::IN : Frame::OUT;
  frame.retry = info.retry;
  frame.own = info.own;
  frame.embedded = info.embedded;
  frame.size = static_cast<std::uint16_t>(packet.bytes.size());
  frame.span = std::chrono::duration<double>(info.span).count();
  if (packet.bytes.size() < wire::kHeaderSize) return frame;
  frame.code = fields.code_byte();
  frame.kind = fields.code().interrupt ? Frame::INTERRUPT : Frame::DATA;
  frame.attempt = fields.code().attempt;
  frame.sequence = fields.code().sequence;
  frame.hop = fields.hop();
  frame.sid = fields.source();
  frame.whole = !info.aborted && !info.truncated && packet.bytes.size() >= wire::kOverhead;
  frame.crc_ok = frame.whole && !info.crc_bad;
  if (frame.whole)
    take_trailer(fields, frame);
  else
    frame.payload.assign(packet.bytes.begin() + wire::kHeaderSize, packet.bytes.end());
  return frame;
}

FrameNames::FrameNames() {
  const ros::NodeHandle own("~");
  std::string parameter;
  if (own.searchParam("tf_prefix", parameter)) own.getParam(parameter, prefix_);
  if (!prefix_.empty() && prefix_.front() == '/') prefix_.erase(0, 1);
}

}  // namespace limb_ring::bridge
