#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "client/host_message.h"
#include "config/ring_config.h"
#include "core/time.h"
#include "io/node_clock.h"
#include "node/node_driver.h"
#include "node/session.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// How fast, at most, the time of a virtual ring goes on compared with real time. If the machine is slower, the ring
/// falls behind. It catches up by at most kMostBehind; the rest is lost.
class Pace {
 public:
  using Real = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::milliseconds kMostBehind{100};

  /// @param factor virtual per real time, > 0; infinite: as fast as the machine and the programs are
  Pace(double factor, Real now) : factor_(factor), real_(now) {}

  double factor() const { return factor_; }
  /// Sets the factor from now on; the ring is at `reached`.
  void set_factor(double factor, Real now, core::Time reached);
  /// The ring's time has stood until now: it must not catch up for that.
  void restart(Real now, core::Time reached);
  /// How far the ring, which is at `reached`, may go on by now.
  core::Time allowed(Real now, core::Time reached);
  /// When the ring may reach `time`.
  Real when(core::Time time) const;
  /// How late the ring is, being at `reached` now; 0: it is not, or goes as fast as it can.
  std::chrono::nanoseconds late(Real now, core::Time reached) const;
  /// Real time that was not made up for.
  std::chrono::nanoseconds lost() const { return lost_; }

 private:
  double factor_;
  Real real_;             ///< then ...
  core::Time virtual_{};  ///< ... it was this
  std::chrono::nanoseconds lost_{0};
};

/// How far, and at which pace, the time of a virtual ring may go on. Clients can pause it, step it, or make it follow
/// an outer clock.
class Steering final : public runtime::ClockControl {
 public:
  /// @param ring outlives this
  explicit Steering(sim::VirtualRing& ring) : ring_(ring) {}
  /// Time goes on at this pace, which outlives the run.
  void use(Pace& pace) { pace_ = &pace; }
  /// Time stands until allow().
  void follow() { follows_ = true; }

  // From clients.
  State state() const override;
  void set_pace(double factor) override;
  void pause() override;
  void run() override;
  void step(nanoseconds time, std::function<void()> done) override;
  bool allow(nanoseconds until, nanoseconds outer_zero) override;
  void went_on_without(const std::string& whom) override { left_behind_ = whom; }

  /// Whom time has last gone on without; empty: nobody.
  const std::string& left_behind() const { return left_behind_; }
  core::Time limit() const;
  /// To be called when all programs wait. @return true if the ring's time has reached the limit and must stand
  bool holds();

 private:
  void end_steps();

  sim::VirtualRing& ring_;
  Pace* pace_ = nullptr;
  core::Time pause_at_ = core::kNever;
  std::vector<std::function<void()>> steps_;  ///< who waits for pause_at_
  bool follows_ = false;
  core::Time allowed_{};
  nanoseconds outer_zero_{0};
  std::string left_behind_;
};

/// The clock of a virtual ring, counted from its start. At one of its nodes it takes the place of the machine's clock.
class VirtualClock final : public event_loop::NodeClock {
 public:
  /// @param ring outlives this, and this its timers
  /// @param on_expired called when a timer has run out
  explicit VirtualClock(
      sim::VirtualRing& ring, std::function<void()> on_expired = [] {})
      : ring_(ring), on_expired_(std::move(on_expired)) {}

  /// Rounded up to ns, so that a wait until then never ends early.
  static Time at(core::Time when);
  static core::Time ring_time(Time when) { return core::Time{} + when.time_since_epoch(); }

  Time now() const override;
  std::int64_t wall_ns(Time when) override { return when.time_since_epoch().count(); }
  /// Runs out in the ring's own time, before any node acts in that instant.
  std::unique_ptr<event_loop::Timer> timer(std::function<void()> on_time) override;
  /// Calls `call` once at `when`, as a timer would; it cannot be cancelled. Not called once this clock is gone.
  void call_at(core::Time when, std::function<void()> call);

  /// @name A frozen node: timers that run out meanwhile are called when it is thawed
  ///@{
  void freeze() { frozen_ = true; }
  void thaw();
  ///@}

 private:
  void due(const std::function<void()>& call);

  sim::VirtualRing& ring_;
  std::function<void()> on_expired_;
  bool frozen_ = false;
  std::vector<std::function<void()>> missed_;  ///< in the order in which they were due
  std::shared_ptr<VirtualClock*> self_ = std::make_shared<VirtualClock*>(this);
};

/// What a CPU in lockstep sends enters its node later than its turn began, as the computing of a real one takes time.
/// All else passes at once.
class Turnaround final : public host::HostHandler {
 public:
  /// All but `cpu` outlive this. @param clock of the node
  Turnaround(host::HostHandler& calls, sim::VirtualRing& ring, VirtualClock& clock, const config::CpuConfig& cpu,
             std::uint64_t seed)
      : calls_(calls), ring_(ring), clock_(clock), cpu_(cpu), random_(seed) {}

  void on_greeted(pid_t pid) override { calls_.on_greeted(pid); }
  void on_left(pid_t pid) override { calls_.on_left(pid); }
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo& client) override;
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override {
    calls_.on_request(client, request);
  }
  bool changes_something(const client::JsonRequest& request) const override {
    return calls_.changes_something(request);
  }
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override {
    calls_.on_observe(client, request);
  }
  void on_shortage(const std::string& why) override { calls_.on_shortage(why); }
  void on_alive(host::ClientId client) override { calls_.on_alive(client); }
  void on_credit(host::ClientId client) override { calls_.on_credit(client); }

 private:
  core::Time entry();
  template <class Call>
  void later(host::ClientId client, Call call);

  host::HostHandler& calls_;
  sim::VirtualRing& ring_;
  VirtualClock& clock_;
  config::CpuConfig cpu_;
  std::mt19937_64 random_;
  std::set<host::ClientId> late_;  ///< CPUs in lockstep that are attached
  core::Time turn_{core::Duration{-1}};
  core::Time entry_{};
};

}  // namespace limb_ring::virtual_host
