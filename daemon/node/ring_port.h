#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "client/host_message.h"
#include "config/fault_parse.h"
#include "node/host_server.h"
#include "node/node_driver.h"
#include "node/node_folder.h"

namespace limb_ring::virtual_host {

/// What can be asked of a virtual ring as a whole.
struct RingRequests {
  /// Does a fault of nodes; `done` is called once, with why not, or with nothing.
  std::function<void(const fault::Fault&, std::function<void(const std::string& problem)> done)> fault;
  runtime::ClockControl& clock;
};

/// The host port of a virtual ring itself, ALL.host where its nodes have ID.host (ALL: wire::kBroadcast): it answers
/// also while nodes are dead or frozen. It has no CPU and sends nothing; requests alone (docs/reference/requests.md).
class RingPort final : private host::HostHandler {
 public:
  /// @param nodes those of the ring. @throw std::exception if the socket cannot be had
  RingPort(boost::asio::io_context& io, host::HostOptions options, fault::RingNodes nodes, RingRequests requests);

  void close();

 private:
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo&) override {}
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override;
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override;
  void on_alive(host::ClientId) override {}
  void on_credit(host::ClientId) override {}

  nlohmann::json state() const;
  void begin_fault(const nlohmann::json& request, const std::function<void(const nlohmann::json&)>& answer);
  void reject(host::ClientId client, std::uint32_t token);

  fault::RingNodes nodes_;
  RingRequests requests_;
  host::HostServer host_;
  runtime::FolderWatch watch_;
};

}  // namespace limb_ring::virtual_host
