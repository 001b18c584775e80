#include "study/response.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "config/core_settings.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragment.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "wire/control_message.h"

namespace limb_ring::study {
namespace {

constexpr Duration kNoRoom = std::chrono::seconds(10);
constexpr auto kInterrupt = static_cast<unsigned>(wire::kOverhead);
constexpr auto kTail = static_cast<unsigned>(wire::kTrailerSize + wire::kCrcSize);

unsigned size_on_line(unsigned data) { return data + static_cast<unsigned>(wire::kOverhead); }

}  // namespace

Laps::Laps(const config::RingConfig& ring, const std::vector<Stream>& streams)
    : largest_(ring.nodes.size(), 0), smallest_(ring.nodes.size(), 0) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const config::LinkConfig& line = ring.nodes[(n + 1) % ring.nodes.size()].link;
    byte_time_.push_back(setup::byte_time(line));
    delay_.push_back(line.whole_delay());
  }
  for (const Stream& stream : streams)
    for (const unsigned packet : stream.packets) {
      const unsigned size = size_on_line(packet);
      unsigned &largest = largest_[stream.source], &smallest = smallest_[stream.source];
      smallest = smallest == 0 ? size : std::min(smallest, size);
      largest = std::max(largest, size);
      odd_ = std::max(odd_, packet % 4);
    }
}

template <class Visit>
void Laps::visit_lines(NodeId source, NodeId to, Visit visit) const {
  NodeId node = source;
  do {
    visit(node);
    node = next(node);
  } while (node != to);
}

bool Laps::narrows(NodeId node) const { return byte_time_[node] > byte_time_[previous(node)]; }

Duration Laps::slowest_line(unsigned bytes) const {
  return *std::max_element(byte_time_.begin(), byte_time_.end()) * static_cast<std::int64_t>(bytes);
}

Duration Laps::all_but(NodeId source, NodeId line) const {
  Duration sum{0};
  for (std::size_t n = 0; n < largest_.size(); ++n)
    if (n != source) sum += on_line(line, largest_[n]);
  return sum;
}

// An own packet takes time on the line out, but its return, which is not relayed, gives the same time back. So at most
// one own packet ever has to be waited for, unless the line out is slower than the line in.
Duration Laps::data_queue(NodeId source, NodeId node) const {
  if (narrows(node)) return all_but(source, node);
  return node == source ? Duration{0} : on_line(node, largest_[node]);
}

Duration Laps::interrupt_queue(NodeId source, NodeId node) const {
  if (narrows(node)) return on_line(node, kInterrupt) * static_cast<std::int64_t>(byte_time_.size() - 1);
  return node == source ? Duration{0} : on_line(node, kInterrupt);
}

Duration Laps::data(NodeId source, NodeId to, unsigned bytes) const {
  Duration on_slowest{0}, sum = interrupts_;
  visit_lines(source, to, [&](NodeId node) {
    on_slowest = std::max(on_slowest, on_line(node, size_on_line(bytes)));
    sum += delay_[node] + data_queue(source, node);
  });
  return on_slowest + sum;
}

Duration Laps::data_ahead(NodeId source) const {
  unsigned largest = 0;
  for (std::size_t n = 0; n < largest_.size(); ++n)
    if (n != source) largest = std::max(largest, largest_[n]);
  return slowest_line(largest) + interrupts_;
}

std::size_t Laps::waiting(NodeId node) const {
  std::size_t all = 0, largest = 0;
  for (std::size_t n = 0; n < largest_.size(); ++n) {
    if (n == node) continue;
    all += largest_[n];
    largest = std::max<std::size_t>(largest, largest_[n]);
  }
  if (narrows(node)) return all;
  const Duration own = on_line(node, largest_[node]) + interrupts_;
  const auto behind = static_cast<std::size_t>((own.count() + byte_time_[node].count() - 1) / byte_time_[node].count());
  return std::min(all, behind + 2 * largest);
}

Duration Laps::interrupt(NodeId source, NodeId to) const {
  Duration on_slowest{0}, sum{0};
  visit_lines(source, to, [&](NodeId node) {
    on_slowest = std::max(on_slowest, on_line(node, kInterrupt));
    sum += delay_[node] + on_line(node, kTail + odd_) + interrupt_queue(source, node);
  });
  return on_slowest + sum;
}

Duration Laps::interrupt_ahead() const { return slowest_line(kInterrupt); }

Duration Laps::least_interrupt() const {
  Duration sum{0};
  for (const Duration delay : delay_) sum += delay;
  return sum + slowest_line(kInterrupt);
}

Duration Laps::longest_data() const {
  Duration longest{0};
  for (std::size_t n = 0; n < largest_.size(); ++n) {
    const auto node = static_cast<NodeId>(n);
    if (largest_[n] != 0)
      longest = std::max(longest, data(node, node, largest_[n] - static_cast<unsigned>(wire::kOverhead)));
  }
  return longest;
}

bool Laps::set_interrupts(const std::vector<Interrupts>& interrupts) {
  interrupts_ = Duration{0};
  const Duration lap = longest_data();
  for (Duration before{-1}; interrupts_ != before && interrupts_ < kNoRoom;) {
    before = interrupts_;
    std::int64_t count = 0;
    for (const Interrupts& each : interrupts) count += (lap + before + each.under_way) / each.period + 1;
    interrupts_ = slowest_line(kInterrupt) * count;
  }
  return interrupts_ < kNoRoom;
}

namespace {

/// Messages asked for from 0 until `end`, those at the very end too.
std::int64_t arrivals(const Contender& other, Duration end) { return (end + other.jitter) / other.period + 1; }

/// One stream among those of its unit.
class Analysis {
 public:
  Analysis(const std::vector<Contender>& contenders, std::size_t which, Duration ahead, Duration limit)
      : all_(contenders), which_(which), own_(contenders[which]), limit_(limit) {
    for (const Contender& other : all_)
      if (other.rank > own_.rank) lower_ = std::max(lower_, other.longest);
    blocked_ = std::max(ahead, lower_);
  }

  std::optional<Response> worst() const {
    const auto busy = busy_period();
    if (!busy) return std::nullopt;
    Response worst;
    Duration wait = blocked_;
    for (std::int64_t q = 0; q < arrivals(own_, *busy); ++q) {
      wait = start(q, wait);
      if (wait > limit_) return std::nullopt;
      const Duration after = wait - std::max(Duration{0}, q * own_.period - own_.jitter);
      if (q == 0 || after > worst.wait) worst = described(q, wait, after);
    }
    return worst;
  }

 private:
  bool goes_first(std::size_t k) const { return k != which_ && all_[k].rank <= own_.rank; }

  /// The load that competes: 1 or more has no bound.
  double load() const {
    double load = own_.load();
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (goes_first(k)) load += all_[k].load();
    return load;
  }

  std::optional<Duration> busy_period() const {
    if (load() >= 1) return std::nullopt;
    Duration busy = blocked_ + own_.work;
    for (Duration before{-1}; busy != before;) {
      before = busy;
      busy = blocked_ + arrivals(own_, before) * own_.work;
      for (std::size_t k = 0; k < all_.size(); ++k)
        if (goes_first(k)) busy += arrivals(all_[k], before) * all_[k].work;
      if (busy > limit_) return std::nullopt;
    }
    return busy;
  }

  /// When the last packet of message q starts, from below. Stops above the limit.
  Duration start(std::int64_t q, Duration from) const {
    Duration wait = from;
    for (Duration before{-1}; wait != before && wait <= limit_;) {
      before = wait;
      wait = blocked_ + (q + 1) * own_.work - own_.last;
      for (std::size_t k = 0; k < all_.size(); ++k)
        if (goes_first(k)) wait += arrivals(all_[k], before) * all_[k].work;
    }
    return wait;
  }

  Response described(std::int64_t q, Duration wait, Duration after) const {
    Response response;
    response.wait = after;
    response.own = static_cast<std::size_t>(q + 1) * own_.jobs;
    response.lower = lower_.count() != 0;
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (goes_first(k)) response.others += static_cast<std::size_t>(arrivals(all_[k], wait)) * all_[k].jobs;
    return response;
  }

  const std::vector<Contender>& all_;
  const std::size_t which_;
  const Contender& own_;
  const Duration limit_;
  Duration lower_{0};
  Duration blocked_{0};
};

}  // namespace

std::optional<Response> worst_response(const std::vector<Contender>& contenders, std::size_t which, Duration ahead,
                                       Duration limit) {
  return Analysis(contenders, which, ahead, limit).worst();
}

namespace {

using config::NodeConfig;
using config::RingConfig;

static_assert(config::kLargestMessage == payload::kMaxMessage);

constexpr std::uint8_t kJointPriority = 0;  // of states in firmware, of commands in ring_bridge

Duration period_of(double rate) { return Duration{std::llround(1e12 / rate)}; }

NodeId place_of(const RingConfig& ring, std::uint8_t id) {
  return static_cast<NodeId>(setup::index_of(ring, *ring.find(id)));
}

unsigned state_bytes(const NodeConfig& node) {
  payload::JointState state;
  state.joints.resize(node.joints.size());
  return static_cast<unsigned>(payload::encode(state)->size());
}

unsigned command_bytes(const NodeConfig& node) {
  payload::JointCommand command;
  command.joints.resize(node.joints.size(), {0.0, 0.0, {}});
  return static_cast<unsigned>(payload::encode(command)->size());
}

unsigned reading_bytes() { return static_cast<unsigned>(payload::encode(payload::SensorReading{})->size()); }

std::vector<unsigned> fragments(unsigned bytes) {
  std::vector<unsigned> packets(payload::fragment_count(bytes), payload::kMaxPacket);
  const auto before = static_cast<unsigned>((packets.size() - 1) * payload::kFragmentBytes);
  packets.back() = static_cast<unsigned>(payload::kFragmentHeader) + bytes - before;
  return packets;
}

Stream message(std::string name, NodeId source, NodeId destination, std::uint8_t priority, unsigned bytes,
               double rate) {
  Stream stream;
  stream.name = std::move(name);
  stream.source = source;
  stream.destination = destination;
  stream.priority = priority;
  stream.bytes = bytes;
  stream.packets = {bytes};
  stream.period = period_of(rate);
  return stream;
}

/// As many parts in each packet as fit.
void add_command_sets(const RingConfig& ring, NodeId body, std::vector<Stream>& streams) {
  std::vector<unsigned> packets;
  for (const NodeConfig& node : ring.nodes) {
    if (node.joints.empty()) continue;
    payload::CommandSet::Part part{node.id, {}};
    part.joints.resize(node.joints.size(), {0.0, 0.0, {}});
    const auto bytes = static_cast<unsigned>(encoded_size(part));
    if (packets.empty() || packets.back() + bytes > payload::kMaxPacket) packets.push_back(payload::kCommandSetHeader);
    packets.back() += bytes;
  }
  if (packets.empty()) return;
  const unsigned all = std::accumulate(packets.begin(), packets.end(), 0u);
  streams.push_back(message("commands", body, wire::kBroadcast, kJointPriority, all, ring.bridge.rate));
  streams.back().packets = packets;
}

void add_joints(const RingConfig& ring, std::vector<Stream>& streams) {
  const NodeId body = place_of(ring, config::body_of(ring).id);
  for (const NodeConfig& node : ring.nodes)
    if (!node.joints.empty())
      streams.push_back(message("state of " + node.name, place_of(ring, node.id), body, kJointPriority,
                                state_bytes(node), ring.firmware.state_rate));
  if (ring.bridge.broadcast_commands) return add_command_sets(ring, body, streams);
  for (const NodeConfig& node : ring.nodes) {
    if (node.joints.empty()) continue;
    streams.push_back(message("command to " + node.name, body, place_of(ring, node.id), kJointPriority,
                              command_bytes(node), ring.bridge.rate));
    streams.back().phase = Duration{0};  // one joint_commands message makes them all at once
  }
}

void add_sensors(const RingConfig& ring, std::vector<Stream>& streams) {
  const NodeId body = place_of(ring, config::body_of(ring).id);
  for (const NodeConfig& node : ring.nodes)
    for (const config::SensorConfig& sensor : node.sensors) {
      const NodeId there = place_of(ring, node.id);
      streams.push_back(message(sensor.name, there, body, sensor.priority, reading_bytes(), sensor.rate));
      if (!sensor.topic.empty())
        streams.push_back(
            message("values for " + sensor.name, body, there, sensor.priority, reading_bytes(), sensor.rate));
    }
}

void add_topics(const RingConfig& ring, std::vector<Stream>& streams) {
  for (const config::TopicConfig& topic : ring.bridge.topics) {
    if (topic.size == 0) continue;
    streams.push_back(message(topic.input, place_of(ring, topic.from), place_of(ring, topic.to), topic.priority,
                              topic.size, topic.rate));
    streams.back().packets = fragments(topic.size);
    streams.back().deadline = core::Duration(topic.deadline);
  }
}

Stream traffic(const RingConfig& ring, const config::TrafficConfig& config) {
  const NodeId to = config.broadcast ? wire::kBroadcast : place_of(ring, config.to);
  Stream stream = message(config.name, place_of(ring, config.from), to, config.priority, config.size, config.rate);
  if (config.size > payload::kMaxPacket) stream.packets = fragments(config.size);
  if (config.interrupt) stream.packets.clear();
  stream.interrupt = config.interrupt;
  stream.jitter = config.jitter;
  stream.phase = config.phase;
  stream.deadline = core::Duration(config.deadline);
  return stream;
}

void add_beacons(const RingConfig& ring, std::vector<Stream>& streams) {
  const double rate = 1000.0 / static_cast<double>(ring.timeouts.beacon.count());
  for (const NodeConfig& node : ring.nodes) {
    streams.push_back(
        message("beacon of " + node.name, place_of(ring, node.id), wire::kBroadcast, 0, wire::kLongBeaconSize, rate));
    streams.back().beacon = true;
  }
}

}  // namespace

std::vector<Stream> streams_of(const RingConfig& ring) {
  std::vector<Stream> streams;
  add_joints(ring, streams);
  add_sensors(ring, streams);
  add_topics(ring, streams);
  for (const config::TrafficConfig& config : ring.traffic) streams.push_back(traffic(ring, config));
  add_beacons(ring, streams);
  return streams;
}

}  // namespace limb_ring::study
