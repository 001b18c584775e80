#include "study/analysis/plan.h"

#include <algorithm>

#include "study/analysis/laps.h"
#include "study/analysis/plan_words.h"
#include "study/analysis/response.h"
#include "wire/interrupt_packet.h"

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

}  // namespace limb_ring::study
