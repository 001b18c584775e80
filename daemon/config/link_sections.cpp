#include "config/sections.h"

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
          "udp: the node listens at this address, and only there.",
          [](const Entry& entry, LinkConfig& link) { link.address = read_address(entry); }};
}

Section<LinkConfig> section_with(const Option<LinkConfig>& port) {
  return {
      choice_option(
          "transport", &LinkConfig::transport, transport_words(),
          "Shared memory, UNIX stream sockets, or UDP. Lines between hosts of `hosts` are UDP whatever it says."),
      address_option(),
      port,
      rate_option("rate", &LinkConfig::rate, "Data rate of the line; unlimited: as fast as the host."),
      time_option("delay", &LinkConfig::delay, 0s, 1s, "Delay of line and relay together, emulated."),
      section_option("expected", &LinkConfig::expected, expected_section(),
                     "What the network between hosts does by itself; nothing of it is emulated on a living ring."),
  };
}

Option<LinkConfig> key_option() {
  constexpr const char* kRule = "a file, absolute or beside this one; 'ringctl hosts key FILE' makes it";
  return {"key", "none", kRule,
          "udp: the key of all UDP lines, the same file on all hosts, mode 0600: nobody without it is heard.",
          [=](const Entry& entry, LinkConfig& link) {
            link.key = entry.text(kRule);
            if (link.key.empty()) entry.refuse_value("is no file", kRule);
          }};
}

/// Only for the whole ring: a line between a node with a key and one without would not get together.
Section<LinkConfig> with_key(Section<LinkConfig> section) {
  section.push_back(key_option());
  section.push_back(flag_option("insecure", &LinkConfig::insecure,
                                "udp beyond this host without a `key`: whoever is on that network may command the "
                                "robot, and that is meant so."));
  return section;
}

Section<LinkConfig> with_fallback_to_links(Section<LinkConfig> section) {
  for (Option<LinkConfig>& option : section)
    if (option.name != "port") option.fallback = "as in `links`";
  return section;
}

}  // namespace

const Section<LinkConfig>& links_section() {
  static const Section<LinkConfig> section = with_key(section_with(
      port_option(65535 - 254, "of the ring's name, 17000 to 32104",
                  "udp: the port of node 0; the others' are this + id. Each ring on a host needs its own.")));
  return section;
}

const Section<ExpectedConfig>& expected_section() {
  static const Section<ExpectedConfig> section{
      time_option("delay", &ExpectedConfig::delay, 0s, 200ms, "From one end to the other, one way."),
      real_option("loss", &ExpectedConfig::loss, {0, 0.5, "(a probability)"},
                  "How likely a datagram is not to arrive."),
  };
  return section;
}

const Section<LinkConfig>& link_section() {
  static const Section<LinkConfig> section = with_fallback_to_links(
      section_with(port_option(65535, "`links.port` + id", "udp: the node listens at this port.")));
  return section;
}

}  // namespace limb_ring::config
