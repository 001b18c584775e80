#include "judge/forwarding_checker.h"

#include <algorithm>

namespace limb_ring::sim {
namespace {

/// More packets than a node can hold, and than a line without a rate lets go at one instant after it was held up
/// (256 KiB of the smallest packets). With this limit what the node has dropped is forgotten in the end.
constexpr std::size_t kMostComing = 1 << 15;

Words name(const PacketHeader& header, const PacketTrailer& tail) {
  return std::string(header.code.interrupt ? "INTP" : "DATP") + " of " + node_words(header.source) + " to " +
         (tail.destination == wire::kBroadcast ? "all" : node_words(tail.destination)) + ", sequence " +
         std::to_string(header.code.sequence) + ", try " + std::to_string(header.code.attempt);
}

}  // namespace

void ForwardingChecker::came(const PacketHeader& header, NodeId destination, Due due, std::size_t size, Time now) {
  auto& coming = header.code.interrupt ? interrupts_ : data_;
  if (coming.size() == kMostComing) {
    if (!header.code.interrupt) bytes_ -= coming.front().size;
    coming.pop_front();
  }
  coming.push_back({header.code_byte, header.source, destination, due, size, now});
  if (!header.code.interrupt) bytes_ += size;
}

// Packets of a kind leave in the order in which they came, so those before it were dropped. A dropped one may differ
// from a later one by its FBC only.
bool ForwardingChecker::went(const PacketHeader& header, const PacketTrailer& tail, Time now) {
  auto& coming = header.code.interrupt ? interrupts_ : data_;
  const auto is_it = [&](const Coming& c) {
    return c.code_byte == header.code_byte && c.source == header.source && c.destination == tail.destination;
  };
  const auto as_is_due = [&](const Coming& c) { return is_it(c) && (c.due.fbc == kAnyFbc || c.due.fbc == tail.fbc); };
  auto it = std::find_if(coming.begin(), coming.end(), as_is_due);
  const bool due = it != coming.end();
  if (!due) it = std::find_if(coming.begin(), coming.end(), is_it);
  if (it == coming.end()) {
    complain_(Promise::true_fbc, name(header, tail) + " left without having come in at " + node_words(id_));
    return false;
  }
  if (!due)
    complain_(it->due.promise, name(header, tail) + " goes on with FBC " + std::to_string(tail.fbc) + " instead of " +
                                   std::to_string(it->due.fbc) + " at " + node_words(id_));
  if (header.code.interrupt) {
    // One alike may have come long before, and been dropped.
    const auto newest = std::find_if(coming.rbegin(), coming.rend(), is_it);
    check_wait(newest->at + lag_, now, name(header, tail));
  } else {
    for (auto gone = coming.begin(); gone != it + 1; ++gone) bytes_ -= gone->size;
  }
  const bool good = it->due.good;
  // Mostly it is the first, and erase() costs more.
  for (auto left = it - coming.begin() + 1; left != 0; --left) coming.pop_front();
  return good;
}

std::size_t ForwardingChecker::bytes_since(Time since) const {
  std::size_t bytes = 0;
  for (auto it = data_.rbegin(); it != data_.rend() && it->at >= since; ++it) bytes += it->size;
  return bytes;
}

void ForwardingChecker::own_interrupt_went(Time since, Time now) { check_wait(since, now, "its own INTP"); }

// Each INTP before it, and at most the longest tail of a DATP: 3 odd bytes, trailer and CRC. (protocol.md section 5.2)
void ForwardingChecker::check_wait(Time since, Time now, const Words& which) const {
  since = std::max(since, released_);
  const Duration interrupt = byte_time_ * static_cast<std::int64_t>(wire::kInterruptPacketSize);
  const auto first_ahead = std::partition_point(interrupts_gone_.begin(), interrupts_gone_.end(),
                                                [&](Time gone) { return gone + interrupt <= since; });
  const auto ahead = interrupts_gone_.end() - first_ahead;
  constexpr auto kLongestTail = static_cast<std::int64_t>(wire::tail_size(wire::kOverhead + wire::kWord - 1));
  const Duration most = interrupt * ahead + byte_time_ * kLongestTail;
  if (now - since > most)
    complain_(Promise::interrupt_wait, which + " waited " + std::to_string(core::picoseconds(now - since)) + " ps at " +
                                           node_words(id_) + ", " + std::to_string(core::picoseconds(most)) +
                                           " are allowed");
}

void ForwardingChecker::count_interrupt(Time now) {
  if (interrupts_gone_.size() == kMostComing) interrupts_gone_.pop_front();
  interrupts_gone_.push_back(now);
}

void ForwardingChecker::clear() {
  data_.clear();
  interrupts_.clear();
  bytes_ = 0;
}

}  // namespace limb_ring::sim
