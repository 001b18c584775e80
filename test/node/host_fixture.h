#pragma once

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "limb_ring/ring_directory.h"
#include "node/host_server.h"
#include "support/run_until.h"
#include "support/runtime_folder.h"

namespace limb_ring::test {

using std::chrono::milliseconds;

/// Writes down what it is told; a test may answer through `when_...`.
struct FakeHandler : host::HostHandler {
  struct Call {
    host::ClientId client = 0;
    std::uint32_t token = 0;
    std::uint8_t destination = 0, priority = 0, channel = 0, factor = 0;
    bool force = false;
    std::string data;
  };

  void on_left(pid_t pid) override { left.push_back(pid); }
  std::optional<std::string> on_attach(const host::ClientInfo& client) override {
    attached.push_back(client);
    return objection;
  }
  void on_detach(const host::ClientInfo& client) override { detached.push_back(client); }
  void on_send(host::ClientId client, const client::SendRequest& request) override {
    sends.push_back({client, request.token, request.destination, request.priority, request.channel, 0, false,
                     std::string(request.data.begin(), request.data.end())});
    if (when_sent) when_sent(sends.back());
  }
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override {
    interrupts.push_back({client, request.token, request.destination, 0, 0, request.factor, request.force, ""});
  }
  void on_pull(host::ClientId client, const client::PullRequest& request) override {
    pulls.push_back({client, request.token, 0, 0, 0, request.input, false, ""});
  }
  void on_request(host::ClientId client, const client::JsonRequest& request) override {
    requests.push_back({client, request.token, 0, 0, 0, 0, false, std::string(request.json)});
    if (when_asked) when_asked(requests.back());
  }
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override {
    observers.push_back({client, 0, 0, 0, 0, 0, false, std::string(request.json)});
  }
  void on_alive(host::ClientId) override { ++alive; }
  void on_credit(host::ClientId) override {
    ++credits;
    if (when_credit) when_credit();
  }

  std::optional<std::string> objection;
  std::vector<pid_t> left;
  std::vector<host::ClientInfo> attached, detached;
  std::vector<Call> sends, interrupts, pulls, requests, observers;
  unsigned alive = 0, credits = 0;
  std::function<void(const Call&)> when_sent, when_asked;
  std::function<void()> when_credit;
};

/// A server for node 3, left_knee, of ring r. Clients' blocking calls run in a thread of their
/// own while the event loop turns here, so that server and handler are touched by one thread.
class HostTest : public testing::Test {
 protected:
  HostTest() { serve(); }

  void serve() {
    host::HostOptions options;
    options.directory = make_ring_directory("r");
    options.ring = "r";
    options.id = 3;
    options.name = "left_knee";
    options.max_clients = 4;
    server = std::make_unique<host::HostServer>(io, options, handler);
  }

  void turn() {
    io.restart();
    io.run_one_for(milliseconds{1});
    io.poll();
  }
  /// Runs the loop until `condition` holds; fails the test when it never does.
  void until(const std::function<bool()>& condition) { ASSERT_TRUE(run_until(io, condition)); }
  /// Runs a client's blocking call while the loop turns.
  template <typename Call>
  auto during(Call call) {
    auto done = std::async(std::launch::async, std::move(call));
    while (done.wait_for(milliseconds{0}) != std::future_status::ready) turn();
    return done.get();
  }

  static ConnectOptions options_for(Role role) {
    ConnectOptions options;
    options.ring = "r";
    options.node = "left_knee";
    options.role = role;
    return options;
  }
  HostPort connect(ConnectOptions options) {
    return during([&] { return HostPort::connect(options); });
  }
  HostPort tool() { return connect(options_for(Role::tool)); }
  HostPort cpu() {
    HostPort port = connect(options_for(Role::cpu));
    until([this] { return server->cpu_can_take(); });
    return port;
  }

  void give(const Packet& packet) {
    server->give(
        {packet.source, packet.destination, packet.priority, packet.channel, {packet.data.data(), packet.data.size()}});
  }

  template <typename Kind>
  Kind next(HostPort& port) {
    const auto message = during([&] { return port.receive(kGuard); });
    return std::get<Kind>(message.value());
  }

  RuntimeFolder folder;
  boost::asio::io_context io;
  FakeHandler handler;
  std::unique_ptr<host::HostServer> server;
};

}  // namespace limb_ring::test
