#include "study/figures.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "study/latency.h"
#include "wire/packet.h"

namespace limb_ring::study {

namespace {

constexpr int kMoments = 32;             // that a burst, or a message alone, is tried at
constexpr unsigned kCyclesSpread = 4;    // they are spread over; more than a cycle of any method
constexpr unsigned kSaturatedEach = 100;  // messages per node
constexpr unsigned kRandomPackets = 4000;  // full packets that fit into the time of a random load
constexpr unsigned kInterruptsPerLap = 2;
constexpr unsigned kInterrupts = 400;

/// A lap of full packets of ours in the worst case: the scale of all spans.
Duration lap(const Medium& medium) {
  return medium.nodes * (medium.byte_time() * (medium.payload + wire::kOverhead) + medium.relay_delay);
}

Latencies latencies(const Network& network, const Medium& medium, const std::vector<Message>& messages, Time until,
                    const std::function<bool(const Message&)>& counts) {
  const std::vector<Time> delivered = network.carry(medium, messages, until);
  Latencies out;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (!counts(messages[i])) continue;
    if (delivered[i] == core::kNever) throw std::runtime_error("a message was not delivered");
    out.add(delivered[i] - messages[i].asked);
  }
  return out;
}

Latencies latencies(const Network& network, const Medium& medium, const std::vector<Message>& messages) {
  return latencies(network, medium, messages, core::kNever, [](const Message&) { return true; });
}

Spread spread(const Latencies& of) { return {of.max(), of.mean()}; }

/// @param list of the messages asked for at that time
Spread at_many_moments(const Network& network, const Medium& medium, Random& random,
                       const std::function<std::vector<Message>(Time)>& list) {
  const auto span = static_cast<std::uint64_t>((kCyclesSpread * lap(medium)).count());
  Latencies all;
  for (int i = 0; i < kMoments; ++i) {
    const Time asked{Duration{static_cast<std::int64_t>(draw(random, span))}};
    const Latencies burst = latencies(network, medium, list(asked));
    for (const Duration latency : burst.values()) all.add(latency);
  }
  return spread(all);
}

Spread measure_alone(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  return at_many_moments(network, medium, random, [&](Time asked) {
    const auto source = static_cast<NodeId>(draw(random, medium.nodes));
    return std::vector<Message>{message(medium, asked, source, Destination::opposite, random)};
  });
}

Duration random_span(const Medium& medium) {
  return kRandomPackets * medium.byte_time() * (medium.payload + wire::kOverhead);
}

Spread measure_random_load(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  return spread(latencies(network, medium, random_load(medium, kRandomLoad, random_span(medium), random)));
}

double share_of_rate(const Medium& medium, std::ptrdiff_t messages, Duration time) {
  const double bits = 8.0 * medium.payload * static_cast<double>(messages);
  return bits / (std::chrono::duration<double>(time).count() * static_cast<double>(medium.rate));
}

/// The network stays full for twice the time in which the interrupts are asked for: no method that
/// shares one line of rate R can carry more payload than that.
Spread measure_interrupt(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  const Duration gap = lap(medium) / kInterruptsPerLap;
  const Duration span = kInterrupts * gap;
  const auto each = static_cast<unsigned>(2 * span / (medium.nodes * medium.payload * medium.byte_time())) + 1;
  const auto full = all_at_once(medium, Time{}, each, Destination::random, random);
  const auto messages = with_interrupts(full, medium, kInterrupts, gap, random);
  return spread(latencies(network, medium, messages, Time{} + 2 * span, [](const Message& m) { return m.interrupt; }));
}

/// Between the first tenth of the deliveries and their half: neither filling up nor running dry.
double measure_saturated(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  const auto messages = all_at_once(medium, Time{}, kSaturatedEach, Destination::random, random);
  std::vector<Time> at = network.carry(medium, messages, core::kNever);
  std::sort(at.begin(), at.end());
  const Time from = at[at.size() / 10], to = at[at.size() / 2];
  const auto between = std::upper_bound(at.begin(), at.end(), to) - std::upper_bound(at.begin(), at.end(), from);
  return share_of_rate(medium, between, to - from);
}

}  // namespace

Spread measure_at_once(const Network& network, const Medium& medium, Destination destination, std::uint64_t seed) {
  Random random(seed);
  return at_many_moments(network, medium, random,
                         [&](Time asked) { return all_at_once(medium, asked, 1, destination, random); });
}

double measure_efficiency(const Network& network, const Medium& medium, double load, std::uint64_t seed) {
  Random random(seed);
  const Duration span = random_span(medium);
  const auto at = network.carry(medium, random_load(medium, load, span, random), Time{} + span);
  const auto delivered = std::count_if(at.begin(), at.end(), [](Time t) { return t != core::kNever; });
  return share_of_rate(medium, delivered, span);
}

Figures measure(const Network& network, const Medium& medium, std::uint64_t seed) {
  Figures figures;
  figures.alone = measure_alone(network, medium, seed);
  figures.at_once_opposite = measure_at_once(network, medium, Destination::opposite, seed);
  figures.at_once_random = measure_at_once(network, medium, Destination::random, seed);
  figures.interrupt = measure_interrupt(network, medium, seed);
  figures.join = network.time_to_join(medium);
  figures.efficiency = measure_saturated(network, medium, seed);
  // Beyond it the queues grow for as long as one looks.
  if (figures.efficiency > kRandomLoad) figures.random_load = measure_random_load(network, medium, seed);
  return figures;
}

}  // namespace limb_ring::study
