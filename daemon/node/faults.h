#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "config/fault_parse.h"
#include "node/cpu_faults.h"

namespace limb_ring::runtime {

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
  /// @pre a fault of the line out of this node, or of its CPU; where it takes a seed, it has one
  void begin(const fault::Fault& fault, const Begun& begun);
  /// @return false where there is no such fault (any more); `done` is not called then
  bool remove(Id id, const Done& done);
  void clear(const Done& done);
  bool full() const { return active_.size() >= kMost; }

  /// As docs/reference/requests.md describes it, in the order in which they began.
  nlohmann::json list();

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
  void begin_hang(const fault::Fault& fault, const Begun& begun);
  void end_later(Id id);
  void mend(fault::Name name, const Done& done);
  void mend_cpu(const Done& done);
  void forget_cpu_faults();
  LineBreaker& breaker_of(const fault::Fault& fault);
  void wait_for(const LineBreaker& line, const Done& done);
  void drop_ended(core::Time now);
  /// What the lines say of their faults that have not ended by then, by line and id there.
  using OfLines = std::map<std::pair<const LineBreaker*, fault::LineFaults::Id>, fault::LineFaults::Listed>;
  OfLines of_lines(core::Time now) const;
  std::uint64_t cpu_hits(fault::Name fault) const;

  boost::asio::io_context& io_;
  fault::RingNodes nodes_;
  NodeDriver& driver_;
  CpuFaults cpu_;
  Id last_id_ = 0;
  std::map<Id, Active> active_;
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by waits
};

}  // namespace limb_ring::runtime
