#pragma once

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <csignal>
#include <memory>

#include "io/input.h"
#include "io/output.h"
#include "io/recording_handler.h"
#include "io/udp_socket.h"
#include "support/temporary_folder.h"

namespace limb_ring::link {

using test::TemporaryFolder;

/// One node's two link ends, with an event loop of its own so that it can be frozen alone.
struct RigNode {
  boost::asio::io_context io;
  RecordingInput heard;
  RecordingOutput said;
  std::unique_ptr<Input> input;
  std::unique_ptr<Output> output;
  bool frozen = false;
};

/// Nodes 0 to N-1 in ring order, in one process, stepped until a condition holds.
class LinkRig {
 public:
  using Transport = Endpoint::Transport;
  static constexpr std::uint64_t kRing = 42;

  /// Quicker than by default: silence is waited for.
  static constexpr Timing kQuick{std::chrono::milliseconds(20), std::chrono::milliseconds(60)};

  LinkRig(std::size_t nodes, Transport transport, Timing timing = kQuick) : timing_(timing) {
    std::signal(SIGPIPE, SIG_IGN);  // as ringd does
    for (std::size_t i = 0; i < nodes; ++i) {
      nodes_.push_back(std::make_unique<RigNode>());
      order_.push_back(static_cast<std::uint8_t>(i));
    }
    if (transport == Transport::udp) find_ports(nodes);
    for (std::size_t i = 0; i < nodes && transport != Transport::udp; ++i) {
      const std::string path = folder_.file(std::to_string(i));
      endpoints_.push_back(transport == Transport::shm ? Endpoint::shm(path) : Endpoint::unix_stream(path));
    }
  }

  RigNode& node(std::size_t i) { return *nodes_[i]; }
  const Endpoint& endpoint(std::size_t i) const { return endpoints_[i]; }
  const TemporaryFolder& folder() const { return folder_; }
  std::size_t size() const { return nodes_.size(); }

  InputSettings input_settings(std::size_t i) const {
    InputSettings settings;
    settings.self = {kRing, static_cast<std::uint8_t>(i)};
    settings.endpoint = endpoints_[i];
    settings.order = order_;
    settings.timing = timing_;
    return settings;
  }
  OutputSettings output_settings(std::size_t i) const {
    OutputSettings settings;
    settings.self = {kRing, static_cast<std::uint8_t>(i)};
    settings.timing = timing_;
    for (std::size_t step = 1; step <= size(); ++step) {
      const std::size_t to = (i + step) % size();
      settings.candidates.push_back({static_cast<std::uint8_t>(to), endpoints_[to]});
    }
    return settings;
  }

  void start_input(std::size_t i) {
    node(i).input = std::make_unique<Input>(node(i).io, input_settings(i), node(i).heard);
  }
  void start_output(std::size_t i) {
    node(i).output = std::make_unique<Output>(node(i).io, output_settings(i), node(i).said);
  }
  void start(std::size_t i) {
    start_input(i);
    start_output(i);
  }
  void start_all() {
    for (std::size_t i = 0; i < size(); ++i) start(i);
  }
  void end(std::size_t i) {
    node(i).output.reset();
    node(i).input.reset();
  }

  /// @return false if the condition did not come true; the guard is generous.
  template <typename Condition>
  bool until(Condition&& condition) {
    const Time deadline = Clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      if (Clock::now() > deadline) return false;
      step();
    }
    return true;
  }
  /// Lets everybody run on for a while, for what must not happen meanwhile.
  void run_for(milliseconds time) {
    const Time end = Clock::now() + time;
    until([&] { return Clock::now() >= end; });
  }

  bool linked(std::size_t from, std::size_t to) {
    return node(from).output && node(from).output->up() && node(from).output->to() == to && node(to).input &&
           node(to).input->from() == from;
  }
  bool whole() {
    for (std::size_t i = 0; i < size(); ++i) {
      if (!linked(i, (i + 1) % size())) return false;
    }
    return true;
  }

 private:
  void step() {
    for (auto& node : nodes_) {
      if (node->frozen) continue;
      node->io.restart();
      node->io.run_one_for(std::chrono::microseconds(100));
      node->io.poll();
    }
  }

  void find_ports(std::size_t nodes) {
    boost::asio::io_context io;
    std::vector<UdpSocket> sockets;
    for (std::size_t i = 0; i < nodes; ++i) {
      sockets.push_back(listen_udp(io, Endpoint::udp("127.0.0.1", 0)));
      endpoints_.push_back(Endpoint::udp("127.0.0.1", sockets.back().local_endpoint().port()));
    }
  }

  TemporaryFolder folder_;
  Timing timing_;
  std::vector<std::uint8_t> order_;
  std::vector<Endpoint> endpoints_;
  std::vector<std::unique_ptr<RigNode>> nodes_;
};

/// A framed `whole` slice of `size` bytes, all of value `fill`.
inline void put_whole(wire::SliceWriter& writer, std::size_t size, std::uint8_t fill) {
  const std::vector<std::uint8_t> bytes(size, fill);
  writer.put(wire::SliceKind::whole, {bytes.data(), bytes.size()});
}

/// Tests that hold on every transport.
struct OnEveryTransport : testing::TestWithParam<Endpoint::Transport> {
  bool udp() const { return GetParam() == Endpoint::Transport::udp; }
};

inline std::string transport_name(const testing::TestParamInfo<Endpoint::Transport>& info) {
  if (info.param == Endpoint::Transport::udp) return "Udp";
  return info.param == Endpoint::Transport::shm ? "Shm" : "Unix";
}

#define LIMB_RING_ON_EVERY_TRANSPORT(suite)                                                                  \
  INSTANTIATE_TEST_SUITE_P(                                                                                  \
      On, suite,                                                                                             \
      testing::Values(Endpoint::Transport::unix_stream, Endpoint::Transport::shm, Endpoint::Transport::udp), \
      transport_name)

}  // namespace limb_ring::link
