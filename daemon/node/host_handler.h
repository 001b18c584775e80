#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "client/host_message.h"
#include "limb_ring/host_port.h"

namespace limb_ring::host {

using ClientId = std::uint32_t;  ///< never used twice by one server

/// One client of a host port, as it has introduced itself.
struct ClientInfo {
  ClientId id = 0;
  Role role = Role::tool;
  pid_t pid = 0;  ///< as the kernel says (SO_PEERCRED), not the client
  bool restarted_by_owner = false;
  bool results_may_wait = false;
  bool lockstep = false;                      ///< it acts in its turns alone
  std::chrono::milliseconds alive_period{0};  ///< 0: no promise
};

/// What the clients of a host port want of the daemon. Called from the event loop only, never
/// from inside a call to HostServer; calling HostServer from inside is fine. Arguments are within
/// their ranges already; what a request points to is valid during the call only.
class HostHandler {
 public:
  virtual ~HostHandler() = default;

  /// A CPU in lockstep has greeted. It is attached when its boot time is over on the ring's clock.
  virtual void on_greeted(pid_t /*pid*/) {}
  /// The same CPU is gone, or refused, and was not attached.
  virtual void on_left(pid_t /*pid*/) {}
  /// A client has greeted. @return a reason to refuse it
  virtual std::optional<std::string> on_attach(const ClientInfo& client) = 0;
  /// A client that was attached is gone. Results for it may still be given; they go nowhere.
  virtual void on_detach(const ClientInfo& client) = 0;
  virtual void on_send(ClientId client, const client::SendRequest& request) = 0;
  virtual void on_interrupt(ClientId client, const client::InterruptRequest& request) = 0;
  virtual void on_pull(ClientId client, const client::PullRequest& request) = 0;
  virtual void on_request(ClientId client, const client::JsonRequest& request) = 0;
  /// Whether such a request changes something, rather than only asking.
  virtual bool changes_something(const client::JsonRequest&) const { return false; }
  virtual void on_observe(ClientId client, const client::ObserveRequest& request) = 0;
  /// A client cannot be let in, for want of descriptors most likely. Called once until one has been.
  virtual void on_shortage(const std::string& /*why*/) {}
  /// A sign of life: called for every message of a client, before the message's own call.
  virtual void on_alive(ClientId client) = 0;
  /// The CPU can take packets where it could not: HostServer::cpu_can_take() has become true.
  virtual void on_credit(ClientId client) = 0;
};

}  // namespace limb_ring::host
