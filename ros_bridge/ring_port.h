#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/wall_clock.h"
#include "limb_ring/host_port.h"
#include "ring/launched_ring.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// Periodic calls at absolute deadlines of a clock whose time is given. A late one is called once. The periods that it
/// missed are left out, not made up for: nobody wants old states in a burst.
class PeriodicCalls {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = Time::duration;

  /// @param phase delay after the multiples of the period since the clock's zero; none: the periods begin now
  void add(Duration period, std::optional<Duration> phase, std::function<void()> call, Time now);
  /// To be called when the clock is replaced by another one.
  void restart(Time now);
  /// The first deadline; Time::max() if there is no call.
  Time next_due() const;
  /// Calls what is due.
  void run(Time now);

 private:
  struct Call {
    Duration period;
    std::optional<Duration> phase;
    std::function<void()> call;
    Time due;
  };
  static Time first_due(const Call& call, Time now);

  std::vector<Call> calls_;
};

/// A packet on its way out.
struct Outgoing {
  std::uint8_t destination = 0;
  std::uint8_t priority = 2;
  std::uint8_t channel = 0;
  std::vector<std::uint8_t> data;
};

/// The bridge's place at the ring: one thread, the *ring thread*, owns the host port and calls
/// everything that was registered here. So data that only these calls use needs no lock.
///
/// If the daemon is gone, sends end as `cancelled`, and the connection is retried for ever.
class RingPort {
 public:
  using Clock = std::chrono::steady_clock;
  using OnPacket = std::function<void(const Packet&)>;
  using OnInterrupt = std::function<void(const Interrupt&)>;
  using OnResult = std::function<void(const Result&)>;
  /// `problem` is empty if the connection stands.
  using OnConnection = std::function<void(const std::string& problem)>;

  explicit RingPort(ConnectOptions options);
  RingPort(const RingPort&) = delete;
  RingPort& operator=(const RingPort&) = delete;
  ~RingPort();

  /// @name Before start()
  /// @{
  void on_packet(std::uint8_t channel, OnPacket handler) { packets_[channel] = std::move(handler); }
  void on_interrupt(OnInterrupt handler) { interrupt_ = std::move(handler); }
  void on_connection(OnConnection handler) { connection_.push_back(std::move(handler)); }
  /// Called only on a virtual ring: each millisecond of its time, and when tell_time() asks for it.
  void on_time(std::function<void(std::chrono::nanoseconds)> handler) { time_ = std::move(handler); }
  /// Called at absolute deadlines by now(), but only after everything that has come in was taken, so that what
  /// arrived while this process was not scheduled is not taken for missing.
  /// @param phase delay after the multiples of the period on now(); none: counted from the start
  void every(Clock::duration period, std::function<void()> tick, std::optional<std::chrono::nanoseconds> phase = {}) {
    ticks_.add(period, phase, std::move(tick), Clock::now());
  }
  void start();
  /// @}

  /// Ends the ring thread. No handler is called after it.
  void stop();

  /// Any thread: runs `work` on the ring thread. False if 1024 wait already.
  bool post(std::function<void()> work);
  /// Any thread.
  const std::string& ring() const { return options_.ring; }
  /// Any thread: this process is alive; passed on to the daemon.
  void alive() { post_alive_ = true; }

  /// Ring thread only: the steady clock's time, or the ring's time if the ring is virtual.
  Clock::time_point now() const;
  /// Any thread: the clock for stamps of what is published. On a virtual ring it shows the time that the ring thread
  /// has last seen.
  RosClock& ros_clock() { return ros_clock_; }
  const RosClock& ros_clock() const { return ros_clock_; }
  /// Ring thread only: the stamp of what came at that time of the steady clock, in ns since 1970; now() on a virtual
  /// ring.
  std::int64_t stamp_of(Clock::time_point came);
  enum class Held : std::uint8_t { fulfilled, in_vain, let_go };
  /// Ring thread only: waits, in real time, until `condition` holds; the ring's time stands meanwhile, and posted work
  /// is done. @return in_vain after `patience`; let_go if somebody keeps a TimeGoesOn
  Held hold_time_until(const std::function<bool()>& condition, std::chrono::milliseconds patience);
  /// While one exists, the ring's time is not held. For callers that wait for something that takes ring time.
  class TimeGoesOn {
   public:
    explicit TimeGoesOn(RingPort& port);
    TimeGoesOn(const TimeGoesOn&) = delete;
    TimeGoesOn& operator=(const TimeGoesOn&) = delete;
    ~TimeGoesOn() { --port_.letting_go_; }

   private:
    RingPort& port_;
  };

  /// Ring thread only, before something is published: calls on_time()'s handler, unless it was called in this instant.
  void tell_time();

  /// Ring thread only: the ring is virtual, and its time stands while this thread acts.
  bool in_lockstep() const { return port_ && port_->in_lockstep(); }
  /// Ring thread only.
  bool connected() const { return port_.has_value(); }
  /// Ring thread only. `on_result` is called once, later, never from within send().
  void send(const Outgoing& packet, OnResult on_result);
  /// Ring thread only: makes a request to the daemon (docs/reference/requests.md) and ignores the answer.
  void request(const std::string& json) {
    if (port_) port_->request(json);
  }

 private:
  void run();
  void notice_time();
  void try_connect();
  void wait_for_something();
  void take_messages();
  void take(Message message);
  void lost(const std::string& reason);
  void report(const std::string& problem);
  void run_posted();
  Clock::time_point next_deadline() const;

  ConnectOptions options_;
  std::array<OnPacket, 64> packets_;
  OnInterrupt interrupt_;
  std::vector<OnConnection> connection_;
  PeriodicCalls ticks_;
  std::function<void(std::chrono::nanoseconds)> time_;

  std::optional<HostPort> port_;
  std::string problem_ = "not tried yet";
  Clock::time_point next_try_{};
  bool more_to_take_ = false;
  std::optional<Message> message_;          ///< that has ended a wait in lockstep
  std::chrono::nanoseconds told_time_{-1};  ///< by time_
  RosClock ros_clock_;
  process::WallClock wall_clock_;
  std::unordered_map<std::uint32_t, OnResult> results_;
  std::vector<OnResult> unsendable_;  // asked for while not connected

  std::mutex mutex_;
  std::deque<std::function<void()>> posted_;
  std::atomic<bool> post_alive_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<int> letting_go_{0};  ///< of TimeGoesOn
  int wake_ = -1;
  std::thread thread_;
};

/// Carries out a service call. An exception becomes the answer's message: a service that just fails gives its caller no
/// reason. @return true, as ROS expects of a service that has answered
template <typename Response, typename Call>
bool answered(RingPort& port, Response& response, Call call) {
  const RingPort::TimeGoesOn time_goes_on(port);  // even if it is held for a controller, as calls take ring time
  try {
    response.success = true;
    call();
  } catch (const HostPortTimeout& late) {
    response.success = false;
    response.message = live::with_standing_clock(late.what(), port.ring());
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace limb_ring::bridge
