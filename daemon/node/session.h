#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "client/host_message.h"
#include "client/stream_buffer.h"
#include "io/backlog.h"
#include "io/packet_loop.h"
#include "io/unique_fd.h"
#include "node/client_turn.h"
#include "node/host_handler.h"
#include "node/turn_keeper.h"

namespace limb_ring::host {

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
  /// An Observed is left out where more than this is waiting.
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

  /// @throw std::system_error where it cannot be waited for
  Session(boost::asio::io_context& io, process::UniqueFd socket, ClientInfo info, SessionOwner& owner);

  void start();
  /// It has greeted in time; what it says next waits until it is attached.
  void greeted();
  /// The greeting was accepted: the client is what `info` says.
  /// @param turns not null where info.lockstep is set
  void attach(const ClientInfo& info, TurnKeeper* turns);
  /// Writes what can be written at once, `reason` last, and closes. The owner is not told.
  void end(const std::string& reason);

  template <typename Kind>
  void put(const Kind& message) {
    if (append(message)) flush_soon();
  }
  /// Sent at once, or together with later messages if the client has allowed that.
  void put_result(const Result& result);
  /// @return false where it was left out
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
  /// True where the other end has gone, though we may not have read so far.
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
  /// @return false where there is no session any more
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
