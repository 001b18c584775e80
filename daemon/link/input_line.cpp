#include "link/input_line.h"

#include "link/admission.h"

namespace limb_ring::link {

void InputReport::turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse,
                              InputHandler& handler) {
  count(refuse.refusal, counters);
  const std::string why = why_unfit(connect, refuse);
  refusals.note(connect.sender, why);
  unknown_peer(who + ": " + why);
  if (report_once(last_unknown_peer)) handler.on_unknown_peer(last_unknown_peer);
}

}  // namespace limb_ring::link
