// What only the world of `ring_sim soak` has, as it stands in a scenario.
#include "sim/scenario_sections.h"

namespace limb_ring::scenario {

using config::Entry;
using SoakKind = SoakAction::Kind;

namespace {

constexpr const char* kLine = "a line such as node1 -> node2";
constexpr config::IntegerRange kNth{1, 1000}, kByte{0, 543}, kBits{1, 255};

/// `A -> B`, as of any fault.
void set_line(const Entry& entry, SoakAction& action, const fault::RingNodes& nodes) {
  try {
    const fault::Fault line = fault::from_words("heal " + entry.text(kLine), nodes);
    action.node = line.nodes[0];
    action.second_line = line.second_line;
  } catch (const fault::ParseError& error) {
    entry.refuse(error.problem, error.allowed);
  }
}

/// `{cut: A -> B}` or `{mend: A -> B}`
SoakAction read_wire(const Entry& entry, SoakKind cut, SoakKind mend, const fault::RingNodes& nodes) {
  config::check_names(entry, {"cut", "mend"}, {});
  const auto members = entry.members("{cut: A -> B} or {mend: A -> B}");
  if (members.size() != 1) entry.refuse("it is not one thing", "cut or mend");
  SoakAction action;
  action.kind = members[0].name == "cut" ? cut : mend;
  set_line(members[0].value, action, nodes);
  if (cut == SoakKind::cut_cable && action.second_line)
    members[0].value.refuse("is named against ring order", "its two nodes in ring order");
  return action;
}

/// `{lost: A -> B, nth: N}` or `{damaged: A -> B, nth: N, byte: I, bits: B}`
SoakAction read_slice(const Entry& entry, const fault::RingNodes& nodes) {
  const auto lost = entry.find("lost"), damaged = entry.find("damaged");
  if (lost.has_value() == damaged.has_value()) entry.refuse("it is not one thing", "lost or damaged");
  config::check_names(
      entry,
      lost ? std::vector<std::string>{"lost", "nth"} : std::vector<std::string>{"damaged", "nth", "byte", "bits"}, {});
  SoakAction action;
  action.kind = lost ? SoakKind::lose_slice : SoakKind::damage_slice;
  set_line(lost ? *lost : *damaged, action, nodes);
  if (const auto nth = entry.find("nth")) action.nth = static_cast<unsigned>(read_integer(*nth, kNth));
  if (const auto byte = entry.find("byte")) action.byte = static_cast<unsigned>(read_integer(*byte, kByte));
  if (const auto bits = entry.find("bits")) action.bits = static_cast<std::uint8_t>(read_integer(*bits, kBits));
  return action;
}

}  // namespace

std::vector<std::string> soak_words() { return {"wire", "cable", "slice", "cancel"}; }

std::optional<SoakAction> read_soak_action(const config::Member& action, const fault::RingNodes& nodes) {
  if (action.name == "wire") return read_wire(action.value, SoakKind::cut_wire, SoakKind::mend_wire, nodes);
  if (action.name == "cable") return read_wire(action.value, SoakKind::cut_cable, SoakKind::mend_cable, nodes);
  if (action.name == "slice") return read_slice(action.value, nodes);
  if (action.name != "cancel") return std::nullopt;
  SoakAction cancel;
  cancel.kind = SoakKind::cancel;
  cancel.node = read_place(action.value);
  return cancel;
}

}  // namespace limb_ring::scenario
