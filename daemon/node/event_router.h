#pragma once

#include <array>
#include <boost/circular_buffer.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "config/watchdog.h"
#include "core/counters.h"
#include "core/time.h"
#include "io/throttle.h"
#include "judge/percentiles.h"
#include "node/cpu_socket.h"
#include "node/faults.h"
#include "node/host_server.h"
#include "node/neighbour_watch.h"
#include "node/node_driver.h"
#include "node/node_folder.h"
#include "node/observers.h"
#include "node/pin_board.h"
#include "node/send_reason.h"

namespace limb_ring::runtime {

/// The damaged packets that came in within the last 10 s: what a line is now. Counters only tell what it has ever been.
/// (ours)
class LatelyDamaged {
 public:
  static constexpr std::chrono::seconds kWindow{10};
  struct Counts {
    std::uint64_t crc_errors = 0, returns_damaged = 0;
    core::Duration oldest{0};  ///< since the first of them; one second is counted as a whole
  };

  void look(core::Time now, const core::Counters& counters) {
    if (counters.crc_errors == crc_errors_ && counters.returns_damaged == returns_damaged_) return;
    if (seconds_.empty() || now - seconds_.back().begin >= std::chrono::seconds(1)) seconds_.push_back({now, 0, 0});
    while (now - seconds_.front().begin > kWindow) seconds_.pop_front();
    seconds_.back().crc_errors += counters.crc_errors - crc_errors_;
    seconds_.back().returns_damaged += counters.returns_damaged - returns_damaged_;
    crc_errors_ = counters.crc_errors;
    returns_damaged_ = counters.returns_damaged;
  }

  Counts counts(core::Time now) const {
    Counts all;
    for (auto second = seconds_.rbegin(); second != seconds_.rend() && now - second->begin <= kWindow; ++second) {
      all.crc_errors += second->crc_errors;
      all.returns_damaged += second->returns_damaged;
      all.oldest = now - second->begin;
    }
    return all;
  }

 private:
  struct Second {
    core::Time begin;
    std::uint64_t crc_errors, returns_damaged;
  };
  std::deque<Second> seconds_;
  std::uint64_t crc_errors_ = 0, returns_damaged_ = 0;
};

/// The round trips of a node's sends and beacons of the last minute, 4096 at most. One pause of the machine is
/// forgotten after that time.
class RoundTrips {
 public:
  static constexpr std::size_t kKept = 4096;
  static constexpr core::Duration kWithin = std::chrono::seconds(60);

  void add(core::Time now, core::Duration round_trip) { last_.push_back({now, round_trip}); }

  status::RoundTrips row(core::Time now) const {
    std::vector<core::Duration> lately;
    status::RoundTrips row;
    for (const Ended& one : last_) {
      if (now - one.at > kWithin) continue;
      if (lately.empty()) row.since_s = std::chrono::duration<double>(now - one.at).count();
      lately.push_back(one.round_trip);
    }
    const statistics::Percentiles p = statistics::percentiles(lately);
    row.samples = p.samples;
    if (p.samples == 0) return row;
    row.min = p.min;
    row.p50 = p.p50;
    row.p99 = p.p99;
    row.max = p.max;
    return row;
  }

 private:
  struct Ended {
    core::Time at;
    core::Duration round_trip;
  };
  boost::circular_buffer<Ended> last_{kKept};
};

/// One run of packets, each sent as the last one ends.
struct TrafficRequest {
  wire::NodeId to{0};
  std::uint64_t count = 10;               ///< packets, 1 to kMostPackets
  std::chrono::milliseconds duration{0};  ///< no new packet after it; 0: `count` alone decides
  std::size_t size = wire::kMaxPayload;   ///< bytes of data, 1 to 512
  std::uint8_t priority = 2;
  std::chrono::microseconds interval{0};      ///< 0: the next as the last returns
  std::chrono::milliseconds deadline{60000};  ///< the run ends then, finished or not
};

/// Makes traffic inside the daemon and times it from first byte out to matched return: ping and
/// benchmarks, with no process between. At most kMostRuns at a time.
class Traffic {
 public:
  using Done = std::function<void(const nlohmann::json& report)>;
  static constexpr std::uint64_t kMostPackets = 1'000'000;
  static constexpr std::size_t kMostRuns = 32;

  explicit Traffic(NodeDriver& driver) : driver_(driver) {}

  /// `done` gets {"sent","delivered","lost","other","reasons","round_trip_us","seconds",...} once.
  /// @return false if too many runs are under way
  bool start(const TrafficRequest& request, Done done);
  /// @param reason why it was not delivered, for people
  void on_ended(const core::SendEnded& ended, const std::string& reason);
  void stop() { runs_.clear(); }

 private:
  struct Run {
    Run(TrafficRequest r, Done d) : request(std::move(r)), done(std::move(d)) {}
    TrafficRequest request;
    Done done;
    std::unique_ptr<event_loop::Timer> next, deadline;
    std::uint64_t sent = 0;
    bool overdue = false;
    core::Time begun{};
    core::Time last_end{};
    std::array<std::uint64_t, wire::kOutcomes> outcomes{};
    std::map<std::string, std::uint64_t> reasons;  ///< of those not delivered
    std::vector<core::Duration> round_trips;
    std::array<std::uint8_t, wire::kMaxPayload> data{};
  };

  void overdue(std::uint32_t id);
  void send(std::uint32_t id, Run& run);
  void send_next(std::uint32_t id);
  void finish(std::uint32_t id);
  static bool complete(const Run& run);
  static nlohmann::json report(Run& run);

  NodeDriver& driver_;
  std::uint32_t last_id_ = 0;
  std::map<std::uint32_t, std::unique_ptr<Run>> runs_;
};

/// The one place that knows where events of a node go: what comes out of its network controller, what becomes of its
/// CPU, and what its watchdog finds.
class EventRouter final : public DriverListener {
 public:
  /// All must outlive the router; they may be built after it.
  struct Receivers {
    const config::NodeConfig& node;
    std::string log_prefix;
    const SendReasons& reasons;
    NodeDriver& driver;
    host::HostServer& host;
    NodeFolder& folder;
    CpuSocket& cpu;
    PinBoard& pins;
    Traffic& traffic;
    DaemonInterrupts& interrupts;
    Faults& faults;
    RoundTrips& round_trips;
    Observers& observers;
    LatelyDamaged& lately_damaged;
    NeighbourWatch& neighbours;
  };
  explicit EventRouter(const Receivers& receivers) : to_(receivers) {}

  void on_event(const core::Event& event) override;
  void on_round_end() override;
  void on_link(const LinkChange& change) override;

  /// Something that status shows of the own CPU has changed.
  void on_cpu_changed();
  /// Pin `factor` of this node was pulled, by an INTP, or here for what is asked of all nodes; `clock_ns`: when.
  void pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns);
  void on_finding(const watchdog::Watchdog::Finding& finding);

 private:
  void handle(const core::SendEnded& ended);
  void handle(const core::PinPulled& pin);
  void handle(const core::StateChanged& change);
  void handle(const core::PeerChanged& peer) { to_.interrupts.on_cpu_changed(peer.node); }
  void handle(const core::BeaconHome& beacon) { to_.round_trips.add(to_.driver.now(), beacon.round_trip); }
  void tell_client(host::ClientId client, const core::SendEnded& ended);
  void look_at_neighbours();
  void log(process::Throttle& lines, std::string_view what) const;

  Receivers to_;
  struct Lines : process::Throttle {
    Lines() : Throttle(std::chrono::seconds(1), 20) {}
  };
  // A neighbour that calls, or comes and goes, without end fills no log.
  std::array<Lines, config::kPins> pin_lines_;
  Lines link_lines_, state_lines_;
  std::uint32_t cpu_boots_ = 0;
};

}  // namespace limb_ring::runtime
