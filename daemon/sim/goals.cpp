#include "sim/goals.h"

#include <algorithm>

namespace limb_ring::sim {

namespace seen {

using core::NodeState;

/// What happens, as goals speak of it.
enum class Kind : std::uint8_t {
  killed,
  frozen,
  gone,  ///< killed or frozen; told after that
  started,
  thawed,
  cut,
  healed,
  replaced,  ///< a node has noticed that its line out is gone, or leads elsewhere
  reset,
  cancelled,
  parted,
  regrouped,
  state,
  ended,
  pin,
  packet,  ///< the last bytes of one come in
  retry,   ///< the same, of a further try; told after `packet`
  word,
  input,          ///< a line into a node comes up, or is lost
  turned_back,    ///< a node sends on the second line from now on
  turned_forward  ///< on the first
};
constexpr std::size_t kKinds = static_cast<std::size_t>(Kind::turned_forward) + 1;

/// One thing that happens. Only what its kind speaks of is set.
struct Moment {
  Kind kind;
  NodeId node{0};
  Time at{};
  Line line = Line::first;
  wire::Code code{};
  NodeId source{0}, destination{0};
  const core::SendEnded* end = nullptr;
  NodeState before = NodeState::starting, after = NodeState::starting;
  wire::FoldWord word{};
};

/// What has been seen of a node.
struct OfNode {
  OfNode() { last.fill(core::kNever); }

  std::array<Time, kKinds> last;  ///< kNever: it has not happened
  bool is_there = false;          ///< the ring has a node of that id
  NodeState state = NodeState::starting;
  unsigned starts = 0;
  std::size_t open = 0;              ///< sends without a result
  std::array<Time, 2> first_left{};  ///< of its DATP, and of its INTP: the first try, or what it is
  std::array<bool, 2> cut{};         ///< the wire out of it, by line
  bool turned_back = false;          ///< it sends on the second line
  bool apart = false;                ///< in that part of a ring that has parted
  wire::Code coming{};               ///< the DATP that comes in
  NodeId coming_from{0};
};

/// What has been seen before a moment.
class Past {
 public:
  explicit Past(VirtualRing& of) : ring(of), nodes(of.size()) {
    for (const NodeId node : of.order()) nodes[node].is_there = true;
  }
  /// A node of the ring has that id.
  bool is_node(NodeId id) const { return id < nodes.size() && nodes[id].is_there; }

  Duration lap(const Moment& m) const { return ring.settings(m.node).worst_lap(); }
  Duration time_out(const Moment& m) const { return ring.settings(m.node).send_timeout(); }
  Time last(NodeId node, Kind kind) const { return nodes[node].last[static_cast<std::size_t>(kind)]; }
  /// It has happened at that node, at most so long ago.
  bool at(NodeId node, Kind kind, const Moment& m, Duration within) const {
    return last(node, kind) != core::kNever && m.at - last(node, kind) <= within;
  }
  bool here(Kind kind, const Moment& m) const { return at(m.node, kind, m, lap(m)); }
  /// At another node, at an earlier instant, at most a lap ago.
  bool elsewhere(Kind kind, const Moment& m) const {
    return any([&](NodeId node) { return node != m.node && last(node, kind) < m.at && at(node, kind, m, lap(m)); });
  }
  /// Anywhere, at most a lap ago.
  bool lately(Kind kind, const Moment& m) const { return here(kind, m) || elsewhere(kind, m); }
  /// At a neighbour, at most a lap ago.
  bool beside(Kind kind, const Moment& m) const {
    return at(before(m), kind, m, lap(m)) || at(after(m), kind, m, lap(m));
  }
  /// At any node, from that instant on.
  bool since(Kind kind, Time then) const {
    return any([&](NodeId node) { return last(node, kind) != core::kNever && last(node, kind) >= then; });
  }
  /// A living node other than that of the moment shows the state.
  bool shown(NodeState state, const Moment& m) const {
    return any([&](NodeId node) { return node != m.node && ring.alive(node) && nodes[node].state == state; });
  }
  /// One has started, and has not joined yet.
  bool one_joins(const Moment& m) const { return shown(NodeState::starting, m) || shown(NodeState::joining, m); }
  NodeState state(const Moment& m) const { return nodes[m.node].state; }
  bool joins(const Moment& m) const {
    return state(m) == NodeState::joining || (state(m) == NodeState::starting && nodes[m.node].starts != 0);
  }
  std::size_t living() const {
    return count([&](NodeId node) { return ring.alive(node); });
  }
  std::size_t living_in(bool apart) const {
    return count([&](NodeId node) { return ring.alive(node) && nodes[node].apart == apart; });
  }
  /// A part of the ring is closed without the other.
  bool closed(bool apart) const {
    return any([&](NodeId node) {
      const NodeState state = nodes[node].state;
      const bool says_so = state == NodeState::up || state == NodeState::alone || state == NodeState::folded;
      return says_so && ring.alive(node) && nodes[node].apart == apart && since_parting(node);
    });
  }
  bool owes(const Moment& m) const { return nodes[m.node].open != 0; }
  bool one_owes() const {
    return any([&](NodeId node) { return ring.alive(node) && nodes[node].open != 0; });
  }
  std::size_t breaks() const {
    return count([&](NodeId node) { return nodes[node].cut[0]; });
  }
  std::size_t turned_back() const {
    return count([&](NodeId node) { return ring.alive(node) && nodes[node].turned_back; });
  }
  NodeId after(const Moment& m) const { return core::node_after(ring.order(), m.node, 1); }
  NodeId before(const Moment& m) const { return core::node_after(ring.order(), m.node, ring.order().size() - 1); }
  /// The packet is for its node, which has done so since the first try left its source.
  bool receiver_has(Kind kind, const Moment& m) const {
    if (m.destination != m.node && (m.destination != wire::kBroadcast || m.source == m.node)) return false;
    return last(m.node, kind) != core::kNever && last(m.node, kind) > first_left(m);
  }
  bool receiver_has_started(const Moment& end) const {
    const NodeId to = end.end->destination;
    if (!is_node(to) || last(to, Kind::started) == core::kNever) return false;
    return last(to, Kind::started) > nodes[end.node].first_left[end.end->interrupt ? 1 : 0];
  }
  bool of_a_former_life(const Moment& m) const {
    return m.code.incarnation != wire::incarnation_of(ring.controller(m.source).membership().boot());
  }
  bool on_second(const Moment& m) const { return m.source != m.node && ring.input_line(m.node) == Line::second; }
  bool is_cut(NodeId node) const { return nodes[node].cut[0]; }
  /// The other wire of the same cable has broken before.
  bool half_of_a_broken_cable(const Moment& cut) const {
    const bool first = cut.line == Line::first;
    const NodeId other = first ? after(cut) : before(cut);
    return nodes[other].cut[first ? 1 : 0] && last(other, Kind::cut) < cut.at;
  }
  /// The wire out of `of` has broken shortly before, at another instant.
  bool notices_late(NodeId of, const Moment& m) const {
    constexpr Duration kLongest = std::chrono::microseconds(300);  // study::kNoticedWithin
    return is_cut(of) && last(of, Kind::cut) < m.at && at(of, Kind::cut, m, kLongest);
  }
  Time first_left(const Moment& m) const { return nodes[m.source].first_left[m.code.interrupt ? 1 : 0]; }

  VirtualRing& ring;
  std::vector<OfNode> nodes;  ///< by id
  bool has_parted = false;
  Time parted_at{};             ///< or regrouped
  std::optional<NodeId> begun;  ///< of the last `begin` that was heard, until a `last`

 private:
  template <class Says>
  bool any(Says says) const {
    return std::any_of(ring.order().begin(), ring.order().end(), says);
  }
  template <class Says>
  std::size_t count(Says says) const {
    return static_cast<std::size_t>(std::count_if(ring.order().begin(), ring.order().end(), says));
  }
  bool since_parting(NodeId node) const {
    const Time shown = last(node, Kind::state);
    return shown != core::kNever && shown > parted_at;
  }
};

}  // namespace seen

namespace {

using core::Counters;
using core::NodeState;
using core::Outcome;
using seen::Moment;
using seen::Past;
using On = seen::Kind;
using S = Strike;
constexpr NeedsWorld kUsual = NeedsWorld::usual, kParts = NeedsWorld::parts;

/// A goal, and when it is met: at a moment of that kind for which the predicate holds; or a counter of the core.
struct Row {
  Goal goal;
  On on{};
  bool (*holds)(const Past& past, const Moment& now) = nullptr;
  std::uint64_t Counters::*counter = nullptr;
};

bool ends_so(const Moment& m, Outcome outcome) { return m.end->outcome == outcome; }
bool is_down(const Past& p, NodeId node) { return p.is_node(node) && !p.ring.alive(node); }
bool is_broadcast(const Moment& m) { return m.end->destination == wire::kBroadcast; }

using P = const Past&;
using M = const Moment&;

// clang-format off
const Row kRows[] = {
    // ---- nodes that come and go
    {{"starts_in_a_lap", "two nodes start within one lap",
      kUsual, {S::restart, S::restart}}, On::started, [](P p, M m) { return p.elsewhere(On::started, m); }},
    {{"starts_twice", "a node starts twice within the time-out of a try",
      kUsual, {S::restart, S::restart}}, On::started,
      [](P p, M m) { return p.at(m.node, On::started, m, p.time_out(m)); }},
    {{"neighbours_start", "a node and one beside it start within one lap",
      kUsual, {S::restart, S::restart}}, On::started, [](P p, M m) { return p.beside(On::started, m); }},
    {{"fourth_start", "a node has started four times, so a number of its incarnation comes again",
      kUsual, {S::restart, S::restart, S::restart, S::restart}}, On::started,
      [](P p, M m) { return p.nodes[m.node].starts + 1 >= 4; }},
    {{"start_in_an_open_chain", "a node starts while others show an open chain",
      kUsual, {S::cut, S::restart}}, On::started, [](P p, M m) { return p.shown(NodeState::open_chain, m); }},
    {{"start_in_a_fold", "a node starts while the ring is folded",
      kUsual, {S::cut, S::restart}}, On::started, [](P p, M m) { return p.shown(NodeState::folded, m); }},
    {{"start_beside_a_thaw", "a node starts within a lap of another's thaw",
      kUsual, {S::freeze, S::freeze, S::restart}}, On::started, [](P p, M m) { return p.elsewhere(On::thawed, m); }},
    {{"joining_starts_over", "a joining node loses its lines, and starts over",
      kUsual, {S::restart, S::cut}}, On::state,
      [](P, M m) { return m.before == NodeState::joining && m.after == NodeState::starting; }},
    {{"killed_while_joining", "a node is killed before it has joined",
      kUsual, {S::restart, S::kill}}, On::killed, [](P p, M m) { return p.joins(m); }},
    {{"frozen_while_joining", "a node is frozen before it has joined",
      kUsual, {S::restart, S::freeze}}, On::frozen, [](P p, M m) { return p.joins(m); }},
    {{"killed_with_sends", "a node is killed that has sends without a result",
      kUsual, {S::send, S::kill}}, On::killed, [](P p, M m) { return p.owes(m); }},
    {{"frozen_with_sends", "a node is frozen that has sends without a result",
      kUsual, {S::send, S::freeze}}, On::frozen, [](P p, M m) { return p.owes(m); }},
    {{"half_down", "half of the nodes are down",
      kUsual, {S::kill, S::freeze, S::kill, S::kill}}, On::gone,
      [](P p, M) { return 2 * p.living() <= p.ring.order().size(); }},
    {{"one_left", "only one node is left",
      kUsual, {S::kill, S::kill, S::kill, S::kill}}, On::gone, [](P p, M) { return p.living() == 1; }},
    {{"none_left", "no node is left",
      kUsual, {S::kill, S::kill, S::kill, S::kill}}, On::gone, [](P p, M) { return p.living() == 0; }},
    {{"thaw_into_an_open_chain", "a node thaws while others show an open chain",
      kUsual, {S::freeze, S::cut, S::freeze}}, On::thawed, [](P p, M m) { return p.shown(NodeState::open_chain, m); }},
    {{"thaw_after_a_start", "a node thaws, and another has started meanwhile",
      kUsual, {S::freeze, S::restart, S::freeze}}, On::thawed,
      [](P p, M m) { return p.since(On::started, p.last(m.node, On::frozen)); }},
    {{"thaws_in_a_lap", "two nodes thaw within one lap",
      kUsual, {S::freeze, S::freeze, S::mend_all}}, On::thawed,
      [](P p, M m) { return p.elsewhere(On::thawed, m) || p.since(On::thawed, m.at); }},

    // ---- breaks
    {{"breaks_in_a_lap", "two lines break within one lap",
      kUsual, {S::cut, S::cut}}, On::cut, [](P p, M m) { return p.elsewhere(On::cut, m); }},
    {{"two_breaks", "two wires of the first line are broken at once",
      kUsual, {S::cut, S::cut, S::cut}}, On::cut, [](P p, M m) { return m.line == Line::first && p.breaks() >= 1; }},
    {{"three_breaks", "three wires of the first line are broken at once",
      kUsual, {S::cut, S::cut, S::cut, S::cut}}, On::cut,
      [](P p, M m) { return m.line == Line::first && p.breaks() >= 2; }},
    {{"cut_off", "the wires into and out of one node are broken at once",
      kUsual, {S::cut, S::cut}}, On::cut,
      [](P p, M m) { return m.line == Line::first && (p.is_cut(p.before(m)) || p.is_cut(p.after(m))); }},
    {{"break_in_an_open_chain", "a line breaks while nodes show an open chain",
      kUsual, {S::cut, S::cut}}, On::cut, [](P p, M m) { return p.shown(NodeState::open_chain, m); }},
    {{"break_in_a_fold", "a line breaks while the ring is folded",
      kUsual, {S::cut, S::cut}}, On::cut, [](P p, M m) { return p.shown(NodeState::folded, m); }},
    {{"break_while_joining", "a line breaks while a node joins",
      kUsual, {S::restart, S::cut}}, On::cut, [](P p, M m) { return p.one_joins(m); }},
    {{"break_at_a_start", "a line of a node breaks within a lap of its start",
      kUsual, {S::restart, S::cut}}, On::cut,
      [](P p, M m) { return p.here(On::started, m) || p.at(p.after(m), On::started, m, p.lap(m)); }},
    {{"break_beside_the_dead", "a line breaks that leads to a node that is down",
      kUsual, {S::kill, S::cut}}, On::cut, [](P p, M m) { return is_down(p, p.after(m)) || is_down(p, m.node); }},
    {{"break_under_a_retry", "a line breaks within a lap of a retry on its way",
      kUsual, {S::send, S::lose, S::cut}}, On::cut, [](P p, M m) { return p.lately(On::retry, m); }},
    {{"second_line_breaks", "a wire of the second line breaks, and the first line beside it is whole",
      kUsual, {S::cut, S::cut}}, On::cut, [](P p, M m) { return m.line == Line::second && !p.is_cut(p.before(m)); }},
    {{"cable_breaks_by_halves", "the second wire of a cable breaks later than the first",
      kUsual, {S::cut, S::cut, S::cut}}, On::cut, [](P p, M m) { return p.half_of_a_broken_cable(m); }},
    {{"mended_within_a_lap", "a wire breaks and is mended within one lap",
      kUsual, {S::cut, S::mend}}, On::healed, [](P p, M m) { return p.here(On::cut, m); }},
    {{"mended_as_another_breaks", "a wire is mended within a lap of another's break",
      kUsual, {S::cut, S::mend}}, On::healed, [](P p, M m) { return p.elsewhere(On::cut, m); }},
    {{"breaks_again", "a wire breaks again within the time-out of a try after it was mended",
      kUsual, {S::cut, S::mend, S::cut}}, On::cut, [](P p, M m) { return p.at(m.node, On::healed, m, p.time_out(m)); }},
    {{"upstream_end_goes_later",
      "a wire breaks, and its upstream end goes later: it notices late, or a neighbour leaves",
      kUsual, {S::cut, S::send}}, On::replaced, [](P p, M m) { return p.notices_late(m.node, m); }},
    {{"downstream_end_goes_later",
      "a wire breaks, and its downstream end changes later: it notices late, or a neighbour leaves",
      kUsual, {S::cut, S::send}}, On::input,
      [](P p, M m) { return m.line == Line::first && p.notices_late(p.before(m), m); }},

    // ---- folds
    {{"fold_while_joining", "a node turns its output back while another is starting or joining",
      kUsual, {S::restart, S::cut}}, On::turned_back, [](P p, M m) { return p.one_joins(m); }},
    {{"fold_at_a_start", "a node turns its output back within a lap of another's start",
      kUsual, {S::cut, S::restart}}, On::turned_back, [](P p, M m) { return p.elsewhere(On::started, m); }},
    {{"folds_in_a_lap", "two nodes turn their outputs back within one lap",
      kUsual, {S::cut, S::cut}}, On::turned_back, [](P p, M m) { return p.elsewhere(On::turned_back, m); }},
    {{"two_folds", "two nodes have their outputs turned back at once",
      kUsual, {S::cut, S::cut}}, On::turned_back, [](P p, M) { return p.turned_back() >= 1; }},
    {{"fold_with_sends", "a node turns its output back that has sends without a result",
      kUsual, {S::send, S::cut}}, On::turned_back, [](P p, M m) { return p.owes(m); }},
    {{"fold_under_a_retry", "a node turns its output back within a lap of a retry on its way",
      kUsual, {S::send, S::lose, S::cut}}, On::turned_back, [](P p, M m) { return p.lately(On::retry, m); }},
    {{"folds_again", "a node turns back again within the time-out of a try after it had turned forward",
      kUsual, {S::cut, S::mend, S::cut}}, On::turned_back,
      [](P p, M m) { return p.at(m.node, On::turned_forward, m, p.time_out(m)); }},
    {{"unfolds_as_another_breaks", "a node turns forward within a lap of a break elsewhere",
      kUsual, {S::cut, S::mend, S::cut}}, On::turned_forward, [](P p, M m) { return p.elsewhere(On::cut, m); }},
    {{"unfolds_with_sends", "a node turns forward that has sends without a result",
      kUsual, {S::cut, S::send, S::mend}}, On::turned_forward, [](P p, M m) { return p.owes(m); }},
    {{"fold_node_killed", "a node is killed while its output is turned back",
      kUsual, {S::cut, S::kill}}, On::killed, [](P p, M m) { return p.nodes[m.node].turned_back; }},
    {{"fold_node_frozen", "a node is frozen while its output is turned back",
      kUsual, {S::cut, S::freeze}}, On::frozen, [](P p, M m) { return p.nodes[m.node].turned_back; }},
    {{"second_line_lost_in_a_fold", "the second line breaks, too, and a node tells the others so",
      kUsual, {S::cut, S::cut}}, On::word, [](P, M m) { return m.word.kind == wire::FoldWordKind::lost; }},
    {{"another_fold_begins", "a node hears of a fold at another place before the one it knew of has ended",
      kUsual, {S::cut, S::mend, S::cut}}, On::word,
      [](P p, M m) { return m.word.kind == wire::FoldWordKind::begin && p.begun && *p.begun != m.word.node; }},
    {{"deaf_beside_a_start", "a node says that it hears nothing, within a lap of a start",
      kUsual, {S::restart, S::cut}}, On::word,
      [](P p, M m) { return m.word.kind == wire::FoldWordKind::deaf && p.lately(On::started, m); }},
    {{"fold_ends_as_another_breaks", "the last word of a fold comes in within a lap of a break",
      kUsual, {S::cut, S::mend, S::cut}}, On::word,
      [](P p, M m) { return m.word.kind == wire::FoldWordKind::last && p.elsewhere(On::cut, m); }},
    {{"home_on_the_second_line", "an own packet comes home on the second line",
      kUsual, {S::cut, S::send}}, On::packet,
      [](P p, M m) { return m.source == m.node && p.ring.input_line(m.node) == Line::second; }},
    {{"interrupt_on_the_second_line", "an INTP comes in on the second line",
      kUsual, {S::cut, S::interrupt}}, On::packet, [](P p, M m) { return m.code.interrupt && p.on_second(m); }},
    {{"retry_on_the_second_line", "a retry comes in on the second line, and its first try left before the fold",
      kUsual, {S::send, S::lose, S::cut}}, On::retry,
      [](P p, M m) { return p.on_second(m) && p.since(On::turned_back, p.first_left(m)); }},

    // ---- retries, and packets that outlive something
    {{"retry_meets_a_restarted_receiver", "a retry comes to its receiver, which has started since the first try left",
      kUsual, {S::send, S::lose, S::restart}}, On::retry, [](P p, M m) { return p.receiver_has(On::started, m); }},
    {{"retry_meets_a_thawed_receiver", "a retry comes to its receiver, which has thawed since the first try left",
      kUsual, {S::send, S::lose, S::freeze, S::freeze}}, On::retry,
      [](P p, M m) { return p.receiver_has(On::thawed, m); }},
    {{"retry_meets_a_joining_receiver", "a retry comes to its receiver, which is joining",
      kUsual, {S::send, S::lose, S::restart}}, On::retry,
      [](P p, M m) { return m.destination == m.node && p.state(m) == NodeState::joining; }},
    {{"retry_meets_a_reset_cpu", "a retry comes to its receiver, whose CPU was reset since the first try left",
      kUsual, {S::send, S::lose, S::reset}}, On::retry, [](P p, M m) { return p.receiver_has(On::reset, m); }},
    {{"retry_after_regrouping", "a retry comes to its receiver, and hosts have regrouped since the first try left",
      kParts, {S::host, S::send, S::host}}, On::retry,
      [](P p, M m) { return m.destination == m.node && !p.has_parted && p.parted_at > p.first_left(m); }},
    {{"last_try", "the last try of a packet comes in somewhere",
      kUsual, {S::send, S::lose, S::lose}}, On::retry, [](P, M m) { return m.code.attempt == wire::kTries - 1; }},
    {{"packet_of_the_dead", "a packet comes in whose source is down",
      kUsual, {S::send, S::kill}}, On::packet, [](P p, M m) { return is_down(p, m.source); }},
    {{"packet_for_the_dead", "a packet comes in whose receiver is down",
      kUsual, {S::kill, S::send}}, On::packet, [](P p, M m) { return is_down(p, m.destination); }},
    {{"packet_of_a_former_life", "a packet comes in of an earlier incarnation of its source",
      kUsual, {S::send, S::restart}}, On::packet, [](P p, M m) { return p.of_a_former_life(m); }},

    // ---- how sends end
    {{"delivered_at_the_last_try", "a send is delivered at its last try",
      kUsual, {S::send, S::lose}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::delivered) && m.end->tries == wire::kTries; }},
    {{"lost_after_all_tries", "a send is lost after all tries",
      kUsual, {S::lose, S::send}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::lost) && m.end->tries == wire::kTries; }},
    {{"lost_interrupt", "an interrupt is lost",
      kUsual, {S::lose, S::interrupt}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::lost) && m.end->interrupt; }},
    {{"unconfirmed_in_flight", "a send that is out ends unconfirmed, since a break is known",
      kUsual, {S::send, S::cut}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::unconfirmed) && m.end->tries != 0; }},
    {{"cancelled_in_flight", "a send that is out is cancelled",
      kUsual, {S::send, S::cancel}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::cancelled) && m.end->tries != 0; }},
    {{"broadcast_tried_again", "a broadcast is delivered at a further try",
      kUsual, {S::send, S::lose}}, On::ended,
      [](P, M m) { return ends_so(m, Outcome::delivered) && is_broadcast(m) && m.end->tries > 1; }},
    {{"broadcast_refused", "a broadcast ends refused",
      kUsual, {S::hang, S::send}}, On::ended, [](P, M m) { return ends_so(m, Outcome::refused) && is_broadcast(m); }},
    {{"interrupt_refused", "an interrupt ends refused",
      kUsual, {S::interrupt}}, On::ended, [](P, M m) { return ends_so(m, Outcome::refused) && m.end->interrupt; }},
    {{"no_such_node", "a send goes round, and no node takes it",
      kUsual, {S::kill, S::send}}, On::ended, [](P, M m) { return ends_so(m, Outcome::no_such_node); }},
    {{"rejected_while_joining", "a CPU asks for a send while its node is not in the ring",
      kUsual, {S::restart, S::send}}, On::ended, [](P, M m) { return m.end->reject == core::Reject::not_in_ring; }},
    {{"rejected_queue_full", "a CPU asks for a send while the queue is full",
      kUsual, {S::cut, S::send, S::send, S::send}}, On::ended,
      [](P, M m) { return m.end->reject == core::Reject::queue_full; }},
    {{"delivered_to_the_dead", "a send is delivered, and its receiver is down when its source learns that",
      kUsual, {S::send, S::kill}}, On::ended,
      [](P p, M m) { return ends_so(m, Outcome::delivered) && is_down(p, m.end->destination); }},
    {{"delivered_across_a_start", "a send is delivered, and its receiver has started since its first try",
      kUsual, {S::send, S::lose, S::restart}}, On::ended,
      [](P p, M m) { return ends_so(m, Outcome::delivered) && p.receiver_has_started(m); }},
    {{"pins_in_a_lap", "two interrupts pull pins of one node within one lap",
      kUsual, {S::interrupt, S::interrupt}}, On::pin, [](P p, M m) { return p.here(On::pin, m); }},

    // ---- CPUs
    {{"reset_with_sends", "a CPU is reset that has sends without a result",
      kUsual, {S::send, S::reset}}, On::reset, [](P p, M m) { return p.owes(m); }},
    {{"reset_at_a_start", "a CPU is reset within a lap of the start of another node",
      kUsual, {S::restart, S::reset}}, On::reset, [](P p, M m) { return p.elsewhere(On::started, m); }},
    {{"reset_while_joining", "a CPU is reset while its node joins",
      kUsual, {S::restart, S::reset}}, On::reset, [](P p, M m) { return p.joins(m); }},
    {{"reset_in_a_fold", "a CPU is reset while the ring is folded",
      kUsual, {S::cut, S::reset}}, On::reset, [](P p, M m) { return p.state(m) == NodeState::folded; }},
    {{"cancelled_in_an_open_chain", "sends are cancelled in an open chain",
      kUsual, {S::cut, S::cancel}}, On::cancelled,
      [](P p, M m) { return p.state(m) == NodeState::open_chain && p.owes(m); }},

    // ---- hosts
    {{"hosts_part_with_sends", "hosts lose each other while sends have no result",
      kParts, {S::send, S::host}}, On::parted, [](P p, M) { return p.one_owes(); }},
    {{"hosts_part_in_a_fold", "hosts lose each other while the ring is folded",
      kParts, {S::cut, S::host}}, On::parted, [](P p, M m) { return p.shown(NodeState::folded, m); }},
    {{"hosts_part_at_a_break", "hosts lose each other within a lap of a break",
      kParts, {S::cut, S::host}}, On::parted, [](P p, M m) { return p.lately(On::cut, m); }},
    {{"hosts_regroup", "hosts that had lost each other regroup",
      kParts, {S::host, S::host}}, On::regrouped, [](P, M) { return true; }},
    {{"closed_parts_regroup", "two parts regroup that have each closed a ring",
      kParts, {S::host, S::host}}, On::regrouped, [](P p, M) { return p.closed(false) && p.closed(true); }},
    {{"regroup_soon", "hosts regroup within the time-out of a try",
      kParts, {S::host, S::host}}, On::regrouped, [](P p, M m) { return m.at - p.parted_at <= p.time_out(m); }},
    {{"regroup_after_a_start", "hosts regroup, and a node has started while they were apart",
      kParts, {S::host, S::restart, S::host}}, On::regrouped, [](P p, M) { return p.since(On::started, p.parted_at); }},
    {{"regroup_at_a_break", "hosts regroup within a lap of a break",
      kParts, {S::host, S::cut, S::host}}, On::regrouped, [](P p, M m) { return p.lately(On::cut, m); }},
    {{"host_of_one", "a node is alone on its host",
      kParts, {S::host}}, On::state, [](P p, M m) { return p.has_parted && m.after == NodeState::alone; }},

    // ---- what the core counts
    {{"duplicate", "a packet comes again that its receiver had taken",
      kUsual, {S::send, S::lose}}, {}, nullptr, &Counters::duplicates},
    {{"earlier_incarnation", "a packet is refused since its source has begun a later incarnation",
      kUsual, {S::send, S::restart}}, {}, nullptr, &Counters::earlier_incarnation},
    {{"no_buffer", "a packet is refused since no receive buffer is free",
      kUsual, {S::hang, S::send, S::send}}, {}, nullptr, &Counters::refused_no_buffer},
    {{"refused_while_joining", "a packet is refused since its receiver is joining",
      kUsual, {S::send, S::restart}}, {}, nullptr, &Counters::refused_joining},
    {{"stalled", "a packet is aborted since its next slice does not come in time",
      kUsual, {S::send, S::hold}}, {}, nullptr, &Counters::stalled_packets},
    {{"broken_off", "a packet is broken off: its line is lost, or another begins inside it",
      kUsual, {S::send, S::cut}}, {}, nullptr, &Counters::broken_off_packets},
    {{"abort_comes", "an abort of a packet comes in from upstream",
      kUsual, {S::send, S::cut}}, {}, nullptr, &Counters::aborts_received},
    {{"embedded", "an INTP goes inside a DATP",
      kUsual, {S::send, S::interrupt}}, {}, nullptr, &Counters::embedded_interrupts},
    {{"no_output", "a packet is dropped since the output line is gone",
      kUsual, {S::send, S::cut}}, {}, nullptr, &Counters::dropped_no_output},
    {{"unmatched_return", "an own packet comes home that nothing waits for",
      kUsual, {S::send, S::cancel}}, {}, nullptr, &Counters::returns_unmatched},
    {{"damaged_return", "an own packet comes home damaged",
      kUsual, {S::send, S::lose}}, {}, nullptr, &Counters::returns_damaged},
    {{"malformed", "a packet is discarded whose header or trailer is wrong",
      kUsual, {S::send}}, {}, nullptr, &Counters::malformed_packets},
    {{"orphan_by_hop", "a packet is discarded since HOP says that its source is gone",
      kUsual, {S::send, S::kill}}, {}, nullptr, &Counters::orphans_hop},
    {{"orphan_of_the_bypassed", "a packet of a node that was bypassed is discarded",
      kUsual, {S::send, S::kill}}, {}, nullptr, &Counters::orphans_bypassed},
    {{"orphan_cut_off", "a packet is discarded since its source is beyond the break",
      kUsual, {S::send, S::cut}}, {}, nullptr, &Counters::orphans_cut_off},
    {{"flushed", "a received packet is thrown away since the CPU is reset",
      kUsual, {S::hang, S::send, S::reset}}, {}, nullptr, &Counters::flushed_on_reset},
    {{"retry_of_the_unheard", "a retry is not taken: its source was not heard since the own start",
      kUsual, {S::send, S::lose, S::restart}}, {}, nullptr, &Counters::retries_of_unheard_nodes},
    {{"retry_of_the_unaware", "a retry is not taken: its source may not know of the own start",
      kUsual, {S::send, S::lose, S::restart}}, {}, nullptr, &Counters::retries_of_unaware_nodes},
    {{"doubtful_retry", "a retry is not taken: its number was decided too long ago",
      kUsual, {S::send, S::lose, S::cut}}, {}, nullptr, &Counters::doubtful_retries},
    {{"fold_discards", "a slice comes on the second line that nobody is to have",
      kUsual, {S::cut, S::mend}}, {}, nullptr, &Counters::fold_discarded},
    {{"fold_held_dropped", "a slice is dropped while the first line comes back",
      kUsual, {S::cut, S::mend}}, {}, nullptr, &Counters::fold_held_dropped},
};
// clang-format on

constexpr std::size_t kGoals = std::size(kRows);

/// The places of the goals of each kind, so that most moments cost nothing.
using ByKind = std::array<std::vector<std::size_t>, seen::kKinds>;
const ByKind& by_kind() {
  static const ByKind places = [] {
    ByKind all;
    for (std::size_t i = 0; i < kGoals; ++i)
      if (kRows[i].holds) all[static_cast<std::size_t>(kRows[i].on)].push_back(i);
    return all;
  }();
  return places;
}

Moment moment(On kind, NodeId node, Time now) {
  Moment m{kind};
  m.node = node;
  m.at = now;
  return m;
}

bool begins_a_packet(wire::SliceKind kind) {
  return kind == wire::SliceKind::start || kind == wire::SliceKind::whole || kind == wire::SliceKind::interrupt;
}

}  // namespace

const std::vector<Goal>& goals() {
  static const std::vector<Goal> all = [] {
    std::vector<Goal> goals;
    for (const Row& row : kRows) goals.push_back(row.goal);
    return goals;
  }();
  return all;
}

std::optional<std::size_t> goal_named(const std::string& name) {
  for (std::size_t i = 0; i < kGoals; ++i)
    if (name == kRows[i].goal.name) return i;
  return std::nullopt;
}

GoalCounts::GoalCounts(VirtualRing& ring)
    : past_(std::make_unique<Past>(ring)), met_(kGoals, 0), of_the_gone_(kGoals, 0) {
  ring.add_observer(*this);
}

GoalCounts::~GoalCounts() = default;

std::vector<std::uint64_t> GoalCounts::met() const {
  std::vector<std::uint64_t> all = met_;
  for (std::size_t i = 0; i < kGoals; ++i) {
    if (!kRows[i].counter) continue;
    all[i] = of_the_gone_[i];
    for (const NodeId node : past_->ring.order())
      if (past_->ring.alive(node)) all[i] += past_->ring.counters(node).*kRows[i].counter;
  }
  return all;
}

void GoalCounts::keep_counters(NodeId node, bool gone) {
  for (std::size_t i = 0; i < kGoals; ++i) {
    if (!kRows[i].counter) continue;
    const std::uint64_t count = past_->ring.counters(node).*kRows[i].counter;
    of_the_gone_[i] += gone ? count : 0 - count;
  }
}

void GoalCounts::see(const Moment& m) {
  for (const std::size_t place : by_kind()[static_cast<std::size_t>(m.kind)])
    if (kRows[place].holds(*past_, m)) ++met_[place];
  past_->nodes[m.node].last[static_cast<std::size_t>(m.kind)] = m.at;
}

void GoalCounts::see(On kind, NodeId node, Time now) { see(moment(kind, node, now)); }

// ---- packets --------------------------------------------------------------------------------

void GoalCounts::asked(NodeId node, const core::SendRequest&, Time) { ++past_->nodes[node].open; }
void GoalCounts::asked(NodeId node, const core::InterruptRequest&, Time) { ++past_->nodes[node].open; }

void GoalCounts::leaves(NodeId node, const wire::Slice& slice, Time now) {
  if (past_->ring.lines().end() - past_->ring.lines().begin() > 1) see_turn(node, now);
  if (!begins_a_packet(slice.kind) || wire::PacketFields{slice.bytes}.source() != node) return;
  const wire::Code code = wire::PacketFields{slice.bytes}.code();
  if (code.attempt == 0) past_->nodes[node].first_left[code.interrupt ? 1 : 0] = now;
}

void GoalCounts::arrives(NodeId node, const wire::Slice& slice, Time now) {
  const wire::PacketFields fields{slice.bytes};
  seen::OfNode& n = past_->nodes[node];
  if (slice.kind == wire::SliceKind::start) {
    n.coming = fields.code();
    n.coming_from = fields.source();
  }
  if (slice.kind == wire::SliceKind::end) see_packet(node, n.coming, n.coming_from, fields.destination(), now);
  if (slice.kind == wire::SliceKind::whole || slice.kind == wire::SliceKind::interrupt)
    see_packet(node, fields.code(), fields.source(), fields.destination(), now);
}

// A header that was damaged may name anybody.
void GoalCounts::see_packet(NodeId node, wire::Code code, NodeId source, NodeId destination, Time now) {
  if (!past_->is_node(source) || (destination != wire::kBroadcast && !past_->is_node(destination))) return;
  Moment m = moment(On::packet, node, now);
  m.code = code;
  m.source = source;
  m.destination = destination;
  see(m);
  if (code.attempt == 0) return;
  m.kind = On::retry;
  see(m);
}

void GoalCounts::see_turn(NodeId node, Time now) {
  seen::OfNode& n = past_->nodes[node];
  const bool turned_back = past_->ring.output_line(node) == Line::second;
  if (turned_back == n.turned_back) return;
  see(turned_back ? On::turned_back : On::turned_forward, node, now);
  n.turned_back = turned_back;
}

void GoalCounts::word_arrives(NodeId node, wire::FoldWord word, Line line, Time now) {
  Moment m = moment(On::word, node, now);
  m.line = line;
  m.word = word;
  see(m);
  if (word.kind == wire::FoldWordKind::begin) past_->begun = word.node;
  if (word.kind == wire::FoldWordKind::last || word.kind == wire::FoldWordKind::lost) past_->begun.reset();
}

// ---- nodes and lines ------------------------------------------------------------------------

void GoalCounts::input_changes(NodeId node, Line line, Time now) {
  Moment m = moment(On::input, node, now);
  m.line = line;
  see(m);
}

void GoalCounts::event(NodeId node, const core::Event& event) {
  const Time now = past_->ring.now();
  seen::OfNode& n = past_->nodes[node];
  if (const auto* state = std::get_if<core::StateChanged>(&event.what)) {
    Moment m = moment(On::state, node, now);
    m.before = state->before;
    m.after = state->after;
    see(m);
    n.state = state->after;
  }
  if (const auto* end = std::get_if<core::SendEnded>(&event.what)) {
    Moment m = moment(On::ended, node, now);
    m.end = end;
    see(m);
    n.open -= std::min<std::size_t>(n.open, 1);
  }
  if (std::holds_alternative<core::PinPulled>(event.what)) see(On::pin, node, now);
}

void GoalCounts::incident(NodeId node, Incident incident, Time now, Line line) {
  seen::OfNode& n = past_->nodes[node];
  switch (incident) {
    case Incident::killed:
    case Incident::frozen:
      see(incident == Incident::killed ? On::killed : On::frozen, node, now);
      see(On::gone, node, now);
      keep_counters(node, true);
      if (incident == Incident::killed) n.open = 0;
      break;
    case Incident::started:
      see(On::started, node, now);
      n.state = NodeState::starting;
      n.open = 0;
      n.turned_back = false;
      ++n.starts;
      break;
    case Incident::thawed:
      see(On::thawed, node, now);
      keep_counters(node, false);
      break;
    case Incident::cut:
      see_cut(node, line, now);
      break;
    case Incident::healed:
      see(On::healed, node, now);
      n.cut[static_cast<std::size_t>(line)] = false;
      break;
    case Incident::output_replaced:
      see(On::replaced, node, now);
      break;
    case Incident::cpu_reset:
      see(On::reset, node, now);
      break;
    case Incident::cancelled:
      see(On::cancelled, node, now);
      break;
    case Incident::lost_slice:
    case Incident::damaged_slice:
    case Incident::late_slice:
    case Incident::resumed:
      break;
  }
}

// Hosts that lose each other are told as cuts, too, which nobody mends.
void GoalCounts::see_cut(NodeId node, Line line, Time now) {
  if (past_->has_parted && past_->parted_at == now) return;
  Moment m = moment(On::cut, node, now);
  m.line = line;
  see(m);
  past_->nodes[node].cut[static_cast<std::size_t>(line)] = true;
}

void GoalCounts::parted(const core::RingOrder& these, Time now) {
  if (these.empty() && !past_->has_parted) return;
  see(these.empty() ? On::regrouped : On::parted, past_->ring.order().front(), now);
  past_->has_parted = !these.empty();
  past_->parted_at = now;
  for (const NodeId node : past_->ring.order()) past_->nodes[node].apart = core::is_in(these, node);
}

}  // namespace limb_ring::sim
