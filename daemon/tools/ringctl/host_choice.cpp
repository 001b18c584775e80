#include "tools/ringctl/host_choice.h"

#include <algorithm>

#include "config/names.h"
#include "ring/own_address.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {
namespace {

using config::HostConfig;
using config::RingConfig;

const std::string kAllHere = "'--host all' runs all nodes on this machine, to try the file out";

std::string file_of(const RingConfig& ring) { return ring.path.empty() ? "the ring" : ring.path; }

std::string with_addresses(const RingConfig& ring) {
  std::vector<std::string> hosts;
  for (const HostConfig& host : ring.hosts) hosts.push_back(host.name + " " + host.address);
  return config::join(hosts);
}

UsageError unknown_host(const RingConfig& ring, const std::string& given) {
  std::vector<std::string> names;
  for (const HostConfig& host : ring.hosts) names.push_back(host.name);
  const std::string meant = config::closest(given, names);
  return UsageError("unknown host '" + given + "'" + (meant.empty() ? ". " : ", did you mean '" + meant + "'? ") +
                    file_of(ring) + " has: " + config::join(names));
}

std::string the_only_own(const RingConfig& ring) {
  std::vector<std::string> own;
  for (const HostConfig& host : ring.hosts)
    if (has_nodes(ring, host) && live::is_own_address(host.address)) own.push_back(host.name);
  if (own.size() == 1) return own.front();
  if (own.empty())
    throw UsageError("no host of " + file_of(ring) + " has an address of this machine (" + with_addresses(ring) +
                     "); " + kAllHere);
  throw UsageError("several hosts of " + file_of(ring) + " have an address of this machine (" + config::join(own) +
                   "): say with --host NAME which one it is; " + kAllHere);
}

}  // namespace

bool has_nodes(const RingConfig& ring, const HostConfig& host) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(),
                     [&](const config::NodeConfig& node) { return ring.host_of(node) == &host; });
}

std::string not_here(const HostConfig& host) {
  return "host '" + host.name + "' has the address " + host.address + ", which no interface of this machine has";
}

std::string chosen_host(const RingConfig& ring, const std::string& given) {
  if (given == kAllHosts) return ring.hosts.empty() ? "" : given;
  if (ring.hosts.empty()) {
    if (given.empty()) return given;
    throw UsageError("--host: " + file_of(ring) + " has no `hosts`; leave --host out");
  }
  if (given.empty()) return the_only_own(ring);
  const HostConfig* host = ring.find_host(given);
  if (host == nullptr) throw unknown_host(ring, given);
  if (!has_nodes(ring, *host))
    throw UsageError("host '" + given + "' has no nodes: no node of " + file_of(ring) + " names it");
  if (!live::is_own_address(host->address))
    throw Elsewhere(not_here(*host) + "; start it there, or correct `hosts`", host->ssh_destination());
  return given;
}

}  // namespace limb_ring::ringctl
