#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "config/node_row.h"
#include "limb_ring/host_port.h"
#include "ring/observed_daemon.h"

namespace limb_ring::ask {

/// A node as a running ring tells of it.
struct Node {
  std::uint8_t id = 0;
  std::string name;
  std::string host = {};  ///< empty if the ring's file gives no hosts
};

/// What a daemon has answered, or why it has not.
template <class T>
struct Told {
  std::optional<T> said;
  std::string why_not;      ///< empty if it has answered, or was not asked: it is frozen
  bool unreadable = false;  ///< it has answered what is none
};
using Answer = Told<nlohmann::json>;
using ToldRow = Told<status::NodeRow>;

/// Asks the daemons of a ring that run on this host, all at the same time, over connections that it keeps. A node is
/// not there if its daemon is frozen, cannot be connected to, does not answer by the deadline, says that it cannot be
/// done, or answers what is none; it is asked again the next time. One thread at a time.
class RingClient {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  /// @param runtime as of ConnectOptions
  RingClient(const std::string& ring, std::vector<Node> nodes, live::Stay stay = live::Stay::asks_only,
             const std::string& runtime = {});

  /// One answer for each node, in their order.
  std::vector<Answer> ask(const nlohmann::json& request, Deadline deadline);
  /// The same of their status rows, which for a large ring are short without what each has heard.
  std::vector<ToldRow> status(Deadline deadline, bool with_heard = true);
  /// The same of one of them.
  ToldRow status_of(std::size_t node, Deadline deadline);

  /// null if it is not connected.
  HostPort* port(std::size_t node);

  /// As it is connected to; may be called by several threads.
  std::function<void(std::size_t node, HostPort& port)> on_connect = [](std::size_t, HostPort&) {};
  /// What comes instead of an answer.
  std::function<void(std::size_t node, const Message& message)> on_message = [](std::size_t, const Message&) {};
  /// So long one that was not there is not asked again.
  std::chrono::milliseconds pause{0};

 private:
  struct Daemon {
    Node node;
    std::optional<HostPort> port;
    Deadline next_try{};
    std::optional<std::uint32_t> token;  ///< of what it was asked last
  };
  std::vector<Answer> ask(const std::vector<std::size_t>& nodes, const std::string& request, Deadline deadline);
  void connect(std::size_t node, Deadline deadline);
  Answer begin(std::size_t node, const std::string& request, Deadline deadline);
  Answer end(std::size_t node, Deadline begun, Deadline deadline);
  ToldRow row_in(std::size_t node, Answer answer) const;

  std::string folder_;
  ConnectOptions options_;
  std::vector<Daemon> daemons_;
};

/// "unexpected reply from its daemon: 'cpu.state' is not a string; ...", with what to do.
std::string sentence_of_shape(const std::string& wrong);

}  // namespace limb_ring::ask
