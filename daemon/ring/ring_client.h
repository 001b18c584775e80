#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
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

/// How long a daemon may take to answer when rows are polled.
constexpr std::chrono::milliseconds kRowTimeout{500};

/// Status rows, by node id.
using Rows = std::map<std::uint8_t, status::NodeRow>;

/// The status rows of those daemons on this host that answer in time.
Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout);

/// The same of all daemons on this host.
Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout);

/// The beacon of a node that the daemon of this row has heard within the last second; null if it has heard none.
const status::Heard* lately_heard_in(const status::NodeRow& row, std::uint8_t node);
/// The newest of those that the daemons of this host have lately heard; null if none has.
const status::Heard* lately_heard(const Rows& rows, std::uint8_t node);

/// A node with a daemon on this host whose packets arrive at `target`, as its beacons do: in an open chain one before
/// it, round a fold one of its part. Nothing if the target's daemon does not answer here, or hears no such node.
std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target);

/// The name of a node, or its id if it is none of these.
std::string name_of(const std::vector<Node>& nodes, std::uint8_t id);

/// A counter of a node's daemon that grows only if something goes wrong. (ours)
struct ErrorCounter {
  /// What is to be looked at: the line into the node, the line out of it, or the node itself.
  enum class Of : std::uint8_t { input, output, node } of;
  std::string name;  ///< as in the node's status (protocol.md section 10)
  /// One count is a packet, a try, or a datagram of packets, that was damaged, lost or thrown away at this node:
  /// `ringctl status --watch` adds these up. The others count what a line or a link did, or what the receiving end was
  /// not ready for.
  bool of_packets;
};

/// All that /diagnostics warns of as they grow, and `ringctl status --watch` adds up.
const std::vector<ErrorCounter>& error_counters();

/// What is said of a whole ring is made of this, of each of its nodes.
struct NodeInRing {
  std::string state;          ///< as in its status row
  std::size_t ring_size = 0;  ///< as it has learned it; 0: not known
};

/// "16 of 16 nodes work, open chain: line waist -> left_hip broken". (ours)
/// @param broken_line its two nodes, "waist -> left_hip"; empty: nobody knows it
std::string ring_in_words(const std::vector<NodeInRing>& nodes, const std::string& broken_line);

/// How to reach the CPU of the first node of an open chain, which nothing reaches over the ring: "mend the line, or let
/// its daemon restart its CPU: 'ringctl fault reset left_hip'"
std::string way_to_first_of_chain(const std::string& node);

}  // namespace limb_ring::ask
