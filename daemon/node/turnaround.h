#pragma once

#include <random>
#include <set>

#include "client/host_message.h"
#include "config/ring_config.h"
#include "node/host_handler.h"
#include "node/virtual_clock.h"

namespace limb_ring::virtual_host {

/// What a CPU in lockstep sends enters its node later than its turn began, as the computing of a real one takes time.
/// All else passes at once.
class Turnaround final : public host::HostHandler {
 public:
  /// All but `cpu` outlive this. @param clock of the node
  Turnaround(host::HostHandler& calls, sim::VirtualRing& ring, VirtualClock& clock, const config::CpuConfig& cpu,
             std::uint64_t seed)
      : calls_(calls), ring_(ring), clock_(clock), cpu_(cpu), random_(seed) {}

  void on_greeted(pid_t pid) override { calls_.on_greeted(pid); }
  void on_left(pid_t pid) override { calls_.on_left(pid); }
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo& client) override;
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override {
    calls_.on_request(client, request);
  }
  bool changes_something(const client::JsonRequest& request) const override {
    return calls_.changes_something(request);
  }
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override {
    calls_.on_observe(client, request);
  }
  void on_shortage(const std::string& why) override { calls_.on_shortage(why); }
  void on_alive(host::ClientId client) override { calls_.on_alive(client); }
  void on_credit(host::ClientId client) override { calls_.on_credit(client); }

 private:
  core::Time entry();
  template <class Call>
  void later(host::ClientId client, Call call);

  host::HostHandler& calls_;
  sim::VirtualRing& ring_;
  VirtualClock& clock_;
  config::CpuConfig cpu_;
  std::mt19937_64 random_;
  std::set<host::ClientId> late_;  ///< CPUs in lockstep that are attached
  core::Time turn_{core::Duration{-1}};
  core::Time entry_{};
};

}  // namespace limb_ring::virtual_host
