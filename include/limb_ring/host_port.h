#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "limb_ring/captured_packet.h"
#include "limb_ring/reason.h"

namespace limb_ring {

/// Destination of a packet to all nodes but its source. (paper)
constexpr std::uint8_t kBroadcast = 0xFF;
/// Bytes of data in one packet: 1 to 512. (paper)
constexpr std::size_t kMaxPayload = 512;

/// How a send ended. Every send has exactly one. (ours, protocol.md section 4.6)
enum class Outcome : std::uint8_t {
  delivered,     ///< taken by the destination's network controller; not: read by its CPU
  refused,       ///< the destination had no buffer free (or, for an interrupt, no pin wired)
  no_such_node,  ///< went round and nobody took it
  lost,          ///< not confirmed; it may have arrived, never twice
  unconfirmed,   ///< sent into an open chain, from which nothing returns
  rejected,      ///< never sent: queue full, not in a ring, bad arguments; see the reason
  cancelled      ///< given up: reset, shutdown, the daemon is gone
};
const char* to_string(Outcome outcome);

/// A packet for this CPU. Packets come by priority, 0 first. (paper)
struct Packet {
  std::uint8_t source = 0;
  std::uint8_t destination = 0;    ///< this node's id, or kBroadcast
  std::uint8_t priority = 0;       ///< 0 (highest) to 3
  std::uint8_t channel = 0;        ///< 0 user, 2 joint data, 3 topic fragments, 4 to 63 free
  std::vector<std::uint8_t> data;  ///< 1 to 512 bytes
};

/// A pin of this node was pulled whose action concerns the CPU.
struct Interrupt {
  enum class Action : std::uint8_t { notify, stop } action = Action::notify;
  std::uint8_t source = 0;
  std::uint8_t factor = 0;  ///< 0 to 7
};

/// The end of one send, interrupt or pull.
struct Result {
  std::uint32_t token = 0;  ///< what the call returned
  Outcome outcome = Outcome::rejected;
  std::chrono::nanoseconds round_trip{0};  ///< first byte out to matched return; 0 if none came
  unsigned tries = 0;                      ///< times put onto the line
  std::string reason;                      ///< why it was not delivered, for people; else empty
  Reason why = Reason::none;               ///< the same for programs
};

/// Answer to request(): a JSON object. A failed one holds {"error": "..."}.
struct Reply {
  std::uint32_t token = 0;
  std::string json;
};

/// Something seen by an observer (observe()): a JSON object, one line.
struct Observed {
  std::string json;
};

/// This client read too slowly: the number of Observed that were left out before the next one.
struct ObservedLost {
  std::uint64_t count = 0;
};

/// The connection has ended. Every send without a Result was reported `cancelled` before this.
struct Disconnected {
  std::string reason;
};

using Message =
    std::variant<Packet, Interrupt, Result, Reply, Observed, ObservedLost, CapturedPacket, CaptureCounts, Disconnected>;

/// Connecting failed; what() names the socket, what went wrong and what would be right.
struct HostPortError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A wait has reached its deadline. What it waited for may still come.
struct HostPortTimeout : HostPortError {
  using HostPortError::HostPortError;
};

/// What a program is at its node. (ours)
enum class Role : std::uint8_t {
  tool,  ///< any number of tools may send, pull inputs, make requests and observe; each gets its own results
  cpu    ///< the node's CPU, one at a time: also receives packets and interrupts, and is reset
};

/// To which node a program connects, and as what. (ours)
struct ConnectOptions {
  std::string ring;  ///< empty: the environment's LIMB_RING_RING, else the only ring running
  std::string node;  ///< id or name; empty: the environment's LIMB_RING_NODE
  Role role = Role::tool;
  /// role cpu, not a child of ringd: somebody (roslaunch's respawn) restarts this process when
  /// a reset kills it. If nobody does, resets of this node say so.
  bool restarted_by_owner = false;
  /// role cpu: promises to call alive() (or anything else) at least this often. 0: no promise.
  std::chrono::milliseconds alive_period{0};
  /// Results may come up to 20 ms late, with the next packet or other message: for programs that send at a fixed rate
  /// and do not wait for Results. It spares both processes a wake-up per send.
  bool results_may_wait = false;
  /// This program makes a few requests and disconnects, as ringctl's status and stop do. The daemon has a place for it
  /// even if limits.clients are connected, as it has for a CPU.
  bool asks_only = false;
  /// role cpu, on a ring with a virtual clock (`ringctl up --clock virtual`): its time goes on only while this program
  /// waits, in receive(), wait(), ask() or sleep_until(). False: the ring's time does not wait for this program, as it
  /// never waits for a tool; set this for a CPU that waits elsewhere, such as in poll().
  bool lockstep = true;
  /// How long to go on trying while the daemon is not there yet. Once it is there, it has the same time to answer, but
  /// 2 s if this is 0 or more than 2 s.
  std::chrono::milliseconds timeout{2000};
  /// Folder instead of $XDG_RUNTIME_DIR, for rings that are kept apart; empty: the environment's.
  std::string runtime;
  /// Called about every 50 ms while connect() waits, a CPU in lockstep waits for its turn, or another program sleeps on
  /// a virtual ring: these may last for as long as that ring is paused. What it throws ends the wait. A turn that was
  /// waited for is still to come, so the next call waits for it first. Empty: nothing.
  std::function<void()> meanwhile;
};

/// A program's connection to a node's network controller (ringd).
///
/// Not for several threads at a time; there are no callbacks. Sends return at once with a token; the Result with that
/// token comes out of receive(). Writing waits while the daemon's socket is full, for at most 5 s: then the connection
/// ends. It also ends if 65536 messages are waiting because receive() was not called.
/// Once it has ended, calls with a token still return one, whose Result is `cancelled` or whose Reply holds an error;
/// the others do nothing.
class HostPort {
 public:
  /// @throw HostPortError, HostPortTimeout if the daemon is not there yet or does not answer
  static HostPort connect(const ConnectOptions& options);
  HostPort(HostPort&&) noexcept;
  HostPort& operator=(HostPort&&) noexcept;
  /// Drops the sends that have not left the node, as the end of the program does: wait() for their results first.
  ~HostPort();

  std::uint8_t id() const;          ///< of the node this port belongs to
  const std::string& name() const;  ///< its name
  const std::string& ring() const;  ///< the ring's name

  /// @name The ring's clock
  /// A program that uses only these for time and waiting runs on a live ring and on a virtual one.
  ///@{
  /// CLOCK_MONOTONIC; on a virtual ring the time since its start. In lockstep it stands still until this program waits.
  std::chrono::nanoseconds now() const;
  /// The same instant for stamps: since 1970 (CLOCK_REALTIME); on a virtual ring as now().
  std::chrono::nanoseconds stamp() const;
  /// The stamp of a recent time of now().
  std::chrono::nanoseconds stamp_of(std::chrono::nanoseconds time) const;
  /// How long ago a stamp (ns, not negative) was given; negative: how far ahead it is. What was stamped on this host
  /// keeps its age when the host's wall clock is set: compare ages, or now() - age_of(stamp), never stamps with
  /// stamp().
  std::chrono::nanoseconds age_of(std::int64_t stamp_ns) const;
  /// On a virtual ring, as ConnectOptions::lockstep has it.
  bool in_lockstep() const;
  /// Returns at that time of now(), or when the connection has ended. Messages stay for receive().
  void sleep_until(std::chrono::nanoseconds time);
  ///@}

  /// Sends 1 to 512 bytes to a node (0 to 254) or kBroadcast, at priority 0 (highest) to 3.
  /// @return token of the Result. Bad arguments give a Result `rejected` with the reason.
  std::uint32_t send(std::uint8_t destination, const std::uint8_t* data, std::size_t size, std::uint8_t priority = 2,
                     std::uint8_t channel = 0);
  std::uint32_t send(std::uint8_t destination, const std::vector<std::uint8_t>& data, std::uint8_t priority = 2,
                     std::uint8_t channel = 0) {
    return send(destination, data.data(), data.size(), priority, channel);
  }
  /// Sends an interrupt packet: pulls pin `factor` (0 to 7) of `destination`. A broadcast to a
  /// factor that some node has wired to `reset` needs `force`.
  /// @return token of the Result, as of send()
  std::uint32_t interrupt(std::uint8_t destination, std::uint8_t factor, bool force = false);
  /// Pulls this node's interrupt input (0 to 7), as a watchdog or a button wired to it would.
  /// @return token of the Result, as of send()
  std::uint32_t pull(std::uint8_t input);
  /// Asks the daemon: a JSON object {"do": "...", ...}, at most 64 kB; see docs/reference/requests.md.
  /// @return token of the Reply
  std::uint32_t request(const std::string& json);
  /// From now on, what happens at this node comes as Observed. If "packets" is given, the packets on its lines come as
  /// CapturedPacket: {"kinds": [...], "packets": {...}} as in requests.md.
  /// @throw HostPortError if the text is longer than 64 kB. A filter that is refused comes as Observed {"error":
  /// ...}
  void observe(const std::string& json_filter);
  /// To be called by a CPU when it is stopped (its joints in their safe state after an emergency stop) and when it no
  /// longer is. The node shows this (`ringctl status`, /stopped) and tells the others, as for
  /// JointState::Mode::stopped.
  void tell_stopped(bool stopped);
  /// Says that the CPU is alive. Any other call that sends, receives or waits also says so when it begins, but not
  /// while it waits.
  void alive();

  /// The next message, waiting up to `timeout` (of now(); a tool's waits are of the machine's clock); nothing if
  /// none came, or after Disconnected. Interrupts come first, after at most 16 messages that arrived before them; other
  /// messages come in order of arrival. When it is a packet's turn, the waiting packet of highest priority is returned.
  /// A CPU is given at most 8 packets ahead of receive(): further ones wait in the network controller, which refuses
  /// more when its receive buffers are full.
  template <typename Rep, typename Period>
  std::optional<Message> receive(std::chrono::duration<Rep, Period> timeout) {
    constexpr std::chrono::hours kLongest{24 * 365};  // more than that would not fit nanoseconds
    if (timeout > kLongest) return receive_within(kLongest);
    return receive_within(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout));
  }
  /// The Reply to a request, waiting up to `timeout`; other messages stay for receive().
  /// @throw HostPortTimeout; HostPortError on lost connection, or a reply holding "error".
  std::string ask(const std::string& json, std::chrono::milliseconds timeout);
  /// The same for the token of a request(). @throw HostPortError, too, at once, if no reply of it is outstanding.
  std::string reply(std::uint32_t token, std::chrono::milliseconds timeout);
  /// The Result of a token, waiting up to `timeout`; other messages stay for receive().
  /// @throw HostPortTimeout; HostPortError, at once, if no result of that token is outstanding.
  Result wait(std::uint32_t token, std::chrono::milliseconds timeout);

  /// False once Disconnected is to be received, or was.
  bool connected() const;
  /// Readable when receive() may have something; for poll() or an event loop. A message that is
  /// already buffered does not show here: receive(0) until empty first. Not for a CPU in lockstep.
  int fd() const;

 private:
  std::optional<Message> receive_within(std::chrono::nanoseconds timeout);

  struct Impl;
  explicit HostPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limb_ring
