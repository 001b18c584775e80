#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "io/core_sharing.h"
#include "io/unique_fd.h"
#include "io/watch.h"

namespace limb_ring::event_loop {

/// The part of an event loop that packets pass through, one for each io_context. Its descriptors stay in an epoll set
/// of its own: a packet costs at most one system call to wait for it, and those that read and write it. Boost.Asio
/// makes one more each time it waits for a descriptor again; it handles what is rare: timers, connections, signals.
/// (ours)
///
/// While nothing passes, Asio waits for the set as for any descriptor. While packets pass, run() waits on the set
/// itself, and lets Asio see to its own every kColdPeriod. A program that calls io_context::run() instead gets the same
/// calls, more slowly.
class PacketLoop final : public boost::asio::execution_context::service {
 public:
  /// While packets pass, Asio's timers and sockets are late by at most this, or by the time between two packets if that
  /// is longer. When packets have just stopped, they are late by at most kQuietPeriod.
  static constexpr std::chrono::milliseconds kColdPeriod{5};
  /// No packets pass once none has come for this.
  static constexpr std::chrono::milliseconds kQuietPeriod{20};

  static boost::asio::execution_context::id id;

  /// The one of this io_context; made when it is first asked for.
  static PacketLoop& of(boost::asio::io_context& io);
  /// Called by of() only. @throw std::system_error
  explicit PacketLoop(boost::asio::execution_context& io);

  /// Runs everything until the io_context is stopped.
  /// @param spin looks for packets for so long before it waits: for a core that has nothing else to do. Where it is 0,
  ///        it shares its core as CoreSharing says.
  void run(std::chrono::nanoseconds spin = {});

  /// Calls `call` at the end of this turn, when all that is ready has been read, so that what a turn leads to is
  /// written together.
  void at_turn_end(std::function<void()> call);
  /// How many turns are over.
  std::uint64_t turns() const { return turns_; }
  /// Packets pass: the process is awake now, and will be again in a moment.
  bool packets_pass() const { return hot_; }
  /// A process of this host has been given something in this turn, such as the node's CPU, and may answer.
  void expect_answer() { answer_due_ = true; }
  /// The process is scheduled as it was before packets passed: for the program that is executed in its place.
  void end_core_sharing() { sharing_.end(); }

 private:
  friend class Watch;
  using Clock = std::chrono::steady_clock;

  void shutdown() override;
  void add(const std::shared_ptr<Watch::State>& watch);
  void change(const std::shared_ptr<Watch::State>& watch, int operation);
  void remove(std::shared_ptr<Watch::State> watch);
  void call_later(const std::shared_ptr<Watch::State>& watch);
  void found_packets(const Watch::State& watch) { last_found_ = &watch; }

  /// @return whether anything but the cold timer was ready
  bool turn(bool may_sleep);
  /// @return whether packets have come where the last ones did
  bool look_first();
  void call_those_again();
  void end_turn();
  /// A turn that does not wait: does what was asked for outside of a turn.
  void catch_up();
  void finish_soon();
  bool has_work() const { return !again_.empty() || !at_turn_end_.empty(); }
  void run_hot(std::chrono::nanoseconds spin);
  void poll_asio_when_due(Clock::time_point now);
  void let_asio_wait();
  void take_from_asio();

  boost::asio::io_context& io_;
  process::UniqueFd set_;                        ///< the epoll set
  boost::asio::posix::stream_descriptor asios_;  ///< the same while Asio waits for it
  process::UniqueFd cold_timer_;                 ///< ticks every kQuietPeriod while packets pass
  std::vector<std::shared_ptr<Watch::State>> again_, called_again_, stopped_;
  std::vector<std::function<void()>> at_turn_end_;
  Clock::time_point last_ready_{};
  Clock::time_point last_polled_{};  ///< Asio
  unsigned in_a_row_ = 0;            ///< times that something came soon after the last
  std::size_t watches_ = 0;
  const Watch::State* last_found_ = nullptr;  ///< where packets have come last
  bool asked_ = false;                        ///< the kernel what is ready, in the last turn
  bool asio_waits_ = false;
  bool running_ = false;  ///< in run()
  bool in_turn_ = false;
  bool hot_ = false;  ///< packets pass: run() waits for the set itself
  bool posted_ = false;
  bool cold_due_ = false;
  CoreSharing sharing_;
  bool answer_due_ = false;  ///< in this turn
  std::uint64_t turns_ = 0;
};

}  // namespace limb_ring::event_loop
