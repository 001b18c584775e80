#include "config/sections.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostStreams = 1000;
constexpr TimeRange kPhases{0s, 60s, nanoseconds(1)};

void check_traffic(const Entry& entry, TrafficConfig& stream) {
  if ((stream.size != 0) == stream.interrupt.has_value())
    entry.refuse(stream.interrupt ? "size and interrupt are both given" : "neither size nor interrupt is given",
                 "one of them: a message or an interrupt");
  if (stream.interrupt && entry.find("priority"))
    entry.find("priority")->refuse("an interrupt has no priority", "priority beside size");
}

void read_target(const Entry& entry, TrafficConfig& stream) {
  stream.broadcast = entry.is_scalar() && entry.text("") == "all";
  if (!stream.broadcast) stream.to = read_node(entry, ", or all");
}

Option<TrafficConfig> size_option() {
  Option<TrafficConfig> size = integer_option("size", &TrafficConfig::size, {1, kLargestMessage},
                                              "Bytes of one message. Above 512 it travels as topic fragments.");
  size.fallback = "none";
  return size;
}

Option<TrafficConfig> interrupt_option() {
  constexpr IntegerRange kFactors{0, 7};
  return {"interrupt", "none", allowed(kFactors), "Instead of `size`: an interrupt packet with this factor.",
          [=](const Entry& entry, TrafficConfig& stream) {
            stream.interrupt = static_cast<std::uint8_t>(read_integer(entry, kFactors));
          }};
}

Option<TrafficConfig> frequency_option() {
  Option<TrafficConfig> rate =
      real_option("rate", &TrafficConfig::rate, {0.001, 100000, "Hz"}, "Messages or interrupts a second.");
  rate.fallback = kRequired;
  return rate;
}

Option<TrafficConfig> phase_option() {
  return {"phase", "by the seed", allowed(kPhases), "The first is asked for so long after the start.",
          [](const Entry& entry, TrafficConfig& stream) { stream.phase = read_time(entry, kPhases); }};
}

}  // namespace

Option<RingConfig> traffic_option() {
  return list_option("traffic", &RingConfig::traffic, traffic_section(), kMostStreams, check_traffic,
                     "Streams of which nothing else here tells, such as cameras: for `ring_sim plan` "
                     "alone, the daemons ignore it.");
}

const Section<TrafficConfig>& traffic_section() {
  static const Section<TrafficConfig> section{
      name_option("name", &TrafficConfig::name, is_part_name, kPartNameRule, kRequired,
                  "What people call it; each name once."),
      node_option("from", &TrafficConfig::from, "The node that sends it."),
      {"to", kRequired, "id or name of a node, or all", "Its destination.", read_target},
      size_option(),
      interrupt_option(),
      frequency_option(),
      integer_option("priority", &TrafficConfig::priority, {0, 3},
                     "Of its packets; 0 is the highest. Not for an interrupt."),
      deadline_option<TrafficConfig>(),
      time_option("jitter", &TrafficConfig::jitter, 0s, 10s, "It is asked for up to so much later than its rate says."),
      phase_option(),
  };
  return section;
}

}  // namespace limb_ring::config
