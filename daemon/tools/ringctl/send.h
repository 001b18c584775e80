#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// The results of a number of sends.
struct Sends {
  std::uint64_t asked = 0;  ///< how many were to be made
  std::uint64_t sent = 0;
  std::vector<Result> results;  ///< of those that have ended
  std::string problem;          ///< why there was an early end, other than Ctrl-C; empty: there was none
};

/// Makes `count` sends, a few of them outstanding at a time, and waits for their results, with
/// progress on standard error (ResultWait).
/// @param send makes one and returns its token
/// @param interval from one to the next; 0: as fast as they end
/// @return as many results, or those there are when somebody asks for an end (Ctrl-C) or the daemon has gone
Sends send_all(HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
               std::chrono::nanoseconds interval = {});

/// Refusals as counted by the destinations' own daemons, if these run on this host. They know the reason, which the
/// source can only infer from beacons.
class RefusalCounters {
 public:
  /// @param before their status rows from before the sends
  explicit RefusalCounters(ask::Rows before) : before_(std::move(before)) {}

  /// Replaces the reason of each refused result by the destinations' own, if exactly one reason was counted since.
  /// @param now rows of the same nodes, after the sends
  void explain(std::vector<Result>& results, const std::vector<ask::Node>& nodes, const ask::Rows& now) const;

 private:
  ask::Rows before_;
};

/// Prints one result, or how many ended how, or all as JSON. @return exit_code(); kNotDone if not all were made, or
/// have ended.
/// @throw HostPortError if the daemon has gone meanwhile
int report(const Sends& sends, bool as_json);

/// As send_all(). The reasons of refused sends come from their destinations, if these can be asked on this host.
/// @param to id of a node of the ring, or kBroadcast
Sends send_and_explain(HostPort& port, const RingAccess& ring, std::uint8_t to, unsigned count,
                       const std::function<std::uint32_t()>& send, std::chrono::nanoseconds interval = {});

/// kDone if all were delivered, kUnknown if the others may have been, else kNotDone.
int exit_code(const std::vector<Result>& results);

/// `round_trip_us` is that of the last of its `tries`, as in Result.
nlohmann::json to_json(const Result& result);
/// "delivered in 61.2 us", "refused in 70.1 us: pin INT5 of head is wired to nothing", "lost after 4 tries",
/// "refused after 22 tries, the last took 607 us"
std::string to_text(const Result& result);
/// The same within a sentence, behind the name of what was sent: "ended 'no such node' after 61.2 us". The outcome is
/// in quotes, since not every outcome is a word that fits into a sentence. 0 us, 1 try and no reason are left out.
std::string ended_text(const std::string& outcome, double round_trip_us, unsigned tries, const std::string& reason);
std::string ended_text(const Result& result);

/// How long the results of a node's sends are waited for. Every send ends by itself within the configured time-outs, so
/// only a daemon that is frozen, or a clock that stands, lets them wait for longer.
class ResultWait {
 public:
  explicit ResultWait(const HostPort& port) : port_(port) {}

  /// A result has come, or none is waited for.
  void restart() { begun_ = std::chrono::steady_clock::now(); }
  /// To be called now and then. @throw HostPortError that names the node, if it is in vain to go on
  void check() const;

 private:
  const HostPort& port_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// What --channel takes: 0 to 63, or the name of one that has one.
CLI::Validator any_channel();
/// The same without channel 1, which is the network controllers' own.
CLI::Validator channel_of_clients();

/// Bytes written as hexadecimal digits, two each; spaces, ':' and a leading 0x are ignored.
/// @throw UsageError naming what is not a digit, or an odd number of them
std::vector<std::uint8_t> parse_hex(const std::string& text);

}  // namespace limb_ring::ringctl
