#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/signal_wait.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/up.h"

namespace limb_ring::ringctl {

/// The daemons of a ring of our own, by their place in it, and a connection to each. One thread; messages come in
/// while poll(), pump() or ask() wait. All that was started has ended when this is destroyed.
class LiveNodes {
 public:
  using Clock = std::chrono::steady_clock;

  /// None is started yet. @param plan, signals outlive this
  LiveNodes(const RingPlan& plan, process::SignalWait& signals)
      : plan_(plan), signals_(signals), nodes_(plan.nodes.size()) {}
  ~LiveNodes();
  LiveNodes(const LiveNodes&) = delete;
  LiveNodes& operator=(const LiveNodes&) = delete;

  /// @name In effect when they return. They do nothing if the node is in that state already
  ///@{
  void start(std::size_t place);
  void kill(std::size_t place);
  void freeze(std::size_t place);
  void thaw(std::size_t place);
  ///@}

  std::size_t size() const { return nodes_.size(); }
  /// Its process lives and is not frozen.
  bool running(std::size_t place) const { return nodes_[place].daemons && !nodes_[place].frozen; }
  bool dead(std::size_t place) const { return !nodes_[place].daemons; }
  /// Why a daemon ended that should not have; nothing if none did.
  std::optional<std::string> exit_reason();
  /// The last lines of a node's log.
  std::string last_lines(std::size_t place) const;

  /// Fetches fresh status rows of all that run. @return which node does not answer, or the error of a request(); empty:
  /// all is well. @throw Interrupted
  std::string poll();
  /// The row of the last poll(); null if the node was not there.
  const status::NodeRow* row(std::size_t place) const { return nodes_[place].row ? &*nodes_[place].row : nullptr; }
  /// null if there is no connection.
  HostPort* port(std::size_t place) { return nodes_[place].port ? &*nodes_[place].port : nullptr; }

  /// Passes messages on until `until`, or until done() is true. @return whether it was. @throw Interrupted
  bool pump(
      Clock::time_point until, const std::function<bool()>& done = [] { return false; });
  /// The node's answer; messages are passed on meanwhile. @throw NotDone with its error, or if it does not answer
  nlohmann::json ask(std::size_t place, const nlohmann::json& request);
  /// As ask(), without waiting for the answer: a later poll() reports its error. A node that is frozen, or not there
  /// yet, does it when it can.
  void request(std::size_t place, const nlohmann::json& request);

  /// Results and observations; called from pump().
  std::function<void(std::size_t place, const Message&)> on_message = [](std::size_t, const Message&) {};
  /// Called at every turn of pump(). @return when to call it again
  std::function<Clock::time_point()> on_turn = [] { return Clock::time_point::max(); };

 private:
  struct Node {
    std::unique_ptr<live::LaunchedRing> daemons;  ///< one; null: not started, or killed
    bool frozen = false;
    std::optional<HostPort> port;
    std::optional<status::NodeRow> row;
    std::optional<std::uint32_t> asked;   ///< for the row
    std::vector<nlohmann::json> pending;  ///< requests, until there is a connection
  };

  /// A request other than for the row.
  struct Asked {
    std::size_t place;
    std::uint32_t token;
    std::optional<nlohmann::json> answer;
  };

  Asked send(std::size_t place, const nlohmann::json& request);
  void answered(std::size_t place, const Reply& reply);
  const std::string& name(std::size_t place) const { return plan_.nodes[place].name; }
  bool ask_for_rows();
  void connect(std::size_t place);
  void take_messages();
  void take(std::size_t place, const Message& message);
  void wait_for_messages(Clock::time_point until);

  const RingPlan& plan_;
  process::SignalWait& signals_;
  std::vector<Node> nodes_;
  std::optional<Asked> asked_;      ///< by ask()
  std::vector<Asked> outstanding_;  ///< by request()
  std::string request_error_;
};

}  // namespace limb_ring::ringctl
