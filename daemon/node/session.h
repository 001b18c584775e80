#pragma once

#include <sys/types.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/frame.h"
#include "client/host_message.h"
#include "core/events.h"
#include "io/packet_loop.h"
#include "io/unique_fd.h"
#include "limb_ring/host_port.h"

namespace limb_ring::host {

class Session;

/// Keeps the virtual clock for the clients of a host port that run in lockstep with it.
class TurnKeeper {
 public:
  virtual ~TurnKeeper() = default;
  /// Of the ring's clock.
  virtual std::chrono::nanoseconds now() const = 0;
  /// The CPU of a node has greeted. `attach` is called once, now or when its boot is over in the ring's time.
  virtual void greeted(std::uint8_t node, std::function<void()> attach) = 0;
  /// The CPU that has greeted is gone, and was not attached.
  virtual void left(std::uint8_t node) = 0;
  /// That CPU is attached, and waits for its first turn.
  virtual void joined(std::uint8_t node, const std::shared_ptr<Session>& session) = 0;
  /// Something is there for a client in lockstep.
  virtual void has_news() = 0;
  /// A client that the clock does not wait for has changed something.
  virtual void disturbed() = 0;
  /// The CPU of a node can take `packets` more packets: the first time its whole window, later as many as it has taken.
  virtual void credited(std::uint8_t /*node*/, unsigned /*packets*/) {}
  /// What the CPU of a node does that keeps time from going on, as a sentence without the node; empty: nothing.
  virtual std::string holds_time(std::uint8_t /*node*/) const { return ""; }
};

/// The turns of a client in lockstep. It acts while it has its turn, the ring's time stands meanwhile, and it gets its
/// messages when its next turn begins. Times are of the ring's clock.
class ClientTurn {
 public:
  explicit ClientTurn(TurnKeeper& keeper) : keeper_(keeper) {}

  void begin() {
    is_on_ = true;
    has_news_ = false;
  }
  /// @param until when it lets time pass, unless there is news
  void end(std::chrono::nanoseconds until) {
    is_on_ = false;
    is_awaited_ = true;
    next_ = until;
  }
  bool is_on() const { return is_on_; }

  /// A message is waiting that the client should get at once.
  void tell_news() {
    has_news_ = true;
    keeper_.has_news();
  }
  bool has_news() const { return has_news_; }
  /// The next turn begins so soon at the latest.
  void comes_within(std::chrono::nanoseconds time) { next_ = std::min(next_, keeper_.now() + time); }
  std::chrono::nanoseconds next() const { return next_; }

  /// Whether its messages are read only while somebody waits for them, so that clients acting in the same instant are
  /// heard in their order. It is so until it has taken too long, and again from the end of that turn.
  bool is_awaited() const { return is_awaited_; }
  void await_no_more() { is_awaited_ = false; }

 private:
  TurnKeeper& keeper_;
  bool is_on_ = false;
  bool has_news_ = false;
  bool is_awaited_ = true;
  std::chrono::nanoseconds next_ = std::chrono::nanoseconds::max();
};

using ClientId = std::uint32_t;  ///< never used twice by one server

/// One client of a host port, as it has introduced itself.
struct ClientInfo {
  ClientId id = 0;
  Role role = Role::tool;
  pid_t pid = 0;  ///< as the kernel says (SO_PEERCRED), not the client
  bool restarted_by_owner = false;
  bool results_may_wait = false;
  bool asks_only = false;                     ///< it needs no place for long
  bool lockstep = false;                      ///< it acts in its turns alone
  std::chrono::milliseconds alive_period{0};  ///< 0: no promise
};

/// What the clients of a host port want of the daemon. Called from the event loop only, never
/// from inside a call to HostServer; calling HostServer from inside is fine. Arguments are within
/// their ranges already; what a request points to is valid during the call only.
class HostHandler {
 public:
  virtual ~HostHandler() = default;

  /// A CPU in lockstep has greeted. It is attached when its boot time is over on the ring's clock.
  virtual void on_greeted(pid_t /*pid*/) {}
  /// The same CPU is gone, or refused, and was not attached.
  virtual void on_left(pid_t /*pid*/) {}
  /// A client has greeted. @return a reason to refuse it
  virtual std::optional<std::string> on_attach(const ClientInfo& client) = 0;
  /// A client that was attached is gone. Results for it may still be given; they go nowhere.
  virtual void on_detach(const ClientInfo& client) = 0;
  virtual void on_send(ClientId client, const client::SendRequest& request) = 0;
  virtual void on_interrupt(ClientId client, const client::InterruptRequest& request) = 0;
  virtual void on_pull(ClientId client, const client::PullRequest& request) = 0;
  virtual void on_request(ClientId client, const client::JsonRequest& request) = 0;
  /// Whether such a request changes something, rather than only asking.
  virtual bool changes_something(const client::JsonRequest&) const { return false; }
  virtual void on_observe(ClientId client, const client::ObserveRequest& request) = 0;
  /// A client cannot be let in, for want of descriptors most likely. Called once until one has been.
  virtual void on_shortage(const std::string& /*why*/) {}
  /// A sign of life: called for every message of a client, before the message's own call.
  virtual void on_alive(ClientId client) = 0;
  /// The CPU can take packets again: HostServer::cpu_can_take() has become true.
  virtual void on_credit(ClientId client) = 0;
};

class Session;

/// Whom a session tells.
class SessionOwner {
 public:
  virtual ~SessionOwner() = default;
  virtual void on_message(Session& session, const client::ToDaemon& message) = 0;
  /// What clients ask in one turn of the event loop has taken all the time that it may: the rest of it waits for the
  /// next turn, so that a client that asks fast does not hold up the ring.
  virtual bool has_asked_enough() const { return false; }
  enum class End : std::uint8_t { closed, garbage, never_greeted, too_slow };
  /// Called once, unless the owner ended the session. It may come from inside Session::put(), so the owner must not
  /// tell anybody else yet.
  virtual void on_end(Session& session, End end) = 0;
};

/// One client's connection: frames in, frames out, and the limits of both.
///
/// Output is gathered and written at the end of the event loop's turn: several messages, one
/// write. What does not fit the socket waits in a bounded queue.
class Session : public std::enable_shared_from_this<Session> {
 public:
  static constexpr std::size_t kMaxQueued = 4 * 1024 * 1024;
  /// An Observed is left out if more than this is waiting.
  static constexpr std::size_t kMaxQueuedForObserved = 256 * 1024;
  /// A captured packet is left out if more bytes than this would be waiting: 25 ms of a ring at its
  /// busiest, so that an observer loses nothing merely because it is scheduled late.
  static constexpr std::size_t kMaxQueuedForCaptured = 1024 * 1024;
  /// Captured packets are gathered for this time, or until kCapturedLot bytes are waiting: waking an
  /// observer for every packet would be its largest cost for the ring.
  static constexpr std::chrono::milliseconds kGatherCaptured{5};
  /// A result may wait this long for other messages to be sent with it, if the client has allowed that.
  static constexpr std::chrono::milliseconds kGatherResults{20};
  static constexpr std::size_t kCapturedLot = 32 * 1024;
  static constexpr std::chrono::seconds kGreetingDeadline{2};
  /// How long await_message() waits for one client in lockstep before other work, such as the idle clients, has its
  /// turn.
  static constexpr std::chrono::milliseconds kPatience{2};

  /// @throw std::system_error if it cannot be waited for
  Session(boost::asio::io_context& io, process::UniqueFd socket, ClientInfo info, SessionOwner& owner);

  void start();
  /// It has greeted in time; what it says next waits until it is attached.
  void greeted();
  /// The greeting was accepted: the client is what `info` says.
  /// @param turns not null if info.lockstep is set
  void attach(const ClientInfo& info, TurnKeeper* turns);
  /// Writes what can be written at once, `reason` last, and closes. The owner is not told.
  void end(const std::string& reason);

  template <typename Kind>
  void put(const Kind& message) {
    if (append(message)) flush_soon();
  }
  /// Sent at once, or together with later messages if the client has allowed that.
  void put_result(const Result& result);
  /// @return false if it was left out
  bool put_observed(const Observed& observed);
  bool put_captured(const client::CapturedView& packet);

  /// @name A client in lockstep: it gets its messages when its turn begins, and acts until it ends the turn
  ///@{
  /// In nanoseconds of the ring's clock.
  void begin_turn(std::chrono::nanoseconds now);
  void end_turn(std::chrono::nanoseconds until);
  const ClientTurn& turn() const { return *turn_; }
  /// Waits, in real time, for a message of the client and handles it. @return false if none came within kPatience
  bool await_message();
  /// The client has taken too long. From now on its messages are read whenever they come, not only by await_message().
  void wait_no_more();
  ///@}

  /// Neither reads nor writes until thaw(), which handles everything that has piled up.
  void freeze() { frozen_ = true; }
  void thaw();

  bool open() const { return owner_ != nullptr; }
  /// It was the client that has ended it.
  bool ended_by_client() const { return ended_by_client_; }
  bool attached() const { return attached_; }
  /// It has asked for something, and will be told how that ended.
  void asks();
  void is_told();
  /// It hears of what happens.
  void observes() { observes_ = true; }
  /// For so long it has not been heard, and nothing is under way for it; 0 for a CPU, and for one that observes.
  std::chrono::nanoseconds idle_for() const;
  /// True if the other end has gone, though we may not have read so far.
  bool hung_up() const;
  const ClientInfo& info() const { return info_; }
  unsigned credit = 0;  ///< packets the client has room for

 private:
  void wait_for_greeting();
  void on_ready(std::uint32_t events);
  void read();
  void take(ssize_t got);
  void take_frames();
  /// It has greeted and is not attached: what it says beyond a limit waits in its socket until it is.
  bool has_said_enough() const;
  void put_off_the_rest();
  std::uint32_t input_events() const;
  /// @return false if there is no session any more
  template <typename Kind>
  bool append(const Kind& message) {
    if (!open()) return false;
    client::append(out_.to_append(), message);
    return keeps_limit();
  }
  bool keeps_limit();
  void flush_soon();
  /// Flushes within `time`. An earlier deadline also sends everything that could have waited longer.
  void flush_within(std::chrono::milliseconds time);
  void flush();
  int write_now();  ///< 0, or the errno that stopped it
  void wait_writable();
  void tell_observed_lost();
  void fail(SessionOwner::End end);

  event_loop::PacketLoop& loop_;
  process::UniqueFd socket_;
  boost::asio::steady_timer greeting_timer_;
  boost::asio::steady_timer gather_timer_;
  ClientInfo info_;
  SessionOwner* owner_;
  bool attached_ = false;
  unsigned under_way_ = 0;
  bool observes_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();  ///< asked, or was told
  client::StreamBuffer in_;
  event_loop::Backlog out_{kMaxQueued};
  bool flush_under_way_ = false;
  std::chrono::milliseconds gathering_for_{0};  ///< the shortest time that gather_timer_ was set for; 0: it is not set
  std::uint64_t observed_lost_ = 0;
  std::optional<ClientTurn> turn_;  ///< of a client in lockstep
  bool greeted_ = false;            ///< and is not attached yet
  bool frozen_ = false;
  bool ended_by_client_ = false;
  bool put_off_ = false;  ///< what was read is not all taken yet
  bool ending_ = false;   ///< the other end has gone; what it sent before is still to be read
  event_loop::Watch watch_;
};

}  // namespace limb_ring::host

namespace limb_ring::runtime {

/// Who asked the network controller for a send, and so who is told how it ended. The core carries it as an opaque
/// core::Owner; that is made and read here alone. (ours)
struct SendOwner {
  enum class Kind : std::uint8_t {
    client,             ///< of the host port: a tool or the CPU, also if it pulls an interrupt input
    traffic,            ///< packets that the daemon makes to time them
    daemon_interrupts,  ///< interrupts that the daemon itself sends
    babbling_cpu,       ///< packets of a CPU that babbles on purpose
    ring_user           ///< who asks a virtual ring itself, such as a scenario
  };
  Kind kind = Kind::client;
  host::ClientId client = 0;  ///< of a client: which; they count up from 1

  static constexpr SendOwner of(host::ClientId client) { return {Kind::client, client}; }
  static constexpr SendOwner of(Kind kind) { return {kind, 0}; }

  constexpr core::Owner to_core() const {
    return kind == Kind::client ? client : kFirstInternal + static_cast<core::Owner>(kind);
  }
  /// @pre made by to_core()
  static constexpr SendOwner from_core(core::Owner owner) {
    return owner < kFirstInternal ? of(owner) : of(static_cast<Kind>(owner - kFirstInternal));
  }

 private:
  static constexpr core::Owner kFirstInternal = 0xFFFFFF00;
};

}  // namespace limb_ring::runtime
