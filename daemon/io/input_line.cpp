#include "io/input_line.h"

#include "io/admission.h"

namespace limb_ring::link {

void InputReport::turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse,
                              InputHandler& handler) {
  if (refuse.refusal == Refusal::busy) {
    ++counters.refused;
    return;
  }
  count(refuse.refusal, counters);
  const std::string why = why_unfit(connect, refuse);
  refusals.note(connect.sender, why);
  unknown_peer(who + ": " + why);
  if (report_once(last_unknown_peer)) handler.on_unknown_peer(last_unknown_peer);
}

void InputReport::came_up(std::uint8_t from) {
  ++counters.connects;
  refusals.forget(from);
  report_once.forget();
}

}  // namespace limb_ring::link
