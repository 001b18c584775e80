#include "config/address.h"
#include "config/check_ring.h"

namespace limb_ring::config {
namespace {

/// Loopback addresses are for trying out several hosts on one machine.
void check_reachable(const Entry& file, const RingConfig& ring) {
  const std::vector<Entry> items = file.find("hosts")->items("");
  for (std::size_t i = 1; i < ring.hosts.size(); ++i) {
    if (is_loopback(ring.hosts[i].address) == is_loopback(ring.hosts[0].address)) continue;
    const HostConfig& inside = is_loopback(ring.hosts[i].address) ? ring.hosts[i] : ring.hosts[0];
    items[i].find("address")->refuse(
        "'" + inside.address + "' of host '" + inside.name + "' is reached from that machine alone",
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
