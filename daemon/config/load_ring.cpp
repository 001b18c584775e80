#include "config/load_ring.h"

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "config/entry.h"
#include "config/quantity.h"
#include "config/ring_sections.h"
#include "config/urdf_limits.h"

namespace limb_ring::config {
namespace {

void default_outputs(std::vector<TopicConfig>& topics) {
  for (TopicConfig& topic : topics)
    if (topic.output.empty()) topic.output = topic.input;
}

/// The key's file, beside the ring's.
void find_key(RingConfig& ring) {
  if (ring.links.key.empty()) return;
  const auto folder = std::filesystem::absolute(ring.path).parent_path();
  ring.links.key = (folder / ring.links.key).lexically_normal();  // an absolute one stays as it is
  for (NodeConfig& node : ring.nodes) node.link.key = ring.links.key;
}

/// A line within a host crosses no network.
void expect_of_networks_alone(RingConfig& ring) {
  for (std::size_t n = 0; n < ring.nodes.size() && !ring.hosts.empty(); ++n) {
    const NodeConfig& from = ring.nodes[(n + ring.nodes.size() - 1) % ring.nodes.size()];
    if (from.host == ring.nodes[n].host) ring.nodes[n].link.expected = {};
  }
}

/// A scenario, taken for the file of a ring.
void refuse_scenario(const Entry& file) {
  if (!file.is_map()) return;
  for (const char* name : {"scenario", "steps", "always", "never"})
    if (const auto entry = file.find(name))
      entry->refuse("this is a scenario, not the file of a ring", "'ringctl scenario run FILE' for a scenario");
}

}  // namespace

RingConfig parse_ring(const std::string& text, const std::string& name) {
  Document document;
  document.name = name;
  const Entry file(parse_yaml(text, name), "", document);
  RingConfig ring;
  ring.path = name;
  refuse_scenario(file);
  read_section(file, ring_section(), ring);
  default_outputs(ring.bridge.topics);
  find_key(ring);
  expect_of_networks_alone(ring);
  check_ring(file, ring);
  take_followers(document.urdf, ring);
  ring.warnings = urdf_warnings(document);
  ring.files = std::move(document.files);
  ring.files.push_back({name, text});
  return ring;
}

RingConfig load_ring(const std::string& path) { return parse_ring(read_file(path), path); }

namespace {

/// Element `index` of the list `name`, which is known to be there.
Entry element(const Entry& map, const char* name, std::size_t index) { return map.find(name)->items("").at(index); }

void check_idle(const Entry& file, const Timeouts& timeouts, Problems& problems) {
  if (timeouts.idle * 2 <= timeouts.silence) return;
  const Entry section = *file.find("timeouts");
  const auto idle = section.find("idle");
  (idle ? *idle : *section.find("silence"))
      .note(problems,
            "idle " + format_time(timeouts.idle) + " is too long for silence " + format_time(timeouts.silence),
            "an idle of at most half of silence");
}

/// A node without a CPU throws away what it is sent, and nobody would say anything of its joints and sensors.
void check_parts_have_cpu(const Entry& file, const RingConfig& ring, Problems& problems) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const NodeConfig& node = ring.nodes[n];
    if (node.cpu.kind != CpuConfig::Kind::none) continue;
    const auto refuse = [&](const char* list, const std::string& part) {
      element(element(file, "nodes", n), list, 0)
          .note(problems, part + " needs a CPU: node '" + node.name + "' has cpu: none",
                "a cpu for this node: {command: [limb_firmware]}, or attached");
    };
    if (!node.joints.empty()) refuse("joints", "joint '" + node.joints[0].name + "'");
    if (!node.sensors.empty()) refuse("sensors", "sensor '" + node.sensors[0].name + "'");
  }
}

/// The bridge, which hears the topic, is the CPU of the body itself.
void check_sensor_topics(const Entry& file, const RingConfig& ring, Problems& problems) {
  const NodeConfig& body = body_of(ring);
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    for (std::size_t i = 0; i < ring.nodes[n].sensors.size() && ring.nodes[n].id == body.id; ++i)
      if (!body.sensors[i].topic.empty())
        element(element(file, "nodes", n), "sensors", i)
            .find("topic")
            ->note(problems, "node '" + body.name + "' is the body, whose CPU hands out the values of topics",
                   "a topic for sensors of other nodes");
}

/// For unix links too: the command line can make them udp.
void check_ports(const Entry& file, const RingConfig& ring, Problems& problems) {
  std::map<std::pair<std::string, unsigned>, std::string> taken;
  const bool folds = ring.folds_back();
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const LinkConfig& link = ring.nodes[n].link;
    const auto take = [&](unsigned port) {
      const auto [other, free] = taken.emplace(std::make_pair(link.address, port), ring.nodes[n].name);
      if (free && port <= 65535) return;
      element(file, "nodes", n)
          .note(problems,
                "its link listens at " + link.address + " port " + std::to_string(port) +
                    (free ? "" : ", as does node '" + other->second + "'"),
                free ? "a port of at most 65279: the second line is at port + 256" : "a port of its own");
    };
    take(link.port);
    if (folds) take(link.port + 256u);
  }
}

/// Who stops all sends one broadcast, of the pin that stops it: that has to stop the others too, and must reset nobody.
/// The same holds for latching all clocks.
void check_common_pin(const Entry& file, const RingConfig& ring, PinConfig::Action action, const std::string& what,
                      Problems& problems) {
  const NodeConfig* first = nullptr;
  for (const NodeConfig& node : ring.nodes)
    if (first == nullptr && first_pin(node, action)) first = &node;
  if (first == nullptr) return;
  const std::uint8_t common = *first_pin(*first, action);
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const NodeConfig& node = ring.nodes[n];
    const auto own = first_pin(node, action);
    const bool resets = node.pins[common].action == PinConfig::Action::reset;
    if (own ? *own == common : !resets) continue;
    const std::string pin = "pin " + std::to_string(common);
    element(file, "nodes", n)
        .note(problems,
              (own ? "its first pin wired to " + what + " is " + std::to_string(*own)
                   : "its " + pin + " is wired to reset") +
                  ", and " + pin + " is node '" + first->name + "'s for " + what + ": a broadcast to all would not " +
                  what + " it",
              pin + " wired to " + what + " at every node that has such a pin, and to reset at none");
  }
}

/// A library stands for the network controller of a node, which has no second line.
void check_libraries(const Entry& file, const RingConfig& ring, Problems& problems) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    if (ring.nodes[n].library.empty()) continue;
    const Entry node = element(file, "nodes", n);
    if (ring.nodes[n].controller != NodeConfig::Controller::foreign)
      node.note(problems, "its library would not be used: its controller is ringd", "controller: foreign beside it");
    else if (ring.folds_back())
      node.note(problems, "its library has one line, and this ring folds back", "redundancy: none");
  }
}

/// Through shared memory a foreign node cannot be expected to speak. (protocol.md section 6.12)
void check_foreign(const Entry& file, const RingConfig& ring, Problems& problems) {
  const std::size_t count = ring.nodes.size();
  for (std::size_t n = 0; n < count; ++n) {
    if (ring.nodes[n].controller != NodeConfig::Controller::foreign) continue;
    for (const std::size_t into : {n, (n + 1) % count}) {
      if (ring.nodes[into].link.transport != LinkConfig::Transport::shm) continue;
      element(file, "nodes", n)
          .note(problems, "its controller is foreign, and the link into node '" + ring.nodes[into].name + "' is shm",
                "links beside it that are udp or unix: links: {transport: udp}");
      break;
    }
  }
}

void check_inputs(const Entry& file, const RingConfig& ring, Problems& problems) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    for (std::size_t i = 0; i < ring.nodes[n].inputs.size(); ++i) {
      const auto& input = ring.nodes[n].inputs[i];
      if (!input || !input->broadcast || !ring_has_reset_on(ring, input->factor)) continue;
      element(file, "nodes", n)
          .find("inputs")
          ->find(std::to_string(i))
          ->note(problems, "to all with factor " + std::to_string(input->factor) + " would reset CPUs",
                 "one node, or a factor that no node has wired to reset");
    }
}

void check_bridge_at(const Entry& topic, const RingConfig& ring, const char* end, std::uint8_t id, Problems& problems) {
  const NodeConfig& node = *ring.find(id);
  if (node.cpu.kind == CpuConfig::Kind::none)
    topic.find(end)->note(problems, "node '" + node.name + "' has cpu: none, so no bridge",
                          "a node with cpu: attached, or a command");
}

void check_topics(const Entry& file, const RingConfig& ring, Problems& problems) {
  std::set<std::pair<unsigned, std::string>> outputs;
  for (std::size_t t = 0; t < ring.bridge.topics.size(); ++t) {
    const TopicConfig& topic = ring.bridge.topics[t];
    const Entry entry = element(*file.find("bridge"), "topics", t);
    check_bridge_at(entry, ring, "from", topic.from, problems);
    check_bridge_at(entry, ring, "to", topic.to, problems);
    if (!outputs.emplace(topic.to, topic.output).second)
      entry.note(problems, "output '" + topic.output + "' is another topic's at the same node",
                 "each output once at a node");
  }
}

/// An interrupt that pulls nothing ends "refused"; a broadcast, if one node has nothing to pull.
void check_traffic_pin(const Entry& entry, const RingConfig& ring, const TrafficConfig& stream, Problems& problems) {
  for (const NodeConfig& node : ring.nodes) {
    const bool addressed = stream.broadcast ? node.id != stream.from : node.id == stream.to;
    if (addressed && node.pins[*stream.interrupt].action == PinConfig::Action::none)
      entry.note(problems,
                 "pin " + std::to_string(*stream.interrupt) + " of node '" + node.name + "' is wired to nothing",
                 "a factor that is wired at every destination");
  }
}

void check_traffic(const Entry& file, const RingConfig& ring, Problems& problems) {
  std::set<std::string> names;
  for (std::size_t t = 0; t < ring.traffic.size(); ++t) {
    const TrafficConfig& stream = ring.traffic[t];
    const Entry entry = element(file, "traffic", t);
    if (!names.insert(stream.name).second)
      entry.note(problems, "'" + stream.name + "' is the name of another one", "each name once");
    if (stream.interrupt) check_traffic_pin(*entry.find("interrupt"), ring, stream, problems);
  }
}

/// The cure is an INTP to a reset pin. Without such a pin, ordering it would only use up the tries.
void check_supervisor(const Entry& file, const RingConfig& ring, Problems& problems) {
  if (ring.supervisor.policy != SupervisorConfig::Policy::automatic) return;
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    if (ring.nodes[n].cpu.alive_period.count() != 0 && !first_pin(ring.nodes[n], PinConfig::Action::reset))
      element(file, "nodes", n)
          .note(problems, "its cpu has an alive_period, but no pin of it is wired to reset",
                "a pin wired to reset, or a supervisor with policy report or off");
}

std::string beyond_this_host(const NodeConfig& node) {
  return "the line into node '" + node.name + "' comes by UDP to " + node.link.address +
         ", beyond this host, and has no key";
}

/// Whoever can send a datagram there could otherwise command the joints.
void check_keys(const Entry& file, const RingConfig& ring, Problems& problems) {
  if (!ring.links.key.empty() && ring.links.insecure)
    file.find("links")->find("insecure")->note(problems, "is true, and a key is given", "one of the two");
  if (!ring.links.key.empty() || ring.links.insecure) return;
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    if (hears_other_hosts(ring, ring.nodes[n]))
      return element(file, "nodes", n).note(problems, beyond_this_host(ring.nodes[n]), kKeyOrInsecure);
}

/// Connect, accept and the first signs of life have to get through before an end counts as gone.
void check_expected(const Entry& file, const RingConfig& ring, Problems& problems) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const nanoseconds delay = ring.nodes[n].link.whole_delay();
    const nanoseconds least = 2 * delay + 2 * ring.timeouts.idle;
    if (delay.count() == 0 || ring.timeouts.silence >= least) continue;
    element(file, "nodes", n)
        .note(problems,
              "the line into it takes " + format_time(delay) + " one way, and timeouts.silence is only " +
                  format_time(ring.timeouts.silence) + ": its ends would give each other up",
              "a timeouts.silence of at least " + format_time(least) + ": twice the delay and twice timeouts.idle");
  }
}

}  // namespace

const char* const kKeyOrInsecure =
    "links: {key: FILE}, where 'ringctl hosts key FILE' makes the file and all hosts have it; or links: {insecure: "
    "true}, if anyone on that network may command the robot";

std::string unkeyed_line(const RingConfig& ring) {
  if (!ring.links.key.empty() || ring.links.insecure) return {};
  for (const NodeConfig& node : ring.nodes)
    if (hears_other_hosts(ring, node)) return beyond_this_host(node);
  return {};
}

void check_ring(const Entry& file, const RingConfig& ring) {
  Problems problems;
  check_idle(file, ring.timeouts, problems);
  check_parts_have_cpu(file, ring, problems);
  check_sensor_topics(file, ring, problems);
  problems.gather([&] { check_hosts(file, ring); });
  check_keys(file, ring, problems);
  check_expected(file, ring, problems);
  check_ports(file, ring, problems);
  check_common_pin(file, ring, PinConfig::Action::stop, "stop", problems);
  check_common_pin(file, ring, PinConfig::Action::sync, "sync", problems);
  check_foreign(file, ring, problems);
  check_libraries(file, ring, problems);
  check_inputs(file, ring, problems);
  check_supervisor(file, ring, problems);
  check_topics(file, ring, problems);
  check_traffic(file, ring, problems);
  problems.refuse_all();
}

namespace {

/// Loopback addresses are for trying out several hosts on one machine.
void check_reachable(const Entry& file, const RingConfig& ring) {
  const std::vector<Entry> items = file.find("hosts")->items("");
  for (std::size_t i = 1; i < ring.hosts.size(); ++i) {
    if (is_loopback(ring.hosts[i].address) == is_loopback(ring.hosts[0].address)) continue;
    const HostConfig& inside = is_loopback(ring.hosts[i].address) ? ring.hosts[i] : ring.hosts[0];
    items[i].find("address")->refuse(
        "'" + inside.address + "' of host '" + inside.name + "' can be reached only from that machine",
        "loopback addresses for all hosts (to try it out on one machine) or for none");
  }
}

/// One address for all nodes contradicts several hosts.
void check_common_address(const Entry& file) {
  const auto links = file.find("links");
  const auto address = links ? links->find("address") : std::nullopt;
  if (address)
    address->refuse_value("would be the address of all hosts",
                          "no address in `links`: each node listens at its host's");
}

/// @pre the node has a link of its own in the file
void check_own_transport(const Entry& link, const RingConfig& ring, std::size_t n) {
  const NodeConfig& node = ring.nodes[n];
  const NodeConfig& upstream = ring.nodes[(n + ring.nodes.size() - 1) % ring.nodes.size()];
  const auto transport = link.find("transport");
  if (!transport || upstream.host == node.host || node.link.transport == LinkConfig::Transport::udp) return;
  transport->refuse_value("stays within a host, but the line into this node comes from node '" + upstream.name +
                              "' at host '" + ring.host_of(upstream)->name + "'",
                          "udp, or no transport: lines between hosts are UDP by themselves");
}

/// A second network interface is fine; the address of another host is not.
void check_own_address(const Entry& link, const RingConfig& ring, const NodeConfig& node) {
  const auto address = link.find("address");
  if (!address) return;
  for (const HostConfig& host : ring.hosts)
    if (host.address == node.link.address && &host != ring.host_of(node))
      address->refuse_value(
          "is the address of host '" + host.name + "', and this node is at host '" + ring.host_of(node)->name + "'",
          "another address of host '" + ring.host_of(node)->name + "', or none: then " + ring.host_of(node)->address);
}

}  // namespace

void check_hosts(const Entry& file, const RingConfig& ring) {
  if (ring.hosts.empty()) return;
  check_reachable(file, ring);
  check_common_address(file);
  const std::vector<Entry> nodes = file.find("nodes")->items("");
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto link = nodes[n].find("link");
    if (!link) continue;
    check_own_transport(*link, ring, n);
    check_own_address(*link, ring, ring.nodes[n]);
  }
}

}  // namespace limb_ring::config
