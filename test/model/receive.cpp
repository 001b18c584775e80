// What Receive answers: protocol.md sections 2.3, 3.5, 4.10 and 5.3.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

namespace {

constexpr int kNoAnswer = 0xFF;

}  // namespace

bool Node::addressed(const Packet& packet) const {
  return packet.broadcast() ? packet.source() != id() : packet.destination() == id();
}

unsigned Node::free_buffers(int priority) const {
  if (!cpu_present_) return 0;
  const std::size_t held = packets[static_cast<std::size_t>(priority)].size();
  return held >= settings_.receive_buffers ? 0 : static_cast<unsigned>(settings_.receive_buffers - held);
}

int Node::answer(const Packet& packet, Time at, Time now) {
  if (packet.control()) return answer_control(packet, at, now);
  if (!addressed(packet)) return kNoAnswer;
  return packet.interrupt() ? answer_interrupt(packet, at, now) : answer_data(packet, at, now);
}

// ---- pages: protocol.md section 4.10 ------------------------------------------------------------------------

/// The page on which a packet is judged; null: it is of an earlier incarnation.
Page* Node::page_for(const Packet& packet, std::uint64_t boot_if_own) {
  const int source = packet.source();
  if (source == id()) {
    Page& page = pages_[source];
    if (page.boot != boot_if_own) {
      page = Page();
      page.boot = boot_if_own;
    }
    return &page;
  }
  const auto found = pages_.find(source);
  if (found == pages_.end()) {
    Page& page = pages_[source];
    page.incarnation = packet.incarnation();
    page.begun_by_packet = true;
    return &page;
  }
  Page& page = found->second;
  const int later = (packet.incarnation() - page.incarnation + 4) % 4;
  if (later == 3) return nullptr;
  if (later != 0) {
    Page next;
    next.incarnation = packet.incarnation();
    next.boot = page.boot;
    next.begun_by_packet = true;
    page = next;
  }
  return &page;
}

/// protocol.md section 4.10: its first try may have been taken before the own start.
bool Node::is_unheard_nodes_retry(const Packet& packet) const {
  if (!falls_into_parts() || packet.attempt() == 0 || packet.source() == id()) return false;
  return peers_.count(packet.source()) == 0;
}

/// protocol.md section 4.10: its source may not know of the own start.
bool Node::is_unaware_nodes_retry(const Packet& packet, Time at) const {
  if (packet.attempt() == 0) return false;
  if (announced_at_ == kNever) return true;
  return falls_into_parts() && at - announced_at_ < 5 * try_timeout();
}

/// What was decided of this packet before; null: it is new.
Decided* Node::known(Page& page, const Packet& packet, Time now) {
  const auto found = page.decided.find({packet.interrupt(), packet.broadcast()});
  if (found == page.decided.end()) return nullptr;
  Decided& decided = found->second;
  if (decided.sequence != packet.sequence()) return nullptr;
  if (packet.attempt() == 0 && (decided.retries_only || now - decided.when > try_timeout())) return nullptr;
  return &decided;
}

/// protocol.md section 4.10: it may have been decided four incarnations ago, or numbers may have wrapped since.
bool Node::is_doubtful(const Decided& decided, Time now) const {
  return decided.before_starting_over || (falls_into_parts() && now - decided.when > 4 * try_timeout());
}

// ---- hellos and beacons -------------------------------------------------------------------------

int Node::answer_control(const Packet& packet, Time at, Time now) {
  const Bytes data = packet.data();
  const auto hello = wire::decode_hello({data.data(), data.size()});
  const auto beacon = wire::decode_beacon({data.data(), data.size()});
  if (!hello && !beacon) return kNoAnswer;
  const std::uint64_t boot = hello ? hello->boot : beacon->boot;
  const int incarnation = static_cast<int>(boot & 3);
  Page& page = pages_[packet.source()];
  if (page.boot && *page.boot != boot && *page.boot > boot && *page.boot - boot <= 1000) return 0;
  if (page.boot != boot) {
    Page next;
    if (beacon && page.incarnation == incarnation) {
      next.decided = page.decided;
      if (!page.begun_by_packet) {
        for (auto entry = next.decided.begin(); entry != next.decided.end();) {
          entry->second.retries_only = true;
          entry = now - entry->second.when > 4 * try_timeout() ? next.decided.erase(entry) : std::next(entry);
        }
      }
    }
    next.incarnation = incarnation;
    next.boot = boot;
    page = next;
  }
  page.decided[{false, packet.broadcast()}] = {packet.sequence(), true, now};
  heard(packet, hello, beacon, at, now);
  return 254;
}

// ---- data -----------------------------------------------------------------------------------------

int Node::answer_data(const Packet& packet, Time at, Time now) {
  if (is_unheard_nodes_retry(packet)) return kNoAnswer;
  Page* page = page_for(packet, boot_);
  if (page == nullptr) return 0;
  const int priority = packet.priority();
  const auto free = static_cast<int>(std::min(254u, free_buffers(priority)));
  if (const Decided* decided = known(*page, packet, now)) {
    if (is_doubtful(*decided, now)) return kNoAnswer;
    return decided->taken ? std::max(1, free) : 0;
  }
  const bool joining = !closed() && !(state_ == NodeState::open_chain && (hello_left_ || hello_remembers_));
  if (is_unaware_nodes_retry(packet, at)) return kNoAnswer;
  const bool taken = !joining && cpu_present_ && free > 0;
  page->decided[{false, packet.broadcast()}] = {packet.sequence(), taken, now};
  if (!taken) return 0;
  core::ReceivedPacket out;
  out.at = at;
  out.source = wire::NodeId{static_cast<std::uint8_t>(packet.source())};
  out.destination = wire::NodeId{static_cast<std::uint8_t>(packet.destination())};
  out.priority = wire::Priority{static_cast<std::uint8_t>(priority)};
  out.channel = wire::ChannelId{static_cast<std::uint8_t>(packet.channel())};
  const Bytes data = packet.data();
  out.size = static_cast<std::uint16_t>(data.size());
  std::copy(data.begin(), data.end(), out.data.begin());
  packets[static_cast<std::size_t>(priority)].push_back(out);
  return free;
}

// ---- interrupts -------------------------------------------------------------------------------------

int Node::answer_interrupt(const Packet& packet, Time at, Time now) {
  if (is_unheard_nodes_retry(packet)) return kNoAnswer;
  Page* page = page_for(packet, boot_);
  if (page == nullptr) return 0;
  if (const Decided* decided = known(*page, packet, now)) {
    if (is_doubtful(*decided, now)) return kNoAnswer;
    return decided->taken ? 1 : 0;
  }
  if (is_unaware_nodes_retry(packet, at)) return kNoAnswer;
  const bool wired = settings_.wired[static_cast<std::size_t>(packet.factor())];
  page->decided[{true, packet.broadcast()}] = {packet.sequence(), wired, now};
  if (!wired) return 0;
  tell(at, core::PinPulled{wire::Factor{static_cast<std::uint8_t>(packet.factor())},
                           wire::NodeId{static_cast<std::uint8_t>(packet.source())}});
  return 1;
}

}  // namespace limb_ring::model
