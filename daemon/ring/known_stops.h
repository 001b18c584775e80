#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_command.h"
#include "ring/ring_client.h"

namespace limb_ring::ask {

/// What is known of one node after a stop was sent.
enum class StopState : std::uint8_t {
  stopped,      ///< its CPU says that a stop is latched
  told,         ///< its stop pin was pulled; its CPU runs, and does not say what it made of it
  silent,       ///< its stop pin was pulled; its CPU is silent, or its process is stopped
  booting,      ///< its stop pin was pulled while its CPU did not run; it comes up, or has come up, without the stop
  never,        ///< its CPU was told, and is of a kind that never stops, as ring_bridge
  no_cpu,       ///< there is none that could stop
  not_reached,  ///< its stop pin was not pulled
  unknown       ///< its daemon does not answer, and no beacon of it says
};
/// One word for programs: "not_reached".
const char* to_string(StopState state);

struct KnownStop {
  Node node;
  StopState state = StopState::unknown;
};

/// What is known of each node. The beacons of a node on another host say whether it has stopped, but not whether its
/// pin was pulled.
/// @param age of the stop; a pin that was pulled longer ago was pulled by an earlier stop
/// @param delivered the INTP came home, so all pins were pulled
std::vector<KnownStop> known_stops(const std::vector<Node>& nodes, const Rows& rows, std::chrono::milliseconds age,
                                   bool delivered = false);

/// Its CPU, or a beacon, could still say that it has stopped.
bool may_say_so(const Rows& rows, const KnownStop& stop);

/// The age, by the ring's clock, of a stop that was delivered: that of the pin that was pulled last, and what has
/// passed since. A virtual ring that catches up is ahead of our clock.
/// @param age by our clock
std::chrono::milliseconds age_on_virtual_ring(const Rows& rows, std::chrono::milliseconds age);

/// A stop whose effect is waited for.
struct SentStop {
  std::string ring;
  std::vector<Node> nodes;                     ///< to be stopped, in ring order
  std::chrono::steady_clock::time_point sent;  ///< when it was asked for
  bool of_all = true;                          ///< `nodes` are all of the ring, else it is one
  bool delivered = false;                      ///< the INTP came home
};

/// Polls for 200 ms at most, until no node counts as not reached: in an open chain a stop may still be under way.
std::vector<KnownStop> wait_until_reached(const SentStop& stop);
/// Polls for 1 s at most, until every CPU that was told, and latches stops, says that it has stopped. Waits for a node
/// that was not reached no longer than wait_until_reached() does.
std::vector<KnownStop> wait_for_stops(const SentStop& stop);

/// Who should stop all next, where parts of the ring were not reached: a node from where a stop goes down as much of an
/// open chain as possible. Nothing if all were reached, or all that were not have been asked.
/// @param stops of all nodes, in ring order
/// @param asked ids of those that have sent a stop already
std::optional<Node> next_to_ask(const std::vector<KnownStop>& stops, const std::set<std::uint8_t>& asked);

/// What is known now, whenever a stop was sent: of those that are not stopped only whether that can be known at all.
std::vector<KnownStop> stops_now(const std::string& ring, const std::vector<Node>& nodes);
/// Those whose CPU says that a stop is latched, as far as daemons on this host answer or have heard.
std::vector<Node> nodes_with_latched_stop(const std::string& ring, const std::vector<Node>& nodes);

/// Polls for 1 s at most, until none of these says any more that a stop is latched.
/// @param nodes have taken the command that ends it
/// @return those that still do, as after a command that came too late for the CPU
std::vector<Node> wait_for_resumes(const std::string& ring, const std::vector<Node>& nodes);
/// "knee: it is still stopped, ..."
std::string sentence_of_latched(const Node& node);

bool any_is(const std::vector<KnownStop>& stops, StopState state);
/// Every node was reached, and its CPU, if it has one, has stopped or was told while it ran.
bool all_told(const std::vector<KnownStop>& stops);

/// "14 of 16 stopped; no CPU to stop: waist; not reached: head"
std::string sentence_of(const std::vector<KnownStop>& stops);

/// What came of the resume of one node.
struct Resumed {
  Node node;
  Result result;
  bool was_latched = false, is_latched = false;
  bool seen = false;  ///< its daemon, or a beacon of it, tells that no stop is latched there any more

  bool done() const { return !is_latched && (result.outcome == Outcome::delivered || (was_latched && seen)); }
};

/// Sends a resume from the node with this id, and waits for its result.
using SendResume = std::function<Result(std::uint8_t from)>;

/// A resume that one node has sent, with this result: if that does not reach its target, it is sent from a node of
/// this host that does. @return the result that counts
Result resume_from_nearer(const std::string& ring, std::uint8_t target, const Result& result, const SendResume& send);

/// Fills in what can be seen of them, for which it waits 1 s at most: of a command that was not confirmed, it alone
/// tells. @param nodes all of the ring
void look_at(const std::string& ring, const std::vector<Node>& nodes, std::vector<Resumed>& all);

bool is_among(const std::vector<Node>& nodes, std::uint8_t id);

/// The command that ends a latched stop. (limb_ring/payload/joint_command.h) It is valid for 1 s, longer than others,
/// since a hung CPU may take so long to read it. (ours)
/// @param stamp_ns when it was given, by the clock of payloads
payload::JointCommand resume_command(std::int64_t stamp_ns);

/// Sends resume_command() to the CPU of one node, and waits for its result. Whether the CPU obeys it,
/// wait_for_resumes() tells (known_stops.h).
/// @throw HostPortError on time-out
Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout);

}  // namespace limb_ring::ask
