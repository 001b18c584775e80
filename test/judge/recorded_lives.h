#pragma once

#include <memory>
#include <string>
#include <vector>

#include "judge/flight_recorder.h"
#include "judge/recording.h"
#include "judge/replay.h"
#include "sim/virtual_ring.h"

namespace limb_ring::recorder {

/// A recorder and its memory.
struct RecordedLife {
  RecordedLife(core::NetworkController& controller, core::Time now) : memory(FlightRecorder::kLeast / 8) {
    Title title;
    title.settings = controller.settings();
    title.node = "node" + std::to_string(title.settings.id);
    recorder = std::make_unique<FlightRecorder>(controller, reinterpret_cast<std::uint8_t*>(memory.data()),
                                                FlightRecorder::kLeast, title, now, [] {});
  }
  std::vector<std::uint8_t> saved() const {
    return save({reinterpret_cast<const std::uint8_t*>(memory.data()), memory.size() * 8});
  }

  std::vector<std::uint64_t> memory;
  std::unique_ptr<FlightRecorder> recorder;
};

/// Records every life of every node of a ring.
class RecordedLives : public sim::Observer {
 public:
  explicit RecordedLives(sim::VirtualRing& ring) : ring_(ring), lives_(ring.size()) {
    for (const wire::NodeId id : ring.order())
      if (ring.alive(id)) begin(id);
    ring.add_observer(*this);
  }
  void incident(wire::NodeId id, sim::Incident incident, core::Time, core::Line) override {
    if (incident == sim::Incident::killed) end(id);
    if (incident == sim::Incident::started) begin(id);
  }
  /// What was saved of each.
  const std::vector<std::vector<std::uint8_t>>& end_all() {
    for (const wire::NodeId id : ring_.order()) end(id);
    return saved_;
  }

 private:
  void begin(wire::NodeId id) { lives_[id] = std::make_unique<RecordedLife>(ring_.controller(id), ring_.now()); }
  void end(wire::NodeId id) {
    if (lives_[id] != nullptr) saved_.push_back(lives_[id]->saved());
    lives_[id].reset();
  }

  sim::VirtualRing& ring_;
  std::vector<std::unique_ptr<RecordedLife>> lives_;
  std::vector<std::vector<std::uint8_t>> saved_;
};

/// Replays all of it. @return the first difference
inline std::optional<Difference> replayed(const std::vector<std::uint8_t>& saved) {
  const Recording recording = read_saved({saved.data(), saved.size()});
  PacketData data;
  Replay replay(recording, data);
  while (replay.step()) {
  }
  return replay.difference();
}
inline std::string in_words(const std::optional<Difference>& difference) {
  if (!difference) return "";
  return difference->what + ": recorded " + difference->recorded + ", replayed " + difference->replayed;
}

}  // namespace limb_ring::recorder
