#pragma once

#include <deque>

#include "core/events.h"
#include "judge/violation.h"

namespace limb_ring::sim {

/// The pins that one node has to pull, and when: each once, and none besides. (protocol.md section 5.3)
class DuePins {
 public:
  DuePins(wire::NodeId node, const Complain& complain) : node_(node), complain_(complain) {}

  /// The last bit of an INTP is in. @param sure false: perhaps it was taken before
  void put(wire::NodeId source, wire::Factor factor, core::Time at, bool sure);
  void pulled(const core::PinPulled& pin, core::Time at);
  /// Pins that were due before `now` must have been pulled.
  void judge(core::Time now) {
    if (!due_.empty() && due_.front().at < now) drop_before(now);
  }
  void clear() { due_.clear(); }
  template <class Archive>
  void archive(Archive& a) {
    a("due", due_);
  }

 private:
  struct Due {
    wire::NodeId source;
    wire::Factor factor;
    core::Time at;
    bool sure;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("factor", factor)("at", at)("sure", sure);
    }
  };
  void drop_before(core::Time now);

  wire::NodeId node_;
  const Complain& complain_;
  std::deque<Due> due_;
};

}  // namespace limb_ring::sim
