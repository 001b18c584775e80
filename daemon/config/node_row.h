#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "wire/control_message.h"

/// What a node's daemon answers to the requests `status`, `latch`, `faults` and `config`, as values. Each has one
/// list of its members, a row for each: from it come the struct, the JSON, both ways, what is wrong with an answer, and
/// the page docs/reference/status.md. A member added is one row there.
namespace limb_ring::status {

/// Whether a member is in the JSON. Who reads takes one that is missing and one that is null for the same.
enum class In : std::uint8_t {
  always,  ///< without it, it is no such answer
  told,    ///< always if a daemon answers; who reads keeps the initial value if it is missing
  null,    ///< null if it is empty
  some     ///< left out if it is empty, or false
};

/// The rows of a list: type, name, initial value, In, meaning.
#define LIMB_RING_MEMBER(type, name, initial, in, meaning) type name = initial;
#define LIMB_RING_VISIT(type, name, initial, in, meaning) visit(#name, self.name, In::in, meaning);
/// All members of a list, and each(): calls visit(name, member, In, meaning) for each.
#define LIMB_RING_MEMBERS(LIST)                      \
  LIST(LIMB_RING_MEMBER)                             \
  template <class Self, class Visit>                 \
  static void each(Self& self, const Visit& visit) { \
    LIST(LIMB_RING_VISIT)                            \
  }

using Text = std::string;
using Counters = std::map<Text, std::uint64_t>;
template <class T>
using Maybe = std::optional<T>;

#define LIMB_RING_LATCH(X)                                                \
  X(bool, latched, false, told, "there was one since the daemon's start") \
  X(std::uint8_t, source, 0, told, "the node that asked for it")          \
  X(std::uint32_t, count, 0, told, "how many there were")                 \
  X(std::uint64_t, clock_ns, 0, told, "CLOCK_MONOTONIC of the node then")
/// The last latch of a node's clock.
struct Latch {
  LIMB_RING_MEMBERS(LIMB_RING_LATCH)
};

#define LIMB_RING_BROKEN_LINE(X)                                                                         \
  X(std::uint8_t, before, 0, always, "the node before the break")                                        \
  X(std::uint8_t, behind, 0, always, "the node behind it")                                               \
  X(Maybe<double>, since_s, {}, some,                                                                    \
    "since the node behind it heard the last of it or saw its end; at other nodes since they were told") \
  X(Maybe<double>, announced_ms, {}, some,                                                               \
    "only at the node behind it: from then until that node was sure of a break, and told all others")
struct BrokenLine {
  LIMB_RING_MEMBERS(LIMB_RING_BROKEN_LINE)
};

#define LIMB_RING_STOP(X)                                                                         \
  X(bool, latched, false, told, "the CPU says that it is stopped")                                \
  X(bool, latches, true, told, "false: the CPU has said that it never latches one")               \
  X(std::uint64_t, pulled, 0, told, "how often its stop pin was pulled since the daemon's start") \
  X(Maybe<std::int64_t>, pulled_ms, {}, null, "how long ago; null: never")
struct Stop {
  LIMB_RING_MEMBERS(LIMB_RING_STOP)
};

#define LIMB_RING_CPU(X)                                                                                             \
  X(Text, state, "unknown", always,                                                                                  \
    "none (built-in sink), absent, booting, running, silent, failed; `ringctl status` also says hung, stopped, and " \
    "unknown")                                                                                                       \
  X(Text, kind, {}, some, "none, child (of ringd), attached")                                                        \
  X(Maybe<int>, pid, {}, null, "its process; null: none")                                                            \
  X(Maybe<std::uint32_t>, boots, {}, null, "starts of it since the daemon's start")                                  \
  X(Maybe<bool>, hung, {}, some,                                                                                     \
    "its process is stopped (SIGSTOP), which a CPU without an `alive_period` does not show otherwise")               \
  X(Maybe<std::int64_t>, silent_ms, {}, some, "since its last word; 0 where none is attached")                       \
  X(Maybe<std::int64_t>, alive_period_ms, {}, some,                                                                  \
    "the CPU, or the ring's file for it, has promised a sign of life in each period; 0: no promise")                 \
  X(Maybe<bool>, restarted_by_owner, {}, some, "attached: it says that somebody starts it again when it is killed")  \
  X(Maybe<std::uint64_t>, resets, {}, some, "how often it was reset since the daemon's start")                       \
  X(Maybe<Text>, last_reset, {}, some, "by whom last, as \"INT0 from node 0\"")                                      \
  X(Maybe<std::uint64_t>, exits, {}, some, "ends of children by themselves")                                         \
  X(Maybe<std::uint64_t>, failed_boots, {}, some, "children that did not attach in time, or not at all")             \
  X(Maybe<Text>, last_exit, {}, some, "how the last one ended: \"exit 3\", \"signal 9 (Killed)\"")                   \
  X(Maybe<Stop>, stop, {}, some, "what is known of a stop of its joints")                                            \
  X(Text, verdict, {}, some, "only of `ringctl status`: what the ring's supervisor says of it")
struct Cpu {
  LIMB_RING_MEMBERS(LIMB_RING_CPU)

  bool stopped() const { return stop && stop->latched; }
};

#define LIMB_RING_INPUT(X)             \
  X(Text, state, {}, told, "up, down") \
  X(Maybe<std::uint8_t>, from, {}, null, "the node that it hears; null: none")
struct Input {
  LIMB_RING_MEMBERS(LIMB_RING_INPUT)
};

#define LIMB_RING_OUTPUT(X)                                                     \
  X(Text, state, {}, told, "up, down")                                          \
  X(Maybe<std::uint8_t>, to, {}, null, "the node that it sends to; null: none") \
  X(Maybe<std::int64_t>, rate_bit_s, {}, null, "data rate of the line; null: as fast as the host")
struct Output {
  LIMB_RING_MEMBERS(LIMB_RING_OUTPUT)
};

#define LIMB_RING_ROUND_TRIPS(X)                                                             \
  X(Maybe<double>, min, {}, null, "")                                                        \
  X(Maybe<double>, p50, {}, null, "the median")                                              \
  X(Maybe<double>, p99, {}, null, "of 100, 99 are not above it")                             \
  X(Maybe<double>, max, {}, null, "")                                                        \
  X(std::uint64_t, samples, 0, told, "how many these are: of the last minute, 4096 at most") \
  X(Maybe<double>, since_s, {}, null, "how long ago the first of them ended")
struct RoundTrips {
  LIMB_RING_MEMBERS(LIMB_RING_ROUND_TRIPS)
};

/// A number, or a word.
struct Id {
  Text text;
};

#define LIMB_RING_FAULT(X)                                                                   \
  X(Id, id, {}, always, "for `remove_fault`; of what was done to a whole node its word")     \
  X(Text, name, {}, told, "its word")                                                        \
  X(Text, fault, {}, always, "as `ringctl fault` takes it")                                  \
  X(double, age_s, 0, told, "since it was asked for")                                        \
  X(bool, waits, false, told, "it has not begun")                                            \
  X(std::uint64_t, hits, 0, told, "packets that it has hit, or times")                       \
  X(Maybe<std::uint64_t>, packets_left, {}, null, "until it ends; null: it has no such end") \
  X(Maybe<double>, seconds_left, {}, null, "until it ends by itself; null: it does not")
/// A fault on purpose that lasts.
struct Fault {
  LIMB_RING_MEMBERS(LIMB_RING_FAULT)
};

#define LIMB_RING_REFUSAL(X)                                                     \
  X(std::uint8_t, refused, 0, always, "the node")                                \
  X(std::uint8_t, by, 0, always, "the one that does not take it as a neighbour") \
  X(Text, reason, {}, told, "as \"it runs another ring file: timeouts differ\"") \
  X(Text, text, {}, always, "the whole sentence")
struct Refusal {
  LIMB_RING_MEMBERS(LIMB_RING_REFUSAL)
};

#define LIMB_RING_WARNING(X)                                    \
  X(Text, rule, {}, always, "one word of those in requests.md") \
  X(Text, text, {}, always, "a sentence without the node's name")
struct Warning {
  LIMB_RING_MEMBERS(LIMB_RING_WARNING)
};

#define LIMB_RING_LATELY_DAMAGED(X)                                            \
  X(std::int64_t, within_s, 0, always, "length of the window that is counted") \
  X(double, oldest_s, 0, told, "how long ago the first of them came")          \
  X(std::uint64_t, crc_errors, 0, told, "packets that came in damaged")        \
  X(std::uint64_t, returns_damaged, 0, told, "those of them that were its own")
struct LatelyDamaged {
  LIMB_RING_MEMBERS(LIMB_RING_LATELY_DAMAGED)
};

#define LIMB_RING_HEARD(X)                                    \
  X(std::uint8_t, id, 0, always, "the node")                  \
  X(Text, name, {}, told, "its name")                         \
  X(std::uint64_t, boot, 0, told, "its boot number")          \
  X(std::uint32_t, hop, 0, told, "relays between the two")    \
  X(std::int64_t, age_ms, 0, always, "since its last beacon") \
  X(wire::Beacon, beacon, {}, told, "")                       \
  X(Maybe<BrokenLine>, broken_line, {}, null, "the break that it tells of; null: none")
/// What a node has heard in another's beacons. In JSON the fields of the beacon stand beside the rest, those that have
/// a meaning there (wire::Field::heard).
struct Heard {
  LIMB_RING_MEMBERS(LIMB_RING_HEARD)

  /// As Cpu::state has it.
  Text cpu_state() const { return to_string(beacon.cpu_state); }
};

#define LIMB_RING_FOLD(X)                                                   \
  X(bool, input, false, told, "the second line stands for the input")       \
  X(bool, output, false, told, "the second line stands for the output")     \
  X(Text, second_input, {}, always, "link of the second line in: up, down") \
  X(Text, second_output, {}, told, "link of the second line out: up, down")
struct Fold {
  LIMB_RING_MEMBERS(LIMB_RING_FOLD)
};

#define LIMB_RING_WATCHED_CPU(X)                                                                                     \
  X(std::uint8_t, id, 0, always, "its node")                                                                         \
  X(Text, name, {}, always, "its name")                                                                              \
  X(Text, verdict, {}, always,                                                                                       \
    "unheard, booting (the grace included), alive, hung (its network controller is heard, the CPU is silent; until " \
    "it speaks or has booted), absent (no process), unreachable (no beacon: node or line)")                          \
  X(std::int64_t, for_ms, 0, always, "for how long")                                                                 \
  X(std::uint64_t, hangs, 0, always, "times found hung")                                                             \
  X(std::uint64_t, resets, 0, always, "ordered")                                                                     \
  X(std::uint64_t, confirmed, 0, always, "of those: a higher number of CPU boots was heard")                         \
  X(std::uint64_t, tries, 0, told, "resets since it last ran for long")                                              \
  X(bool, given_up, false, told, "hung, and no longer reset")                                                        \
  X(Text, last, {}, always, "the last finding")                                                                      \
  X(Text, reset_reason, {}, told, "of the last reset")
/// A CPU, as the ring's supervisor finds it.
struct WatchedCpu {
  LIMB_RING_MEMBERS(LIMB_RING_WATCHED_CPU)
};

#define LIMB_RING_SUPERVISOR(X)                    \
  X(Text, policy, {}, always, "off, report, auto") \
  X(std::vector<WatchedCpu>, watched, {}, always, "the CPUs that have an `alive_period`")
struct Supervisor {
  LIMB_RING_MEMBERS(LIMB_RING_SUPERVISOR)
};

#define LIMB_RING_NODE_ROW(X)                                                                                      \
  X(std::uint8_t, id, 0, always, "the node")                                                                       \
  X(Text, name, {}, always, "its name")                                                                            \
  X(Text, state, "down", always,                                                                                   \
    "starting, joining, up, open_chain, folded, alone, duplicate_id; `ringctl status` also says down, frozen and " \
    "unanswered")                                                                                                  \
  X(Text, ring, {}, some, "the ring's name; `ringctl status --json` gives it once, for all")                       \
  X(Maybe<int>, pid, {}, null, "its daemon's process")                                                             \
  X(Cpu, cpu, {}, always, "its CPU")                                                                               \
  X(Maybe<std::uint32_t>, ring_size, {}, null, "nodes of the ring, as it has learned them; 0: not known")          \
  X(Maybe<std::uint64_t>, boot, {}, some, "its boot number (protocol.md 4.8)")                                     \
  X(Maybe<double>, uptime_s, {}, some, "since its start, by its clock")                                            \
  X(Maybe<Input>, input, {}, some, "the line that leads to it")                                                    \
  X(Maybe<Output>, output, {}, some, "the line that it leads")                                                     \
  X(RoundTrips, round_trip_us, {}, told, "of its own sends and beacons; null: none")                               \
  X(Maybe<std::uint64_t>, received, {}, some, "data packets taken for its CPU")                                    \
  X(Maybe<std::uint64_t>, waiting, {}, some, "of those: not yet handed over")                                      \
  X(Maybe<BrokenLine>, broken_line, {}, null, "the break that it knows of; null: none")                            \
  X(std::vector<Fault>, faults, {}, told, "faults on purpose that last")                                           \
  X(std::vector<Refusal>, refusals, {}, told, "of the last 3 s, for another ring file, version or key")            \
  X(std::vector<Warning>, warnings, {}, told, "what is wrong at this node")                                        \
  X(Counters, counters, {}, told, "all that its daemon counts: protocol.md section 10")                            \
  X(Maybe<LatelyDamaged>, lately_damaged, {}, some, "packets that came in damaged")                                \
  X(std::vector<Heard>, heard, {}, told, "the other nodes, by their beacons")                                      \
  X(Maybe<Fold>, fold, {}, some, "where the ring folds back")                                                      \
  X(Maybe<Supervisor>, supervisor, {}, some, "at the ring's supervisor: what its watchdog knows")                  \
  X(Text, host, {}, some, "only of `ringctl status`: its host, if the ring's file gives hosts")                    \
  X(Text, unanswered, {}, some, "only of `ringctl status`: why its daemon has not answered")                       \
  X(bool, elsewhere, false, some, "only of `ringctl status`: all this is from its beacons")                        \
  X(Maybe<Latch>, latch, {}, some, "only of `ringctl status`: as its beacons tell it")
/// A node's status. `ringctl` makes a row also of a node whose daemon does not answer.
struct NodeRow {
  LIMB_RING_MEMBERS(LIMB_RING_NODE_ROW)

  /// 0 if it has no counter of that name.
  std::uint64_t counter(const Text& which) const {
    const auto found = counters.find(which);
    return found == counters.end() ? 0 : found->second;
  }
};

#define LIMB_RING_CONFIGURED_NODE(X)                   \
  X(std::uint8_t, id, 0, always, "the node")           \
  X(Text, name, {}, always, "its name")                \
  X(std::uint64_t, joints, 0, told, "how many it has") \
  X(Text, host, {}, some, "where there are hosts")
/// A node, and a host, of the ring's file, as the request `config` tells of them.
struct ConfiguredNode {
  LIMB_RING_MEMBERS(LIMB_RING_CONFIGURED_NODE)
};

#define LIMB_RING_CONFIGURED_HOST(X) \
  X(Text, name, {}, told, "")        \
  X(Text, address, {}, told, "")     \
  X(Text, ssh, {}, told, "where ssh finds it")
struct ConfiguredHost {
  LIMB_RING_MEMBERS(LIMB_RING_CONFIGURED_HOST)
};

#define LIMB_RING_CONFIGURED(X)                                            \
  X(Text, ring, {}, told, "its name")                                      \
  X(Text, path, {}, told, "the ring's file")                               \
  X(std::vector<ConfiguredNode>, nodes, {}, always, "all, in ring order")  \
  X(std::vector<ConfiguredHost>, hosts, {}, told, "")                      \
  X(bool, folds_back, false, told, "it has a second line")                 \
  X(std::int64_t, beacon_ms, 0, told, "time between two beacons")          \
  X(std::int64_t, cpu_boot_ms, 0, told, "how long a CPU may take to boot") \
  X(std::uint8_t, supervisor, 0, told, "its id")
/// What a node was configured with.
struct Configured {
  LIMB_RING_MEMBERS(LIMB_RING_CONFIGURED)
};

Latch latch_of(const wire::ClockLatch& latch);

nlohmann::json to_json(const NodeRow& row);
nlohmann::json to_json(const Configured& configured);
nlohmann::json to_json(const Latch& latch);
nlohmann::json to_json(const RoundTrips& round_trips);
nlohmann::json to_json(const std::vector<Fault>& faults);

/// Reads an answer into `to`, which is as it was made. Members that are not named here are passed over.
/// @return what is wrong, as "'cpu.state' is not a string"; empty: nothing
std::string read(const nlohmann::json& answer, NodeRow& to);
std::string read(const nlohmann::json& answer, Configured& to);
std::string read(const nlohmann::json& answer, Latch& to);
std::string read(const nlohmann::json& answer, std::vector<Fault>& to);

/// All members of a row as rows of a Markdown table: | `cpu.state` | text | always | meaning |.
std::string members_of_row();

}  // namespace limb_ring::status
