#include <set>

#include "config/sections.h"

namespace limb_ring::config {
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
        item.find("name")->refuse_value("is another host's name", "each name once");
      if (!addresses.insert(host.address).second)
        item.find("address")->refuse_value("is another host's address", "each address once");
      ring.hosts.push_back(std::move(host));
    });
  problems.refuse_all();
  entry.document().hosts_unsure = false;
}

}  // namespace

Option<RingConfig> hosts_option() {
  return {"hosts", "[]", std::string(kAllowedHosts) + ", see below",
          "The machines that run the nodes. Lines within a host are local, those between hosts go by UDP.", read_hosts};
}

const Section<HostConfig>& host_section() {
  static const Section<HostConfig> section{
      name_option("name", &HostConfig::name, is_host_name, kHostNameRule, kRequired,
                  "What people call the machine; its own."),
      {"address", kRequired, "an IPv4 or IPv6 address in numbers",
       "Its nodes listen there for lines from other hosts. Each host has its own.",
       [](const Entry& entry, HostConfig& host) { host.address = read_address(entry); }},
      name_option("ssh", &HostConfig::ssh, is_ssh_destination, kSshRule, "the address",
                  "Where `ringctl --ssh` goes for this host."),
  };
  return section;
}

std::size_t read_host(const Entry& entry) {
  const auto& hosts = entry.document().hosts;
  std::vector<std::string> names;
  for (const auto& [name, place] : hosts) names.push_back(name);
  const std::string rule =
      names.empty() ? "no host where the file has no `hosts`" : "a host of this ring (" + join(names) + ')';
  const std::string text = entry.text(rule);
  const auto found = hosts.find(text);
  if (found != hosts.end()) return found->second;
  if (entry.document().hosts_unsure) throw ConfigError("");
  const std::string meant = closest(text, names);
  entry.refuse_value(meant.empty() ? "is no host of it" : "is no host of it, did you mean '" + meant + "'?", rule);
}

}  // namespace limb_ring::config
