#include "node/client_calls.h"

#include <spdlog/spdlog.h>

#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "limb_ring/payload/sensor_reading.h"
#include "node/observers.h"
#include "node/requests.h"
#include "node/session.h"

namespace limb_ring::runtime {

std::optional<std::string> ClientCalls::on_attach(const host::ClientInfo& client) {
  return client.role == Role::cpu ? to_.cpu.attach(client) : std::nullopt;
}

void ClientCalls::on_detach(const host::ClientInfo& client) {
  to_.driver.controller().apply(core::input::Cancel{SendOwner::of(client.id).to_core()}, to_.driver.now());
  to_.observers.remove(client.id);
  to_.packet_observers.remove(client.id);
  to_.promise_observers.remove(client.id);
  if (client.role == Role::cpu) to_.cpu.detach(client);
  to_.driver.pump();
}

// One truth for the node's status, its beacons and whoever reads the joint states, whichever of the two the CPU uses.
void ClientCalls::hear(const client::SendRequest& request) {
  using payload::PacketType;
  if (request.channel != payload::kJointChannel) return;
  const payload::ByteView data{request.data.data, request.data.size};
  if (payload::is_type(data, PacketType::joint_state)) {
    const auto state = payload::decode_joint_state(data);
    if (state) to_.cpu.stop_latched(state->mode.stopped);
    to_.cpu.watch().sent(state, to_.driver.now());
  } else if (payload::is_type(data, PacketType::imu) || payload::is_type(data, PacketType::force)) {
    to_.cpu.watch().sent(payload::decode_sensor_reading(data), request.destination, to_.driver.now());
  }
}

namespace {

/// Rejected, not kept waiting: who sends as the last one ends must neither stand still nor spin.
Result discarded(std::uint32_t token) {
  Result result;
  result.token = token;
  result.why = Reason::no_way_out;
  result.reason = "the CPU is mute, a fault on purpose";
  return result;
}

}  // namespace

void ClientCalls::on_send(host::ClientId client, const client::SendRequest& request) {
  if (is_cpu(client) && to_.cpu.send_gate().discards()) return to_.host.result(client, discarded(request.token));
  if (is_cpu(client)) hear(request);
  core::SendRequest send;
  send.owner = SendOwner::of(client).to_core();
  send.token = request.token;
  send.destination = wire::NodeId{request.destination};
  send.priority = wire::Priority{request.priority};
  send.channel = wire::ChannelId{request.channel};
  send.data = request.data;
  to_.driver.controller().apply(core::input::Send{send}, to_.driver.now());
  to_.driver.pump_soon();
}

void ClientCalls::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  if (is_cpu(client) && to_.cpu.send_gate().discards()) return to_.host.result(client, discarded(request.token));
  const bool to_all = request.destination == wire::kBroadcast;
  if (to_all && !request.force && config::ring_has_reset_on(to_.ring, request.factor)) {
    Result result;
    result.token = request.token;
    result.why = Reason::needs_force;
    result.reason = "factor " + std::to_string(request.factor) + " is wired to reset: " + sentence(result.why);
    return to_.host.result(client, result);
  }
  const core::InterruptRequest interrupt{SendOwner::of(client).to_core(), request.token,
                                         wire::NodeId{request.destination}, wire::Factor{request.factor}};
  to_.driver.pump_around(
      [&](core::Time now) { to_.driver.controller().apply(core::input::Interrupt{interrupt}, now); });
}

void ClientCalls::on_pull(host::ClientId client, const client::PullRequest& request) {
  to_.driver.pump_around([&](core::Time now) {
    to_.driver.controller().apply(core::input::Pull{SendOwner::of(client).to_core(), request.token, request.input},
                                  now);
  });
}

void ClientCalls::on_request(host::ClientId client, const client::JsonRequest& request) {
  to_.requests.handle(std::string(request.json), is_cpu(client),
                      [this, client, token = request.token](const nlohmann::json& answer) {
                        to_.host.reply(client, token, text_of(answer));
                      });
}

bool ClientCalls::changes_something(const client::JsonRequest& request) const {
  return Requests::changes_something(std::string(request.json));
}

void ClientCalls::on_observe(host::ClientId client, const client::ObserveRequest& request) {
  try {
    const ObserveFilter filter = read_observe_filter(to_.ring, std::string(request.json));
    to_.promise_observers.set(client, filter.promises);  // first: it may fail, and nothing is changed then
    to_.observers.set(client, filter.kinds);
    to_.packet_observers.set(client, filter.packets);
  } catch (const std::exception& error) {
    to_.host.observed(client, text_of({{"error", error.what()}}));
  }
}

void ClientCalls::on_shortage(const std::string& why) {
  spdlog::warn("no more tools or CPUs can connect: {} (ulimit -n); trying again", why);
}

void ClientCalls::on_alive(host::ClientId client) {
  if (is_cpu(client)) to_.cpu.spoke();
}

void ClientCalls::on_credit(host::ClientId) { to_.cpu.hand_over(); }

}  // namespace limb_ring::runtime
