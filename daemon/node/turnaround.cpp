#include "node/turnaround.h"

#include <algorithm>
#include <vector>

namespace limb_ring::virtual_host {

std::optional<std::string> Turnaround::on_attach(const host::ClientInfo& client) {
  const auto objection = calls_.on_attach(client);
  if (!objection && client.lockstep) late_.insert(client.id);
  return objection;
}

void Turnaround::on_detach(const host::ClientInfo& client) {
  late_.erase(client.id);  // its sends that have not entered the node yet are dropped
  calls_.on_detach(client);
}

/// When sends of the current turn enter the node: one instant for the whole turn, never before an earlier turn's.
core::Time Turnaround::entry() {
  if (std::exchange(turn_, ring_.now()) == ring_.now()) return entry_;
  const auto most = static_cast<std::uint64_t>(cpu_.jitter.count());
  const std::chrono::nanoseconds drawn(most == 0 ? 0 : random_() % (most + 1));
  return entry_ = std::max(entry_, ring_.now() + cpu_.turnaround + drawn);
}

template <class Call>
void Turnaround::later(host::ClientId client, Call call) {
  if (late_.count(client) == 0) return call();
  clock_.call_at(entry(), [this, client, call] {
    if (late_.count(client) != 0) call();
  });
}

void Turnaround::on_send(host::ClientId client, const client::SendRequest& request) {
  const std::vector<std::uint8_t> data(request.data.begin(), request.data.end());
  later(client, [this, client, request, data] {
    client::SendRequest own = request;
    own.data = {data.data(), data.size()};
    calls_.on_send(client, own);
  });
}

void Turnaround::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  later(client, [this, client, request] { calls_.on_interrupt(client, request); });
}

void Turnaround::on_pull(host::ClientId client, const client::PullRequest& request) {
  later(client, [this, client, request] { calls_.on_pull(client, request); });
}

}  // namespace limb_ring::virtual_host
