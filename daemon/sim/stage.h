#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/membership/membership.h"
#include "core/time.h"
#include "sim/scenario.h"
#include "sim/tally.h"

namespace limb_ring::scenario {

/// What can be seen of a ring at one moment: all that conditions speak of.
class StageView {
 public:
  virtual ~StageView() = default;

  virtual unsigned size() const = 0;  ///< nodes, living or not
  virtual const std::string& name(NodeId id) const = 0;
  /// Neither dead nor frozen. If it is not alive, the values below mean nothing.
  virtual bool alive(NodeId id) const = 0;
  virtual core::NodeState state(NodeId id) const = 0;
  virtual unsigned ring_size(NodeId id) const = 0;  ///< as that node has learned it; 0: not yet
  /// The last beacon of `of` that `by` has heard, its nodes as places; nothing if none. Only the CPU's state and
  /// boots, and the break, are used.
  virtual std::optional<wire::Beacon> heard(NodeId by, NodeId of) const = 0;
  /// By name, of core/counters.h; of the node since its last start. 0 where it is dead.
  virtual std::uint64_t counter(NodeId id, const std::string& name) const = 0;
  /// All zero where nothing of that name was sent yet.
  virtual const Tally& tally(const std::string& send) const = 0;

  /// Which of the two limits counts here.
  virtual nanoseconds allowed(const Limit& limit) const = 0;
};

/// What a scenario is played on: a ring to observe and to act on, and its time. Under a virtual clock all
/// is exact; live, it is polled every few hundredths of a second, and steps may be late.
class Stage : public StageView {
 public:
  struct Failure {
    std::string expected, seen;
  };

  /// Brings the ring up. Time counts from then. @return what was not as expected
  virtual std::optional<Failure> begin() = 0;
  virtual core::Duration now() const = 0;
  /// True: a step whose time has passed is an error. False: it is then done at once.
  virtual bool exact() const = 0;
  /// Lets time go on and polls, until `done` is true or `until` has come. @param what for people who wait
  /// @return what `done` said last
  virtual bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) = 0;
  /// Checks what is expected of every ring, whatever the scenario says. @return the first expectation that was not met
  virtual std::optional<Failure> broken() const = 0;
  /// Unrequested events since the last call, for the report.
  virtual std::vector<std::string> take_notes() { return {}; }

  /// Returns when it has taken effect; a CPU that was reset boots meanwhile. @return why it could not be done
  virtual std::optional<Failure> apply(const Fault& fault) = 0;
  virtual void send(const Send& send) = 0;
  /// @pre this is the soak's world
  virtual void apply(const SoakAction&) {}
  /// Called when all steps are done. @return an expectation of the stage itself that is not met at the end
  virtual std::optional<Failure> end() { return std::nullopt; }
};

}  // namespace limb_ring::scenario
