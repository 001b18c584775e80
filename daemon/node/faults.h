#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "config/fault_parse.h"
#include "config/node_row.h"
#include "node/cpu_socket.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// Sends as a babbling CPU would (a "babbling idiot"): the largest packets, to all, at the highest priority, without
/// end. The real CPU goes on beside it. (ours)
class BabblingCpu {
 public:
  explicit BabblingCpu(NodeDriver& driver) : driver_(driver), next_(driver.clock().timer([this] { send_next(); })) {}

  /// One packet per `period`, as each has ended; 0: its queue is always full, and what is beyond that is rejected.
  void start(std::chrono::nanoseconds period);
  void stop();
  /// Packets that have ended, in whatever way, since start().
  std::uint64_t sent() const { return sent_; }

  void on_ended(const core::SendEnded& ended);

 private:
  void send();
  void send_next();

  NodeDriver& driver_;
  std::unique_ptr<event_loop::Timer> next_;
  std::chrono::nanoseconds period_{0};
  bool on_ = false;
  std::uint32_t next_token_ = 1;   ///< each send has its own, by which `ringctl traffic judge` tells them apart
  std::uint32_t first_token_ = 1;  ///< of this run: results of an earlier one do not count
  std::uint64_t sent_ = 0;
  std::array<std::uint8_t, wire::kMaxPayload> data_{};
};

/// Breaks the node's CPU on purpose, and mends it; the network controller goes on. A process is hit by
/// signals, whether it is our child or attached; what a CPU reads and sends is changed at its socket. (ours)
class CpuFaults {
 public:
  /// Called once: with an empty text when the action has taken effect, else with the reason why it has not.
  using Done = std::function<void(const std::string& problem)>;

  /// @param cpu_boot how long a CPU may take to boot (timeouts.cpu_boot)
  CpuFaults(boost::asio::io_context& io, NodeDriver& driver, CpuSocket& cpu, std::chrono::milliseconds cpu_boot)
      : io_(io), driver_(driver), cpu_(cpu), cpu_boot_(cpu_boot), babbling_(driver) {}

  /// Breaks, restarts or cures it. A reset is done when it has booted again, or could not.
  void begin(const fault::Fault& fault, const Done& done);
  /// Ends what that did.
  void end(fault::ToCpu what, const Done& done);
  /// All that is done at its socket ends; a stopped process stays so.
  void free_socket();
  /// Packets, or times.
  std::uint64_t hits(fault::ToCpu what) const;

  /// Its process is stopped, by us or by others. True as soon as we have sent SIGSTOP.
  bool hangs() const;
  void on_ended(const core::SendEnded& ended) { babbling_.on_ended(ended); }

 private:
  /// Stops its process.
  void hang(const Done& done);
  /// Ends its process by SIGSEGV, as a wild pointer would.
  void crash(const Done& done);
  void reset(const Done& done);
  void read_on();
  /// Its process goes on.
  void wake(const Done& done);
  void wait(std::function<bool()> condition, const std::string& otherwise, const Done& done);

  boost::asio::io_context& io_;
  NodeDriver& driver_;
  CpuSocket& cpu_;
  std::chrono::milliseconds cpu_boot_;
  BabblingCpu babbling_;
  pid_t stopping_ = -1;                                     ///< it was sent SIGSTOP, which has not taken effect yet
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by waits
};

/// What was broken on purpose at this node: the line out of it, and its CPU. Each fault has an id and can be
/// listed and removed; one that ends by itself leaves the list. (ours)
class Faults {
 public:
  using Id = std::uint32_t;                 ///< from 1; 0: it was over when it was done (heal, resume, reset, crash)
  static constexpr std::size_t kMost = 64;  ///< at the same time

  /// Called once: with an empty text when it has taken effect, else with the reason why it has not.
  using Done = std::function<void(const std::string& problem)>;
  using Begun = std::function<void(Id id, const std::string& problem)>;

  /// @param cpu_boot as of CpuFaults
  Faults(boost::asio::io_context& io, fault::RingNodes nodes, NodeDriver& driver, CpuSocket& cpu,
         std::chrono::milliseconds cpu_boot)
      : io_(io), nodes_(std::move(nodes)), driver_(driver), cpu_(io, driver, cpu, cpu_boot) {}

  const fault::RingNodes& nodes() const { return nodes_; }
  /// @pre a fault of the line out of this node, or of its CPU; if it takes a seed, it has one
  void begin(const fault::Fault& fault, const Begun& begun);
  /// @return false if there is no such fault (any more); `done` is not called then
  bool remove(Id id, const Done& done);
  void clear(const Done& done);
  bool full() const { return active_.size() >= kMost; }
  /// A fault keeps the CPU from sending anything of its own.
  bool silence_cpu() const;

  /// As docs/reference/requests.md describes it, in the order in which they began.
  std::vector<status::Fault> list();

  /// A CPU that has booted again has none of its old faults.
  void cpu_booted();
  void on_ended(const core::SendEnded& ended) { cpu_.on_ended(ended); }
  /// Called when the daemon ends. An outside CPU that was made to hang must not stay so for ever.
  void stop();

 private:
  struct Active {
    Active(fault::Fault f, core::Time now) : fault(std::move(f)), since(now) {}
    fault::Fault fault;
    core::Time since;
    LineBreaker* on = nullptr;               ///< the line it is of; null: a fault of the CPU
    fault::LineFaults::Id line = 0;          ///< its id there
    std::unique_ptr<event_loop::Timer> end;  ///< none: it ends otherwise, or never
  };

  Id add(const fault::Fault& fault);
  void begin_line(const fault::Fault& fault, const Begun& begun);
  void begin_cpu(const fault::Fault& fault, const Begun& begun);
  void end_later(Id id);
  void mend(fault::ToCpu what, const Done& done);
  void forget_cpu_faults();
  LineBreaker& breaker_of(const fault::Fault& fault);
  void wait_for(const LineBreaker& line, const Done& done);
  void drop_ended(core::Time now);
  /// What the lines say of their faults that have not ended by then, by line and id there.
  using OfLines = std::map<std::pair<const LineBreaker*, fault::LineFaults::Id>, fault::LineFaults::Listed>;
  OfLines of_lines(core::Time now) const;

  boost::asio::io_context& io_;
  fault::RingNodes nodes_;
  NodeDriver& driver_;
  CpuFaults cpu_;
  Id last_id_ = 0;
  std::map<Id, Active> active_;
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by waits
};

}  // namespace limb_ring::runtime
