#include "comparison/network.h"

#include <algorithm>
#include <cmath>

namespace limb_ring::study {
namespace {

Time random_time(Time from, Duration span, Random& random) {
  return from + Duration{static_cast<std::int64_t>(draw(random, static_cast<std::uint64_t>(span.count())))};
}

NodeId any_node(const Medium& medium, Random& random) { return static_cast<NodeId>(draw(random, medium.nodes)); }

NodeId other_node(const Medium& medium, NodeId source, Random& random) {
  return static_cast<NodeId>((source + 1 + draw(random, medium.nodes - 1)) % medium.nodes);
}

void sort_by_time(std::vector<Message>& messages) {
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.asked < b.asked; });
}

}  // namespace

std::uint64_t draw(Random& random, std::uint64_t below) {
  const std::uint64_t unfair = (0 - below) % below;  // 2^64 mod below: the first values come once more often
  std::uint64_t value = random();
  while (value < unfair) value = random();
  return value % below;
}

Message message(const Medium& medium, Time asked, NodeId source, Destination destination, Random& random) {
  const NodeId to = destination == Destination::opposite
                        ? static_cast<NodeId>((source + medium.nodes / 2) % medium.nodes)
                        : other_node(medium, source, random);
  return {asked, source, to, medium.payload, 0, false};
}

std::vector<Message> all_at_once(const Medium& medium, Time asked, unsigned each, Destination destination,
                                 Random& random) {
  std::vector<Message> messages;
  for (unsigned i = 0; i < each; ++i)
    for (unsigned node = 0; node < medium.nodes; ++node)
      messages.push_back(message(medium, asked, static_cast<NodeId>(node), destination, random));
  return messages;
}

std::vector<Message> random_load(const Medium& medium, double load, Time from, Duration span, Random& random) {
  const double bits = load * std::chrono::duration<double>(span).count() * static_cast<double>(medium.rate);
  const auto count = static_cast<std::size_t>(std::llround(bits / (8.0 * medium.payload)));
  std::vector<Message> messages;
  while (messages.size() < count) {
    const Time asked = random_time(from, span, random);
    messages.push_back(message(medium, asked, any_node(medium, random), Destination::random, random));
  }
  sort_by_time(messages);
  return messages;
}

std::vector<Message> with_interrupts(std::vector<Message> load, const Medium& medium, unsigned count, Duration gap,
                                     Random& random) {
  for (unsigned i = 0; i < count; ++i) {
    const Time asked = random_time(Time{} + i * gap, gap / 2, random);
    const NodeId source = any_node(medium, random);
    load.push_back({asked, source, other_node(medium, source, random), 0, 0, true});
  }
  sort_by_time(load);
  return load;
}

}  // namespace limb_ring::study
