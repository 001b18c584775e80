#include "judge/passed_over.h"

#include <algorithm>

#include "judge/ledger.h"

namespace limb_ring::sim {

void PassedOver::note(const Sent& waiting, const Sent& leaving, core::Time since) {
  const Promise promise = waiting.queue == leaving.queue ? Promise::in_order : Promise::priority_first;
  noted_.push_back(
      {waiting.source, waiting.token, since, promise, leaving.name() + " left while " + waiting.name() + " waited"});
}

void PassedOver::judge_noted(core::Time now) {
  for (const Noted& noted : noted_) {
    if (noted.since >= now) continue;
    const Sent* sent = ledger_.find(noted.source, noted.token);
    if (sent && !(sent->ended && sent->ended_at <= noted.since)) complain_(noted.promise, noted.what);
  }
  const auto over = [&](const Noted& noted) { return noted.since < now; };
  noted_.erase(std::remove_if(noted_.begin(), noted_.end(), over), noted_.end());
}

}  // namespace limb_ring::sim
