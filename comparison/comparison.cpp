#include "comparison/comparison.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>

#include "comparison/buses.h"
#include "comparison/point_to_point.h"
#include "comparison/process_image.h"
#include "comparison/ring_network.h"
#include "study/model_ring.h"
#include "wire/packet.h"

namespace limb_ring::study {
namespace {

constexpr std::uint64_t kMega = 1'000'000;
constexpr std::uint64_t kMostMessages = 4'000'000;  // some 650 MB

struct Method {
  std::string name;
  std::uint64_t own_rate;  ///< of the paper's Table I, bit/s
  std::unique_ptr<Network> network;
};

std::vector<Method> methods(std::function<void()> goes_on = [] {}) {
  std::vector<Method> all;
  all.push_back({"limb_ring", 1000 * kMega, std::make_unique<RingNetwork>(std::move(goes_on))});
  all.push_back({"ARCNET", 5 * kMega, std::make_unique<Arcnet>()});
  all.push_back({"EtherCAT", 100 * kMega, std::make_unique<EtherCat>()});
  all.push_back({"SERCOS II", 16 * kMega, std::make_unique<Sercos>()});
  all.push_back({"Responsive Link", 500 * kMega, std::make_unique<ResponsiveLink>()});
  all.push_back({"CAN / MLVDS", 100 * kMega, std::make_unique<CanBus>()});
  return all;
}

/// Tells whenever it is given something to carry.
class TellingNetwork final : public Network {
 public:
  TellingNetwork(const Network& network, std::function<void()> tell) : network_(network), tell_(std::move(tell)) {}

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override {
    tell_();
    return network_.carry(medium, messages, until);
  }
  Duration time_to_join(const Medium& medium) const override {
    tell_();
    return network_.time_to_join(medium);
  }

 private:
  const Network& network_;
  std::function<void()> tell_;
};

void add(const ComparisonOptions& options, const Subject& subject, const Network& quiet, Comparison& out) {
  const TellingNetwork network(quiet, [&] { options.tell(subject); });
  Medium medium = options.medium;
  medium.rate = subject.rate;
  out.methods.push_back({subject, measure(network, medium, options.seed)});
  for (const double load : options.loads)
    out.against_load.push_back({subject, load, measure_efficiency(network, medium, load, options.seed)});
  for (const unsigned nodes : options.nodes) {
    medium.nodes = nodes;
    const Spread at_once = measure_at_once(network, medium, Destination::opposite, options.seed);
    out.against_nodes.push_back({subject, nodes, at_once});
  }
}

}  // namespace

bool comparable(const Medium& medium) {
  Medium fastest = medium;
  for (const Method& method : methods()) fastest.rate = std::max(fastest.rate, method.own_rate);
  return full_load(fastest) <= kMostMessages;
}

Comparison compare(const ComparisonOptions& options) {
  Comparison out;
  Subject now;
  const std::vector<Method> all = methods([&] { options.tell(now); });
  const auto go_through = [&](const Method& method, bool own_rate, std::uint64_t rate) {
    now = {method.name, own_rate, rate};
    add(options, now, *method.network, out);
  };
  for (const Method& method : all) go_through(method, false, options.medium.rate);
  for (const Method& method : all) go_through(method, true, method.own_rate);
  return out;
}

namespace {

constexpr int kInstants = 32;              // instants at which a burst, or a message alone, is tried
constexpr unsigned kCyclesSpread = 4;      // cycles over which these instants are spread: more than one of any method
constexpr unsigned kSaturatedEach = 100;   // messages per node
constexpr unsigned kLeastScale = 64;       // bytes: with less payload the others' own overhead is what takes time
constexpr unsigned kRandomPackets = 3000;  // packets that fit into the time of a random load
constexpr unsigned kWarmUpPackets = 1000;  // packets that fit into the time before that, which does not count
constexpr unsigned kInterruptsPerLap = 2;
constexpr unsigned kInterrupts = 1000;

/// A lap of packets of ours in the worst case: the scale of all spans.
Duration lap(const Medium& medium) {
  const unsigned size = std::max(medium.payload, kLeastScale) + wire::kOverhead;
  return medium.nodes * (medium.byte_time() * size + medium.relay_delay);
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
  for (int i = 0; i < kInstants; ++i) {
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

Spread measure_random_load(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  const Duration span = kRandomPackets * packet_time(medium);
  return spread(latencies(network, medium, random_load(medium, kRandomLoad, Time{}, span, random)));
}

double share_of_rate(const Medium& medium, std::size_t messages, std::chrono::duration<double> time) {
  return 8.0 * medium.payload * static_cast<double>(messages) / (time.count() * static_cast<double>(medium.rate));
}

Duration between_interrupts(const Medium& medium) { return lap(medium) / kInterruptsPerLap; }

/// The network stays full for twice the time in which the interrupts are asked for: no method that
/// shares one line of rate R can carry more payload than that.
std::uint64_t full_load_each(const Medium& medium) {
  const Duration span = kInterrupts * between_interrupts(medium);
  return static_cast<std::uint64_t>(2 * span / (medium.nodes * medium.payload * medium.byte_time())) + 1;
}

Spread measure_interrupt(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  const Duration gap = between_interrupts(medium);
  const Duration span = kInterrupts * gap;
  const auto each = static_cast<unsigned>(full_load_each(medium));
  const auto full = all_at_once(medium, Time{}, each, Destination::random, random);
  const auto messages = with_interrupts(full, medium, kInterrupts, gap, random);
  return spread(latencies(network, medium, messages, Time{} + 2 * span, [](const Message& m) { return m.interrupt; }));
}

/// Measured from the first tenth of the deliveries to about half of them, when the network neither fills up nor runs
/// dry. It is a mean over many starts and ends, so that it does not matter where in a cycle these lie.
double measure_saturated(const Network& network, const Medium& medium, std::uint64_t seed) {
  Random random(seed);
  const auto messages = all_at_once(medium, Time{}, kSaturatedEach, Destination::random, random);
  std::vector<Time> at = network.carry(medium, messages, core::kNever);
  std::sort(at.begin(), at.end());
  const std::size_t first = at.size() / 10, ends = first, step = 4 * first;
  std::chrono::duration<double> sum{0};
  for (std::size_t i = first; i < first + ends; ++i) sum += at[i + step] - at[i];
  return share_of_rate(medium, step, sum / static_cast<double>(ends));
}

}  // namespace

Spread measure_at_once(const Network& network, const Medium& medium, Destination destination, std::uint64_t seed) {
  Random random(seed);
  return at_many_moments(network, medium, random,
                         [&](Time asked) { return all_at_once(medium, asked, 1, destination, random); });
}

double measure_efficiency(const Network& network, const Medium& medium, double load, std::uint64_t seed) {
  Random random(seed);
  const Time from = Time{} + kWarmUpPackets * packet_time(medium);
  const Duration span = kRandomPackets * packet_time(medium);
  auto messages = random_load(medium, load, Time{}, from - Time{}, random);
  const auto counted = random_load(medium, load, from, span, random);
  messages.insert(messages.end(), counted.begin(), counted.end());
  const auto at = network.carry(medium, messages, from + span);
  const auto delivered = std::count_if(at.begin(), at.end(), [from](Time t) { return t != core::kNever && t > from; });
  return share_of_rate(medium, static_cast<std::size_t>(delivered), span);
}

std::uint64_t full_load(const Medium& medium) { return medium.nodes * full_load_each(medium); }

Figures measure(const Network& network, const Medium& medium, std::uint64_t seed) {
  Figures figures;
  figures.alone = measure_alone(network, medium, seed);
  figures.at_once_opposite = measure_at_once(network, medium, Destination::opposite, seed);
  figures.at_once_random = measure_at_once(network, medium, Destination::random, seed);
  figures.interrupt = measure_interrupt(network, medium, seed);
  figures.join = network.time_to_join(medium);
  figures.efficiency = measure_saturated(network, medium, seed);
  // Beyond it the queues grow without end.
  if (figures.efficiency > kRandomLoad) figures.random_load = measure_random_load(network, medium, seed);
  return figures;
}

}  // namespace limb_ring::study
