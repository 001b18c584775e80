#include "link/input_line.h"

#include "link/admission.h"

namespace limb_ring::link {

void InputReport::turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse,
                              InputHandler& handler) {
  if (refuse.refusal == Refusal::wrong_version) ++counters.other_version;
  if (refuse.refusal == Refusal::other_ring_file) ++counters.other_ring_file;
  if (of_keys(refuse.refusal)) ++counters.other_key;
  const std::string why = why_unfit(connect, refuse);
  refusals.note(connect.sender, why);
  unknown_peer(who + ": " + why);
  if (report_once(last_unknown_peer)) handler.on_unknown_peer(last_unknown_peer);
}

}  // namespace limb_ring::link
