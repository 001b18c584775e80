#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "judge/observation_file.h"
#include "judge/promise_judge.h"
#include "limb_ring/host_port.h"

namespace limb_ring::live {

/// The observations (`observe`) of one node's daemon, which may die, stop and come back. (ours)
class ObservedDaemon {
 public:
  /// @param node its id
  /// @param what is to be observed, in JSON
  /// @param runtime as ConnectOptions
  ObservedDaemon(const std::string& ring, std::uint8_t node, std::string what, const std::string& runtime = {});

  bool connected() const { return port_.has_value(); }
  /// Tries to connect, at most four times a second, and waits 200 ms for a daemon that is starting, and 200 ms for its
  /// answer. @return true if connected now
  bool look_for();
  /// There is one, perhaps stopped, or that cannot be known.
  bool may_live() const;
  /// Why a daemon that lives, or may, could not be connected to when it was looked for last; empty if it could.
  const std::string& problem() const { return problem_; }
  /// The next observation. @return nothing if none is waiting, or the daemon is gone
  std::optional<std::string> next();
  /// Drops the connection; look_for() makes a new one.
  void drop() { port_.reset(); }
  /// From its clock to dates since 1970. @pre connected()
  std::chrono::nanoseconds to_date() const {
    const std::chrono::nanoseconds now = port_->now();
    return port_->stamp_of(now) - now;
  }

 private:
  using Clock = std::chrono::steady_clock;

  ConnectOptions daemon_;
  std::string folder_;
  std::uint8_t node_;
  std::string what_;
  std::optional<HostPort> port_;
  Clock::time_point next_try_{};
  std::string problem_;
};

/// Whether somebody asks and goes, or needs its place for long: see ConnectOptions::asks_only.
enum class Stay : std::uint8_t { asks_only, for_long };

/// Connects to a node's daemon without waiting for one that is not there. @throw HostPortError
/// @param node id or name
/// @param meanwhile as ConnectOptions::meanwhile
HostPort connect_node(const std::string& ring, const std::string& node, Stay stay = Stay::asks_only,
                      std::function<void()> meanwhile = {});

/// The same to a virtual ring's own host port, which is of no node. @throw HostPortError
HostPort connect_ring(const std::string& ring);

/// As HostPort::ask(), but for people, who did not write the request: what goes wrong does not quote it.
nlohmann::json ask_for_people(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout);

/// Judges the promises of a living ring from its daemons' observations. Nodes may die, stop and come back. (ours)
class PromiseWatch {
 public:
  /// The period at which poll() is to be called; a broken promise is reported within a second.
  static constexpr std::chrono::milliseconds kRound{50};

  struct Ring {
    std::string name;
    std::vector<std::uint8_t> nodes;  ///< of this host
    bool folds_back = false;
    std::string runtime = {};  ///< as ConnectOptions
  };
  PromiseWatch(const Ring& ring, promises::PromiseJudge::OnBreach on_breach);

  /// Reads from all connected nodes and looks for the others. May wait 400 ms for each that does not answer.
  /// @throw NotDone once for each node that cannot be observed; the others are, in the next poll()
  void poll();
  /// Reads what is left, and judges it: some rounds more.
  void finish();
  /// Nodes that are being looked at.
  std::size_t watched() const;
  /// A node whose daemon lives, or may, and is not looked at.
  struct Unwatched {
    std::uint8_t node;
    std::string why;
  };
  std::vector<Unwatched> unwatched() const;
  const promises::JudgeCounts& counts() const { return judge_.counts(); }
  /// The instant of a breach since 1970; on a virtual ring by its own clock.
  std::chrono::nanoseconds date(std::int64_t at_ns) const { return std::chrono::nanoseconds(at_ns) + to_date_; }

 private:
  struct Node {
    std::uint8_t id;
    ObservedDaemon daemon;
    std::unique_ptr<promises::ObservationReader> reader = nullptr;
    int last_rounds = 0;       ///< until it counts as dead
    std::string problem = {};  ///< why its observations cannot be read
  };

  void hear(Node& node);
  void begin(Node& node, const std::string& message);
  void read(Node& node);

  promises::PromiseJudge judge_;
  std::vector<Node> nodes_;
  std::vector<promises::Observation> seen_;
  std::chrono::nanoseconds to_date_{0};
};

/// What was asked of a ring did not happen; what() says why.
struct NotDone : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::live
