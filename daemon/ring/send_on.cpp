#include "ring/send_on.h"

namespace limb_ring::ask {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

milliseconds until(steady_clock::time_point deadline) {
  return std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
}

}  // namespace

std::optional<std::uint8_t> next_sender(const SentStop& stop, const std::set<std::uint8_t>& senders) {
  const std::vector<KnownStop> stops = wait_until_reached(stop);
  if (stop.of_all) {
    const auto next = next_to_ask(stops, senders);
    return next ? std::optional(next->id) : std::nullopt;
  }
  if (!any_is(stops, StopState::not_reached)) return std::nullopt;
  const auto next = who_reaches(status_rows_here(stop.ring, kRowTimeout), stops[0].node.id);
  return next && senders.count(*next) == 0 ? next : std::nullopt;
}

void send_on(SentStop& stop, std::uint8_t from, steady_clock::time_point deadline, const SendStop& send,
             const NextSender& next) {
  std::set<std::uint8_t> senders{from};
  while (const auto sender = next(stop, senders)) {
    const milliseconds left = until(deadline);
    if (left <= milliseconds(0)) return;
    senders.insert(*sender);
    try {
      const bool delivered = send(*sender, left);
      stop.delivered = delivered && (!stop.of_all || stop.delivered);
    } catch (const std::exception&) {  // it has gone meanwhile: of its node nothing is known then
    }
  }
}

}  // namespace limb_ring::ask
