#include "study/analysis/laps.h"

#include <algorithm>

#include "config/core_settings.h"

namespace limb_ring::study {

namespace {

constexpr Duration kNoRoom = std::chrono::seconds(10);
constexpr auto kInterrupt = static_cast<unsigned>(wire::kOverhead);
constexpr auto kTail = static_cast<unsigned>(wire::kTrailerSize + wire::kCrcSize);

unsigned size_on_line(unsigned data) { return data + static_cast<unsigned>(wire::kOverhead); }

}  // namespace

Laps::Laps(const config::RingConfig& ring, const std::vector<Stream>& streams)
    : largest_(ring.nodes.size(), 0), smallest_(ring.nodes.size(), 0) {
  for (std::size_t n = 0; n < ring.nodes.size(); ++n) {
    const config::LinkConfig& line = ring.nodes[(n + 1) % ring.nodes.size()].link;
    byte_time_.push_back(setup::byte_time(line));
    delay_.push_back(line.whole_delay());
  }
  for (const Stream& stream : streams)
    for (const unsigned packet : stream.packets) {
      const unsigned size = size_on_line(packet);
      unsigned &largest = largest_[stream.source], &smallest = smallest_[stream.source];
      smallest = smallest == 0 ? size : std::min(smallest, size);
      largest = std::max(largest, size);
      odd_ = std::max(odd_, packet % 4);
    }
}

template <class Visit>
void Laps::visit_lines(NodeId source, NodeId to, Visit visit) const {
  NodeId node = source;
  do {
    visit(node);
    node = next(node);
  } while (node != to);
}

bool Laps::narrows(NodeId node) const { return byte_time_[node] > byte_time_[previous(node)]; }

Duration Laps::slowest_line(unsigned bytes) const {
  return *std::max_element(byte_time_.begin(), byte_time_.end()) * static_cast<std::int64_t>(bytes);
}

Duration Laps::all_but(NodeId source, NodeId line) const {
  Duration sum{0};
  for (std::size_t n = 0; n < largest_.size(); ++n)
    if (n != source) sum += on_line(line, largest_[n]);
  return sum;
}

// An own packet takes time on the line out, but its return, which is not relayed, gives the same time back. So at most
// one own packet ever has to be waited for, unless the line out is slower than the line in.
Duration Laps::data_queue(NodeId source, NodeId node) const {
  if (narrows(node)) return all_but(source, node);
  return node == source ? Duration{0} : on_line(node, largest_[node]);
}

Duration Laps::interrupt_queue(NodeId source, NodeId node) const {
  if (narrows(node)) return on_line(node, kInterrupt) * static_cast<std::int64_t>(byte_time_.size() - 1);
  return node == source ? Duration{0} : on_line(node, kInterrupt);
}

Duration Laps::data(NodeId source, NodeId to, unsigned bytes) const {
  Duration on_slowest{0}, sum = interrupts_;
  visit_lines(source, to, [&](NodeId node) {
    on_slowest = std::max(on_slowest, on_line(node, size_on_line(bytes)));
    sum += delay_[node] + data_queue(source, node);
  });
  return on_slowest + sum;
}

Duration Laps::data_ahead(NodeId source) const {
  unsigned largest = 0;
  for (std::size_t n = 0; n < largest_.size(); ++n)
    if (n != source) largest = std::max(largest, largest_[n]);
  return slowest_line(largest) + interrupts_;
}

std::size_t Laps::waiting(NodeId node) const {
  std::size_t all = 0, largest = 0;
  for (std::size_t n = 0; n < largest_.size(); ++n) {
    if (n == node) continue;
    all += largest_[n];
    largest = std::max<std::size_t>(largest, largest_[n]);
  }
  if (narrows(node)) return all;
  const Duration own = on_line(node, largest_[node]) + interrupts_;
  const auto behind = static_cast<std::size_t>((own.count() + byte_time_[node].count() - 1) / byte_time_[node].count());
  return std::min(all, behind + 2 * largest);
}

Duration Laps::interrupt(NodeId source, NodeId to) const {
  Duration on_slowest{0}, sum{0};
  visit_lines(source, to, [&](NodeId node) {
    on_slowest = std::max(on_slowest, on_line(node, kInterrupt));
    sum += delay_[node] + on_line(node, kTail + odd_) + interrupt_queue(source, node);
  });
  return on_slowest + sum;
}

Duration Laps::interrupt_ahead() const { return slowest_line(kInterrupt); }

Duration Laps::least_interrupt() const {
  Duration sum{0};
  for (const Duration delay : delay_) sum += delay;
  return sum + slowest_line(kInterrupt);
}

Duration Laps::longest_data() const {
  Duration longest{0};
  for (std::size_t n = 0; n < largest_.size(); ++n) {
    const auto node = static_cast<NodeId>(n);
    if (largest_[n] != 0)
      longest = std::max(longest, data(node, node, largest_[n] - static_cast<unsigned>(wire::kOverhead)));
  }
  return longest;
}

bool Laps::set_interrupts(const std::vector<Interrupts>& interrupts) {
  interrupts_ = Duration{0};
  const Duration lap = longest_data();
  for (Duration before{-1}; interrupts_ != before && interrupts_ < kNoRoom;) {
    before = interrupts_;
    std::int64_t count = 0;
    for (const Interrupts& each : interrupts) count += (lap + before + each.under_way) / each.period + 1;
    interrupts_ = slowest_line(kInterrupt) * count;
  }
  return interrupts_ < kNoRoom;
}

}  // namespace limb_ring::study
