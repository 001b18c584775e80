#pragma once

#include <algorithm>
#include <deque>
#include <iterator>
#include <utility>
#include <variant>

#include "core/outcome.h"
#include "core/time.h"
#include "wire/control_message.h"
#include "wire/packet.h"

namespace limb_ring::core {

using wire::NodeId;

/// Who asked for a send. A reset or a lost connection cancels the sends of one owner. 0 is the NC itself.
using Owner = std::uint32_t;
constexpr Owner kController = 0;

/// States a node can be in, as status shows them. (ours, protocol.md section 8.1)
enum class NodeState : std::uint8_t {
  starting,  ///< its links are not there yet
  joining,   ///< its hello is not home yet
  up,
  open_chain,   ///< the ring is broken: everything goes on, unconfirmed
  folded,       ///< fold-back around a break
  alone,        ///< the only living node
  duplicate_id  ///< another node has this node's id
};
const char* to_string(NodeState state);

/// The end of one send or interrupt.
struct SendEnded {
  Owner owner = 0;
  std::uint32_t token = 0;
  Outcome outcome = Outcome::rejected;
  Reject reject = Reject::none;
  Duration round_trip{0};  ///< of the try that came home; 0 if none did
  unsigned tries = 0;
  bool interrupt = false;
  NodeId destination{0};
  wire::Factor factor{};  ///< of an interrupt

  template <class Archive>
  void archive(Archive& a) {
    a("owner", owner)("token", token)("outcome", outcome)("reject", reject)("round_trip", round_trip)("tries", tries);
    a("interrupt", interrupt)("destination", destination)("factor", factor);
  }
};

/// The pin of that number was pulled by an INTP with a good CRC; once per INTP.
struct PinPulled {
  wire::Factor factor{};
  NodeId source{0};

  template <class Archive>
  void archive(Archive& a) {
    a("factor", factor)("source", source);
  }
};

struct StateChanged {
  NodeState before, after;

  template <class Archive>
  void archive(Archive& a) {
    a("before", before)("after", after);
  }
};

/// A beacon says something new of its node (state of CPU, links or boots), or is the first.
struct PeerChanged {
  NodeId node{0};

  template <class Archive>
  void archive(Archive& a) {
    a("node", node);
  }
};

/// The own beacon came home: the ring is closed, and this is how long it takes.
struct BeaconHome {
  Duration round_trip{0};

  template <class Archive>
  void archive(Archive& a) {
    a("round_trip", round_trip);
  }
};

struct Event {
  Time at{};
  std::variant<SendEnded, PinPulled, StateChanged, PeerChanged, BeaconHome> what;

  template <class Archive>
  void archive(Archive& a) {
    a("at", at)("what", what);
  }
};

/// Events in the order of their time. On a line with a data rate a packet is judged while its last bytes still come
/// in, so an event can lie a few byte times ahead: it is given out when due.
class EventQueue {
 public:
  template <class What>
  void put(Time at, What what) {
    auto place = events_.end();
    while (place != events_.begin() && std::prev(place)->at > at) --place;
    events_.insert(place, Event{at, std::move(what)});
  }
  /// States are shown in their order: those that lie ahead come before this one, at the same time. (ours, protocol.md
  /// section 6.4)
  void put(Time at, StateChanged change) {
    for (Event& event : events_)
      if (std::holds_alternative<StateChanged>(event.what)) event.at = std::min(event.at, at);
    std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.at < b.at; });
    put<StateChanged>(at, std::move(change));
  }
  /// @return false if none is due
  bool take(Time now, Event& out) {
    if (events_.empty() || events_.front().at > now) return false;
    out = std::move(events_.front());
    events_.pop_front();
    return true;
  }
  bool is_due(Time now) const { return !events_.empty() && events_.front().at <= now; }
  Time next() const { return events_.empty() ? kNever : events_.front().at; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("events", events_);
  }

 private:
  std::deque<Event> events_;
};

}  // namespace limb_ring::core
