#include "study/soak_world.h"

#include <algorithm>

#include "sim/virtual_line_faults.h"

namespace limb_ring::study {

using wire::NodeId;
using namespace std::chrono_literals;

SoakWorld::SoakWorld(FoldingRings folding, WorldKind kind, Draws& draws, Draws& wide)
    : is_wide(kind != WorldKind::usual),
      in_parts(kind == WorldKind::parts || kind == WorldKind::storms),
      storms(kind == WorldKind::storms) {
  choose_mix(folding, draws);
  if (in_parts) choose_parts(folding, wide);
  choose_nodes(wide);
  takes_time_to_connect = is_wide && wide.below(2) == 0;
}

void SoakWorld::choose_mix(FoldingRings folding, Draws& draws) {
  nodes = draws.once_in(3) ? 2 + draws.below(15) : 16;
  // Rings of two fold back, too, and `ring_sim explore` has them; here the histories of their seeds would change.
  if (folding == FoldingRings::all && nodes < 3) nodes = 3;
  paced = draws.once_in(2);
  const unsigned levels[] = {0, 2000, 200, 33};
  drop = levels[draws.below(4)];
  damage = levels[draws.below(4)];
  trouble = levels[draws.below(4)];
  const bool drawn = nodes > 2 && draws.once_in(3);
  folds_back = drawn || folding == FoldingRings::all;
  doubles = draws.once_in(2) && !folds_back;  // a fold may bring the copy behind the source's next packet
}

// Lines do not double packets there: a part that has not met the copy promises nothing. (protocol.md section 4.10)
void SoakWorld::choose_parts(FoldingRings folding, Draws& wide) {
  if (nodes < 3 || wide.below(5) != 0) nodes = 3 + wide.below(7);  // parts of a few nodes, and many seeds
  folds_back = folding == FoldingRings::all || wide.below(2) == 0;
  const unsigned levels[] = {400, 100, 33};
  trouble = levels[wide.below(3)];
  doubles = false;
  if (!storms) return;
  nodes = 3 + wide.below(4);
  folds_back = true;
  const unsigned losses[] = {0, 0, 8, 3};
  lost_words = losses[wide.below(4)];
}

void SoakWorld::choose_nodes(Draws& wide) {
  if (is_wide && !in_parts && wide.below(60) == 0) grow(wide);
  std::vector<NodeId> ids;
  for (unsigned id = 0; id < (is_wide ? 255 : nodes); ++id) ids.push_back(static_cast<NodeId>(id));
  for (std::size_t i = ids.size(); is_wide && i-- > 1;)
    std::swap(ids[i], ids[wide.below(static_cast<unsigned>(i) + 1)]);
  order.assign(ids.begin(), ids.begin() + nodes);
  for (unsigned i = 0; is_wide && i < nodes; ++i) {
    delays.push_back(1ns * (200 + wide.below(2000)));
    slownesses.push_back(wide.below(3) == 0 ? 1 + wide.below(4) : 1);
  }
}

// Its lines lose and damage as much in a lap as those of a ring of 16: if each of 200 lines lost one slice in 33, no
// packet would come round, and the nodes would never join.
void SoakWorld::grow(Draws& wide) {
  nodes = 17 + wide.below(238);
  drop = drop * nodes / 16;
  damage = damage * nodes / 16;
}

void SoakWorld::adjust(core::Settings& settings) const {
  sim::set_short_times(settings, paced, folds_back);
  settings.several_hosts = in_parts;
  if (is_wide) differ(settings);
}

void SoakWorld::differ(core::Settings& s) const {
  const std::size_t place = core::place_of(order, s.id);
  if (place == nodes) return;
  core::Duration all{0};
  for (const core::Duration delay : delays) all += delay;
  const unsigned slowest = *std::max_element(slownesses.begin(), slownesses.end());
  s.lap =
      nodes * s.byte_time_out * slowest * static_cast<int>(wire::kMaxDataPacketSize + wire::kInterruptPacketSize) + all;
  s.all_delays = all;
  s.byte_time_in = s.byte_time_out * slownesses[(place + nodes - 1) % nodes];
  s.byte_time_out = s.byte_time_out * slownesses[place];
  s.relay_delay = delays[place];
  s.beacon *= 1 + nodes / 16;
}

std::string SoakWorld::describe() const {
  const auto rate = [](const char* what, unsigned times) {
    return times == 0 ? "" : std::string(", ") + what + " once in " + std::to_string(times);
  };
  return std::to_string(nodes) + " nodes, lines " + (paced ? "of 1 Gbit/s" : "without a rate") +
         (folds_back ? ", folding back" : "") +
         (storms     ? ", in storms"
          : in_parts ? ", on hosts that lose each other"
          : is_wide  ? ", a wide world"
                     : "") +
         rate("a slice lost", drop) + rate("a fold word lost", lost_words) + rate("damaged", damage) +
         rate("a fault in a step", trouble);
}

using scenario::SoakAction;

const SoakAction* slice_hit(const RecordedStep& step) {
  const auto* action = std::get_if<SoakAction>(&step.what);
  if (action == nullptr) return nullptr;
  return action->kind == SoakAction::Kind::lose_slice || action->kind == SoakAction::Kind::damage_slice ? action
                                                                                                        : nullptr;
}

void SoakHistory::add(fault::Name name, NodeId node) {
  fault::Fault fault;
  fault.name = name;
  fault.nodes = {node};
  add(fault);
}

void SoakHistory::add(SoakAction::Kind kind, NodeId node, bool second_line) {
  SoakAction action;
  action.kind = kind;
  action.node = node;
  action.second_line = second_line;
  add(action);
}

void SoakHistory::count_slice(NodeId node, core::Line line) {
  if (!kept_) return;
  auto& nodes = leaving_[static_cast<std::size_t>(line)];
  if (nodes.empty()) nodes.resize(ring_.size());
  AtInstant& leaving = nodes[node];
  if (leaving.at != ring_.now()) leaving = {ring_.now(), 0};
  ++leaving.slices;
}

void SoakHistory::add_slice(SoakAction::Kind kind, NodeId node, core::Line line, std::size_t byte, std::uint8_t bits) {
  if (!kept_) return;
  SoakAction action;
  action.kind = kind;
  action.node = node;
  action.second_line = line == core::Line::second;
  action.nth = leaving_[static_cast<std::size_t>(line)][node].slices;
  action.byte = static_cast<unsigned>(byte);
  action.bits = bits;
  add(action);
}

}  // namespace limb_ring::study
