#include "study/analysis/plan_words.h"

#include <cstdio>

#include "config/core_settings.h"
#include "config/quantity.h"
#include "study/analysis/expected_losses.h"
#include "study/analysis/latency.h"
#include "wire/data_packet.h"

namespace limb_ring::study {

namespace {

std::string with_decimals(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string in_us(Duration duration) { return with_decimals(microseconds(duration), 3) + " us"; }
std::string percent(double share) { return with_decimals(100 * share, 1) + " %"; }

/// The line out of a node is known by where it leads, as in the file.
std::string line_name(const config::RingConfig& ring, std::size_t node) {
  return "the line into " + ring.nodes[(node + 1) % ring.nodes.size()].name;
}

std::uint64_t line_rate(const config::RingConfig& ring, std::size_t node) {
  return ring.nodes[(node + 1) % ring.nodes.size()].link.rate;
}

std::string overload(const std::string& node, const std::string& what, double load) {
  return "node " + node + " would need " + percent(load) + " of the time for its " + what +
         ", one at a time in their worst laps: " + percent(load - 1) + " too much";
}

void add_node_limits(const config::RingConfig& ring, const Plan& plan, std::vector<std::string>& limits) {
  for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
    const std::string& name = ring.nodes[n].name;
    if (plan.nodes[n].data >= 1) limits.push_back(overload(name, "data packets", plan.nodes[n].data));
    if (plan.nodes[n].interrupts >= 1) limits.push_back(overload(name, "interrupts", plan.nodes[n].interrupts));
  }
}

std::string line_overload(const std::string& line, std::uint64_t rate, double load) {
  return line + " would be in use " + percent(load) + " of the time at " + config::format_rate(rate) + ": " +
         percent(load - 1) + " too much";
}

// Every packet occupies every line once, so equal lines are full together.
bool lines_are_equal(const config::RingConfig& ring) {
  for (std::size_t n = 1; n < ring.nodes.size(); ++n)
    if (line_rate(ring, n) != line_rate(ring, 0)) return false;
  return true;
}

void add_line_limits(const config::RingConfig& ring, const Plan& plan, std::vector<std::string>& limits) {
  if (lines_are_equal(ring)) {
    if (plan.lines[0] >= 1) limits.push_back(line_overload("every line", line_rate(ring, 0), plan.lines[0]));
    return;
  }
  for (std::size_t n = 0; n < plan.lines.size(); ++n)
    if (plan.lines[n] >= 1) limits.push_back(line_overload(line_name(ring, n), line_rate(ring, n), plan.lines[n]));
}

// A packet that finds the buffer full is dropped whole, and sent again only after the time-out. One sentence, for the
// worst node.
void add_buffer_limit(const config::RingConfig& ring, const Plan& plan, std::vector<std::string>& limits) {
  std::size_t worst = 0;
  for (std::size_t n = 0; n < plan.nodes.size(); ++n)
    if (plan.nodes[n].waiting > plan.nodes[worst].waiting) worst = n;
  const unsigned packets = setup::core_settings(ring, ring.nodes[worst], 1).insertion_buffer;
  const std::size_t room = (packets - 1) * wire::kMaxDataPacketSize;  // beside one that comes in
  if (plan.nodes[worst].waiting > room)
    limits.push_back(std::to_string(plan.nodes[worst].waiting) + " bytes may wait in the insertion buffer of node " +
                     ring.nodes[worst].name + ": limits.insertion_buffer, " + std::to_string(packets) +
                     " packets of 524 bytes, is too small");
}

// A packet repeated while it still circulates takes its place twice, and the ring gets ever slower.
void add_timeout_limit(const config::RingConfig& ring, const Plan& plan, std::vector<std::string>& limits) {
  const Duration timeout = setup::core_settings(ring, ring.nodes[0], 1).send_timeout();
  if (plan.longest_lap > timeout)
    limits.push_back("a packet may take " + in_us(plan.longest_lap) + " for its lap and is repeated after " +
                     in_us(timeout) + ": a longer timeouts.send is needed");
}

void add_stream_limits(const config::RingConfig& ring, const std::vector<Stream>& streams, const Plan& plan,
                       std::vector<std::string>& limits) {
  for (std::size_t s = 0; s < streams.size(); ++s) {
    const NodePlan& node = plan.nodes[streams[s].source];
    const double load = streams[s].interrupt ? node.interrupts : node.data;
    if (plan.streams[s].late)
      limits.push_back("'" + streams[s].name + "' is late: delivered after up to " + in_us(*plan.streams[s].delivered) +
                       ", and its deadline is " + in_us(streams[s].late_after()));
    if (!plan.streams[s].confirmed && load < 1)
      limits.push_back("'" + streams[s].name + "' may wait longer than timeouts.queue, " +
                       config::format_time(ring.timeouts.queue));
  }
}

}  // namespace

std::string in_words(const Response& response, Duration ahead, Duration longest_lap) {
  std::string words = response.own == 1 ? "own" : "own " + std::to_string(response.own);
  if (response.others != 0) words += " + " + std::to_string(response.others) + " of higher or same priority";
  words += response.lower ? " + 1 of lower priority" : " + 1 ahead (" + in_us(ahead) + ")";
  return words + ", laps of up to " + in_us(longest_lap);
}

std::vector<std::string> limits_of(const config::RingConfig& ring, const std::vector<Stream>& streams,
                                   const Plan& plan) {
  std::vector<std::string> limits;
  add_line_limits(ring, plan, limits);
  add_node_limits(ring, plan, limits);
  add_buffer_limit(ring, plan, limits);
  add_timeout_limit(ring, plan, limits);
  add_stream_limits(ring, streams, plan, limits);
  for (const std::string& timeout : short_timeouts(ring)) limits.push_back(timeout);
  return limits;
}

std::string verdict(const config::RingConfig& ring, const Plan& plan) {
  if (!plan.carried()) {
    std::string text = "The ring cannot be relied on to carry this:";
    for (const std::string& limit : plan.limits) text += "\n  " + limit;
    return text + "\n";
  }
  std::size_t node = 0, line = 0;
  for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
    if (plan.nodes[n].data > plan.nodes[node].data) node = n;
    if (plan.lines[n] > plan.lines[line]) line = n;
  }
  return "The ring carries this. The busiest node is " + ring.nodes[node].name + ", with a packet under way " +
         percent(plan.nodes[node].data) + " of the time at most; the busiest line, " + line_name(ring, line) +
         ", is in use " + percent(plan.lines[line]) + " of it.\n";
}

}  // namespace limb_ring::study
