#include "study/plan.h"

#include <algorithm>
#include <cstdio>

#include "config/core_settings.h"
#include "config/quantity.h"
#include "study/model_ring.h"
#include "study/response.h"
#include "study/traffic_run.h"
#include "wire/packet.h"

namespace limb_ring::study {
namespace {

using config::RingConfig;

/// Beacons go before priority 0; INTPs have a unit of their own, first come first served.
unsigned rank_of(const Stream& stream) { return stream.beacon || stream.interrupt ? 0 : stream.priority + 1u; }

class Planner {
 public:
  Planner(const RingConfig& ring, const std::vector<Stream>& streams)
      : ring_(ring), streams_(streams), laps_(ring, streams) {
    plan_.streams.resize(streams.size());
    plan_.nodes.resize(ring.nodes.size());
    plan_.lines.resize(ring.nodes.size());
  }

  Plan make() {
    for_each_unit(true);
    room_for_data_ = laps_.set_interrupts(interrupts());
    for_each_unit(false);
    plan_.longest_lap = laps_.longest_data();
    for (std::size_t n = 0; n < plan_.nodes.size(); ++n) plan_.nodes[n].waiting = laps_.waiting(static_cast<NodeId>(n));
    add_line_loads();
    plan_.limits = limits_of(ring_, streams_, plan_);
    return plan_;
  }

 private:
  void for_each_unit(bool interrupts) {
    for (std::size_t node = 0; node < ring_.nodes.size(); ++node) plan_unit(node, interrupts);
  }

  /// One of the two units of Transmit in a node: the streams that share it.
  void plan_unit(std::size_t node, bool interrupts) {
    std::vector<std::size_t> members;
    std::vector<Contender> contenders;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      if (streams_[s].source != node || streams_[s].interrupt.has_value() != interrupts) continue;
      members.push_back(s);
      contenders.push_back(contender(streams_[s]));
    }
    double& busy = interrupts ? plan_.nodes[node].interrupts : plan_.nodes[node].data;
    for (std::size_t i = 0; i < members.size(); ++i) {
      busy += plan_.streams[members[i]].load = contenders[i].load();
      bound(members[i], contenders, i);
    }
  }

  Duration lap(const Stream& stream, NodeId to, unsigned packet) const {
    return stream.interrupt ? laps_.interrupt(stream.source, to) : laps_.data(stream.source, to, packet);
  }

  Contender contender(const Stream& stream) const {
    const std::vector<unsigned> packets = stream.interrupt ? std::vector<unsigned>{0} : stream.packets;
    Contender contender;
    contender.rank = rank_of(stream);
    contender.jobs = static_cast<unsigned>(packets.size());
    contender.period = stream.period;
    contender.jitter = stream.jitter;
    std::optional<unsigned> before;  // most packets of a large message are alike, and lap() visits every line
    for (const unsigned packet : packets) {
      if (packet != before) contender.last = lap(stream, stream.source, packet);
      before = packet;
      contender.work += contender.last;
      contender.longest = std::max(contender.longest, contender.last);
    }
    return contender;
  }

  void bound(std::size_t s, const std::vector<Contender>& unit, std::size_t which) {
    const Stream& stream = streams_[s];
    const Duration ahead = stream.interrupt ? laps_.interrupt_ahead() : laps_.data_ahead(stream.source);
    std::optional<Response> response;
    if (room_for_data_ || stream.interrupt) response = worst_response(unit, which, ahead, ring_.timeouts.queue);
    StreamPlan& out = plan_.streams[s];
    if (!response) {
      out.why = "no bound";
      return;
    }
    const NodeId far = stream.destination == wire::kBroadcast ? laps_.previous(stream.source) : stream.destination;
    out.delivered = response->wait + lap(stream, far, stream.interrupt ? 0 : stream.packets.back());
    out.confirmed = response->wait + unit[which].last;
    out.late = *out.delivered > stream.late_after();
    Duration longest{0};
    for (const Contender& other : unit) longest = std::max(longest, other.longest);
    out.why = in_words(*response, ahead, longest);
  }

  /// A node whose interrupts have no bound sends one after the other.
  std::vector<Laps::Interrupts> interrupts() const {
    std::vector<Laps::Interrupts> all;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      const Stream& stream = streams_[s];
      if (!stream.interrupt) continue;
      if (plan_.streams[s].confirmed)
        all.push_back({stream.period, stream.jitter + *plan_.streams[s].confirmed});
      else
        all.push_back({laps_.least_interrupt(), laps_.interrupt(stream.source, stream.source)});
    }
    return all;
  }

  void add_line_loads() {
    for (const Stream& stream : streams_) {
      std::size_t bytes = stream.packets.size() * wire::kOverhead + (stream.interrupt ? wire::kInterruptPacketSize : 0);
      for (const unsigned packet : stream.packets) bytes += packet;
      for (std::size_t n = 0; n < plan_.lines.size(); ++n) {
        const Duration busy = laps_.on_line(static_cast<NodeId>(n), static_cast<unsigned>(bytes));
        plan_.lines[n] += static_cast<double>(busy.count()) / static_cast<double>(stream.period.count());
      }
    }
  }

  const RingConfig& ring_;
  const std::vector<Stream>& streams_;
  Laps laps_;
  Plan plan_;
  bool room_for_data_ = true;
};

}  // namespace

Plan plan(const RingConfig& ring, const std::vector<Stream>& streams) { return Planner(ring, streams).make(); }

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
  return "The ring carries this. The busiest node, " + ring.nodes[node].name + ", has a packet under way for at most " +
         percent(plan.nodes[node].data) + " of the time. The busiest line, " + line_name(ring, line) +
         ", is in use for at most " + percent(plan.lines[line]) + ".\n";
}

}  // namespace limb_ring::study
