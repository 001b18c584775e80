#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Goals: situations in which a ring should be seen. A promise says what must never happen; a goal says what must have
/// happened, else a run has looked at too little. (ours; elsewhere they are called "sometimes" assertions)

/// What can be done to a ring on purpose so that a goal is met: one strike after another, near each other and mostly
/// within a lap.
enum class Strike : std::uint8_t {
  none,
  restart,
  kill,
  freeze,  ///< or thaw, if it is frozen
  cut,
  mend,
  host,  ///< hosts lose each other, or regroup
  lose,  ///< the next packets on a line
  hold,  ///< a line takes nothing for a while
  hang,  ///< a CPU reads nothing, or goes on
  reset,
  cancel,
  send,
  interrupt,
  mend_all  ///< and wait until the ring may be whole again
};

/// The least of the soak's worlds that can meet a goal. (study/soak_world.h)
enum class NeedsWorld : std::uint8_t { usual, wide, parts };

struct Goal {
  const char* name;      ///< as it stands in scenarios
  const char* sentence;  ///< what is seen then
  NeedsWorld world = NeedsWorld::usual;
  std::array<Strike, 4> strikes{};
};

/// The one table of goals.
const std::vector<Goal>& goals();
/// The place of a goal in it; nothing if no goal has that name.
std::optional<std::size_t> goal_named(const std::string& name);

namespace seen {
struct Moment;
class Past;
enum class Kind : std::uint8_t;
}  // namespace seen

/// Counts how often each goal is met on a ring. It changes nothing.
class GoalCounts : public Observer {
 public:
  /// Watches `ring` from now on; must live as long as it runs.
  explicit GoalCounts(VirtualRing& ring);
  ~GoalCounts() override;

  /// How often, by place in goals().
  std::vector<std::uint64_t> met() const;

  void asked(NodeId node, const core::SendRequest& request, Time now) override;
  void asked(NodeId node, const core::InterruptRequest& request, Time now) override;
  void leaves(NodeId node, const wire::Slice& slice, Time now) override;
  void arrives(NodeId node, const wire::Slice& slice, Time now) override;
  void word_arrives(NodeId node, wire::FoldWord word, Line line, Time now) override;
  void input_changes(NodeId node, Line line, Time now) override;
  void event(NodeId node, const core::Event& event) override;
  void incident(NodeId node, Incident incident, Time now, Line line) override;
  void parted(const core::RingOrder& these, Time now) override;

 private:
  void see(const seen::Moment& moment);
  void see(seen::Kind kind, NodeId node, Time now);
  void see_turn(NodeId node, Time now);
  void see_packet(NodeId node, wire::Code code, NodeId source, NodeId destination, Time now);
  void see_cut(NodeId node, Line line, Time now);
  void keep_counters(NodeId node, bool gone);

  std::unique_ptr<seen::Past> past_;
  std::vector<std::uint64_t> met_;
  std::vector<std::uint64_t> of_the_gone_;  ///< counters of nodes that are gone, by place in goals()
};

}  // namespace limb_ring::sim
