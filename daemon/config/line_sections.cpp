#include <set>

#include "config/ring_sections.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;

Option<LinkConfig> port_option(std::int64_t most, const char* fallback, const char* meaning) {
  Option<LinkConfig> option = integer_option("port", &LinkConfig::port, {1024, most}, meaning);
  option.fallback = fallback;
  return option;
}

Option<LinkConfig> address_option() {
  return {"address", LinkConfig{}.address, "an IPv4 or IPv6 address in numbers",
          "udp: the node listens only at this address.",
          [](const Entry& entry, LinkConfig& link) { link.address = read_address(entry); }};
}

Section<LinkConfig> section_with(const Option<LinkConfig>& port) {
  return {
      choice_option("transport", &LinkConfig::transport, transport_words(),
                    "Shared memory, UNIX stream sockets, or UDP. Lines between different `hosts` are always UDP."),
      address_option(),
      port,
      rate_option("rate", &LinkConfig::rate, "Data rate of the line. unlimited: as fast as the host can."),
      time_option("delay", &LinkConfig::delay, 0s, 1s, "Emulated delay of line and relay together."),
      section_option("expected", &LinkConfig::expected, expected_section(),
                     "What the real network between hosts is expected to do. A live ring does not emulate it."),
  };
}

Option<LinkConfig> key_option() {
  constexpr const char* kRule =
      "a file that 'ringctl hosts key FILE' makes; its path is absolute, or from the folder of this file";
  return {"key", "none", kRule,
          "udp: the key of all UDP lines. All hosts need the same file, with mode 0600. Packets without the key are "
          "ignored.",
          [=](const Entry& entry, LinkConfig& link) {
            link.key = entry.text(kRule);
            if (link.key.empty()) entry.refuse_value("is not a file", kRule);
          }};
}

/// Only for the whole ring: a line between a node with a key and one without would not get together.
Section<LinkConfig> with_key(Section<LinkConfig> section) {
  section.push_back(key_option());
  section.push_back(
      flag_option("insecure", &LinkConfig::insecure,
                  "Allow udp beyond this host without a `key`. Anyone on that network may then command the "
                  "robot."));
  return section;
}

Section<LinkConfig> with_fallback_to_links(Section<LinkConfig> section) {
  for (Option<LinkConfig>& option : section)
    if (option.name != "port") option.fallback = "as in `links`";
  return section;
}

}  // namespace

const Section<LinkConfig>& links_section() {
  static const Section<LinkConfig> section = with_key(section_with(port_option(
      65535 - 254, "computed from the ring's name, 17000 to 32104",
      "udp: the port of id 0; each node listens at this port + its id. Each ring on a host needs ports of its own.")));
  return section;
}

const Section<ExpectedConfig>& expected_section() {
  static const Section<ExpectedConfig> section{
      time_option("delay", &ExpectedConfig::delay, 0s, 200ms, "Delay in one direction."),
      real_option("loss", &ExpectedConfig::loss, {0, 0.5, "(a probability)"}, "Probability that a datagram is lost."),
  };
  return section;
}

const Section<LinkConfig>& link_section() {
  static const Section<LinkConfig> section = with_fallback_to_links(
      section_with(port_option(65535, "`links.port` + id", "udp: the node listens at this port.")));
  return section;
}

namespace {

const char* const kAllowedHosts = "a list of 1 to 255 maps";
const char* const kSshRule = "a destination as ssh takes it, USER@HOST or HOST, 255 characters at most";

/// It becomes an argument of ssh, which would take one with a '-' for an option.
bool is_ssh_destination(const std::string& text) {
  return !text.empty() && text.size() <= 255 && text[0] != '-' &&
         text.find_first_of(" \t\n\"'`$\\;&|<>") == std::string::npos;
}

void read_hosts(const Entry& entry, RingConfig& ring) {
  entry.document().hosts_unsure = true;
  const std::vector<Entry> items = entry.items(kAllowedHosts, kMostNodes);
  if (items.empty()) entry.refuse("a list of 0 is too short", kAllowedHosts);
  std::set<std::string> addresses;
  Problems problems;
  for (const Entry& item : items)
    problems.gather([&] {
      HostConfig host;
      read_section(item, host_section(), host);
      if (!item.document().hosts.emplace(host.name, ring.hosts.size()).second)
        item.find("name")->refuse_value("is the name of another host", "each name once");
      if (!addresses.insert(host.address).second)
        item.find("address")->refuse_value("is the address of another host", "each address once");
      ring.hosts.push_back(std::move(host));
    });
  problems.refuse_all();
  entry.document().hosts_unsure = false;
}

}  // namespace

Option<RingConfig> hosts_option() {
  return {"hosts", "[]", std::string(kAllowedHosts) + ", see below",
          "The machines that run the nodes. Lines between hosts go by UDP.", read_hosts};
}

const Section<HostConfig>& host_section() {
  static const Section<HostConfig> section{
      name_option("name", &HostConfig::name, is_host_name, kHostNameRule, kRequired,
                  "Name of the machine. Each host has its own."),
      {"address", kRequired, "an IPv4 or IPv6 address in numbers",
       "The nodes of this host listen here for lines from other hosts. Each host has its own address.",
       [](const Entry& entry, HostConfig& host) { host.address = read_address(entry); }},
      name_option("ssh", &HostConfig::ssh, is_ssh_destination, kSshRule, "the address",
                  "The destination that `ringctl --ssh` uses for this host."),
  };
  return section;
}

std::size_t read_host(const Entry& entry) {
  const auto& hosts = entry.document().hosts;
  std::vector<std::string> names;
  for (const auto& [name, place] : hosts) names.push_back(name);
  const std::string rule =
      names.empty() ? "no `host`, because the file has no `hosts`" : "a host of this ring (" + join(names) + ')';
  const std::string text = entry.text(rule);
  const auto found = hosts.find(text);
  if (found != hosts.end()) return found->second;
  if (entry.document().hosts_unsure) throw ConfigError("");
  const std::string meant = closest(text, names);
  entry.refuse_value(
      meant.empty() ? "is not a host of this ring" : "is not a host of this ring, did you mean '" + meant + "'?", rule);
}

namespace {

constexpr IntegerRange kInsertionBuffer{2, 1024};

}  // namespace

const Section<Limits>& limits_section() {
  static const Section<Limits> section{
      {"insertion_buffer", "8, or the number of nodes if that is more and a line has a rate", allowed(kInsertionBuffer),
       "How many DATPs of 524 bytes may wait to be relayed. Any more are dropped and counted. On a line with a rate, "
       "one packet from each other node may have to wait.",
       [](const Entry& entry, Limits& limits) {
         limits.insertion_buffer = static_cast<unsigned>(read_integer(entry, kInsertionBuffer));
       }},
      integer_option("interrupt_buffer", &Limits::interrupt_buffer, {2, 4096},
                     "How many INTPs may wait to be relayed. Any more are dropped and counted."),
      integer_option("send_queue", &Limits::send_queue, {1, 65536},
                     "How many sends may wait in a node, per priority. Any more are rejected."),
      integer_option("receive_buffers", &Limits::receive_buffers, kReceiveBuffers,
                     "How many packets may wait for a CPU, per priority. Any more are refused."),
      integer_option(
          "clients", &Limits::clients, {1, 1024},
          "How many programs may be connected to one host port at a time. The CPU, and tools that only ask (ringctl "
          "stop), do not count. If all places are taken, a program that has asked for nothing for 2 s makes room."),
  };
  return section;
}

const Section<Timeouts>& timeouts_section() {
  static const Section<Timeouts> section{
      time_option("send", &Timeouts::send, 1ms, 60s,
                  "Shortest time-out of one try, from its first byte. Then the packet is sent again."),
      time_option("refused", &Timeouts::refused, 0ms, 60s,
                  "How long a unicast that a full receiver has refused is retried."),
      time_option("refused_backoff", &Timeouts::refused_backoff, 1ms, 10s,
                  "Longest wait between these retries. The wait starts at 1ms and doubles."),
      time_option(
          "queue", &Timeouts::queue, 1ms, 600s,
          "How long a send may wait to go out. After that it ends as rejected, and a retry as lost or refused."),
      time_option("stall", &Timeouts::stall, 1ms, 60s,
                  "How long the next part of a packet may take to arrive. After that the packet is aborted."),
      time_option("idle", &Timeouts::idle, 1ms, 10s,
                  "Period of the signs of life on a quiet link. At most half of `silence`."),
      time_option("silence", &Timeouts::silence, 2ms, 60s, "A link that was silent for this time counts as broken."),
      time_option("first_successor", &Timeouts::first_successor, 0ms, 60s,
                  "How long a starting node waits for its configured neighbour before bypassing it."),
      time_option("break_grace", &Timeouts::break_grace, 0ms, 60s,
                  "A lost input counts as a broken line if no bypass has closed the gap after this time."),
      time_option(
          "fold_permission", &Timeouts::fold_permission, 0ms, 60s,
          "foldback: a node does not fold during this time after its start, unless both its lines have been up."),
      time_option("beacon", &Timeouts::beacon, 10ms, 60s, "Period at which each node tells all others its state."),
      time_option("cpu_boot", &Timeouts::cpu_boot, 10ms, 600s,
                  "A CPU that has not connected this long after its start counts as failed."),
      time_option("command", &Timeouts::command, 1ms, 60s,
                  "A joint that gets no new command for this time goes to its safe state."),
  };
  return section;
}

const Section<Firmware>& firmware_section() {
  static const Section<Firmware> section{
      real_option(
          "state_rate", &Firmware::state_rate, {1, 1000, "Hz"},
          "How often a node sends the state of its joints. On a live ring, limb_firmware handles a command that "
          "comes less than 1 ms before a sample together with that sample."),
      real_option("bandwidth", &Firmware::bandwidth, {0.1, 100, "Hz"}, "Natural frequency of the simulated servo."),
      real_option("damping", &Firmware::damping, {0.05, 5, "(a ratio)"},
                  "Damping ratio of the simulated servo; 1 is critical."),
  };
  return section;
}

namespace {

constexpr const char* kCores = "auto, or a list of CPU cores, such as [0] or [2, 3]";

void read_cores(const Entry& entry, Realtime& realtime) {
  realtime.cores.clear();
  realtime.auto_cores = entry.is_scalar();
  if (realtime.auto_cores && entry.text(kCores) != "auto") entry.refuse_value("is unknown", kCores);
  if (realtime.auto_cores) return;
  for (const Entry& item : entry.items(kCores, 1024))
    realtime.cores.push_back(static_cast<unsigned>(read_integer(item, {0, 1023})));
}

}  // namespace

const Section<Realtime>& realtime_section() {
  static const Section<Realtime> section{
      {"cores", "[]", "auto, or a list of CPU cores, each 0 to 1023",
       "The cores that the daemons run on. One idle core for all of them is fastest for a single packet. auto: one "
       "core for each daemon, neighbours together; this is fastest under load. Empty: any core; with --clock "
       "virtual, the ring and its CPUs share the core they start on.",
       read_cores},
      integer_option("fifo", &Realtime::fifo, {0, 99}, "SCHED_FIFO priority of the daemons. 0: off."),
      flag_option("lock_memory", &Realtime::lock_memory, "Keep the daemons' memory from being paged out (mlockall)."),
      time_option("spin", &Realtime::spin, 0s, 10ms,
                  "How long a daemon polls for packets before it sleeps. Use it only with a core of its own."),
  };
  return section;
}

namespace {

constexpr std::size_t kMostStreams = 1000;
constexpr TimeRange kPhases{0s, 60s, nanoseconds(1)};

void check_traffic(const Entry& entry, TrafficConfig& stream) {
  if ((stream.size != 0) == stream.interrupt.has_value())
    entry.refuse(stream.interrupt ? "size and interrupt are both given" : "neither size nor interrupt is given",
                 "one of them: a message or an interrupt");
  if (stream.interrupt && entry.find("priority"))
    entry.find("priority")->refuse("an interrupt has no priority", "no priority, or size instead of interrupt");
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
  return {"phase", "by the seed", allowed(kPhases), "Time of the first one, from the start.",
          [](const Entry& entry, TrafficConfig& stream) { stream.phase = read_time(entry, kPhases); }};
}

}  // namespace

Option<RingConfig> traffic_option() {
  return list_option("traffic", &RingConfig::traffic, traffic_section(), kMostStreams, check_traffic,
                     "Streams that no other entry describes, such as cameras. Only `ring_sim plan` reads "
                     "them; the daemons ignore them.");
}

const Section<TrafficConfig>& traffic_section() {
  static const Section<TrafficConfig> section{
      name_option("name", &TrafficConfig::name, is_part_name, kPartNameRule, kRequired,
                  "Name of the stream. Each name once."),
      node_option("from", &TrafficConfig::from, "The node that sends it."),
      {"to", kRequired, "id or name of a node, or all", "Its destination.", read_target},
      size_option(),
      interrupt_option(),
      frequency_option(),
      integer_option("priority", &TrafficConfig::priority, {0, 3},
                     "Priority of its packets; 0 is the highest. Not for interrupts."),
      deadline_option<TrafficConfig>(),
      time_option("jitter", &TrafficConfig::jitter, 0s, 10s,
                  "Each message starts up to this much later than its rate says."),
      phase_option(),
  };
  return section;
}

}  // namespace limb_ring::config
