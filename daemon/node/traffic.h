#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "node/node_driver.h"

namespace limb_ring::runtime {

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
  /// @return false where too many runs are under way
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

}  // namespace limb_ring::runtime
