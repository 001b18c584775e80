#pragma once

#include "config/ring_config.h"
#include "node/cpu_socket.h"
#include "node/host_server.h"
#include "node/observers.h"
#include "node/requests.h"

namespace limb_ring::runtime {

/// What the clients of the host port call for: sends go to the network controller, requests to Requests, what
/// concerns the CPU to its socket.
class ClientCalls final : public host::HostHandler {
 public:
  /// All must outlive this; they may be built after it.
  struct Receivers {
    const config::RingConfig& ring;
    NodeDriver& driver;
    host::HostServer& host;
    CpuSocket& cpu;
    Requests& requests;
    Observers& observers;
    PacketObservers& packet_observers;
    PromiseObservers& promise_observers;
  };
  explicit ClientCalls(const Receivers& receivers) : to_(receivers) {}

  void on_greeted(pid_t pid) override { to_.cpu.greeted(pid); }
  void on_left(pid_t pid) override { to_.cpu.left(pid); }
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo& client) override;
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override;
  bool changes_something(const client::JsonRequest& request) const override;
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override;
  void on_shortage(const std::string& why) override;
  void on_alive(host::ClientId client) override;
  void on_credit(host::ClientId client) override;

 private:
  void hear(const client::SendRequest& request);
  bool is_cpu(host::ClientId client) const { return to_.host.cpu() != nullptr && to_.host.cpu()->id == client; }

  Receivers to_;
};

}  // namespace limb_ring::runtime
