#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include "client/frame.h"
#include "client/host_message.h"
#include "client/inbox.h"

namespace limb_ring::client {

/// What a program has to look at while the library waits (ConnectOptions::meanwhile).
class Meanwhile {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Meanwhile(std::function<void()> call) : call_(std::move(call)) {}

  /// How far a wait until `deadline` goes before the next look().
  Clock::time_point until(Clock::time_point deadline) const {
    return call_ ? std::min(deadline, Clock::now() + kPeriod) : deadline;
  }
  /// Calls it if the last time is long enough ago. What it throws ends the wait.
  void look() {
    if (!call_ || Clock::now() < due_) return;
    due_ = Clock::now() + kPeriod;
    call_();
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{50};

  std::function<void()> call_;
  Clock::time_point due_{};
};

using Clock = std::chrono::steady_clock;

/// How many packets a CPU grants at once. Small, so that packets wait in the network controller's
/// receive buffers, where priority and refusal work.
constexpr std::uint16_t kPacketWindow = 8;
/// Credit goes back with whatever is sent, or in a lot of this size: one write for several packets.
constexpr std::uint16_t kCreditLot = 4;
constexpr unsigned kMostFromOneRead = 16;

/// One connection to a daemon: messages out, messages into the inbox, and an orderly end.
class Connection {
 public:
  Connection(UnixSocket socket, const ConnectOptions& options);

  /// Says who we are, and waits for the daemon's word. @param options as the constructor's
  enum class Handshake { welcome, refused, closed, timed_out };
  Handshake greet(const ConnectOptions& options, const std::string& ring, Clock::time_point deadline);

  /// Writes a message, waiting while the socket is full, for 5 s at most.
  template <typename Kind>
  void send(const Kind& message) {
    if (!connected_) return;
    append(out_, message);
    if (credit_owed_ > 0) append(out_, Credit{std::exchange(credit_owed_, std::uint16_t{0})});
    flush();
  }
  /// In lockstep every call is made in a turn: if `meanwhile` has ended a wait, the turn is still to come.
  void await_turn();
  /// Registers a call and returns its token. If the connection has ended, the call's end is in the inbox at once.
  std::uint32_t begin(Pending::Ends ends);
  /// Ends a call without asking the daemon: a Result `rejected`, or a Reply holding the error.
  void reject(std::uint32_t token, const std::string& reason, Reason why = Reason::none);

  /// Reads what has come into the inbox, at most 64 kB.
  void read();
  /// What the last read has brought may be taken without another one, which would be a system call for each message.
  /// True kMostFromOneRead times in a row at most, so that an interrupt, which goes first, does not wait for long.
  bool may_take_unread();
  /// Waits until something can be read, or until now() reaches `until`. @return false: nothing has come until then
  bool wait_until(std::chrono::nanoseconds until);
  /// Reads until now() reaches `time`.
  void sleep_until(std::chrono::nanoseconds time);
  /// Lets the program do what it has to do meanwhile, if it is time for that.
  void look() { meanwhile_.look(); }
  /// The clock by which this connection waits: the ring's in lockstep, else the machine's.
  std::chrono::nanoseconds now() const;
  ClockKind clock() const { return clock_; }
  std::optional<Message> take();
  /// Begins a wait: says that the CPU is alive if it has said nothing for a while.
  void stay_alive();

  bool connected() const { return connected_; }
  /// Why the connection ended, or the daemon refused.
  const std::string& reason() const { return reason_; }
  int fd() const { return socket_.fd(); }
  Inbox& inbox() { return inbox_; }
  /// Nobody waits for its end any more: that is dropped when it comes.
  void forget(std::uint32_t token) { pending_.remove(token); }
  bool outstanding(std::uint32_t token, Pending::Ends ends) const { return pending_.contains(token, ends); }

  std::uint8_t id = 0;
  std::string name;
  std::string ring;

 private:
  void flush();
  void wait_to_write(Clock::time_point deadline);
  void take_frames();
  void lose(const std::string& reason);

  void on(const Welcome& welcome);
  void on(const Refused& refused);
  void on(const Turn& turn);
  void on(const PacketView& packet);
  void on(Result result);
  void on(Reply reply);
  template <typename Kind>
  void on(Kind message) {
    inbox_.put(std::move(message));
  }

  UnixSocket socket_;
  std::chrono::milliseconds alive_period_;
  Meanwhile meanwhile_;
  StreamBuffer in_;
  Bytes out_;
  Inbox inbox_;
  Pending pending_;
  bool connected_ = true;
  bool welcome_ = false;
  std::string reason_;
  std::uint16_t credit_owed_ = 0;
  unsigned taken_unread_ = 0;  ///< times that may_take_unread() was true since the last read
  ClockKind clock_ = ClockKind::machine;
  bool my_turn_ = true;  ///< in lockstep: nothing comes until it has ended
  std::chrono::nanoseconds turn_at_{0};
  std::chrono::nanoseconds last_written_{0};  ///< by now()
};

/// Finds the daemon's socket (options, environment, the only ring running), connects, greets.
/// Goes on trying until `deadline` while the daemon is not there yet.
/// @throw HostPortError
Connection open_connection(const ConnectOptions& options, Clock::time_point deadline);

}  // namespace limb_ring::client
