#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/counters.h"
#include "core/events.h"
#include "core/membership/peers.h"

namespace limb_ring::runtime {

/// What is wrong at a node, as status, log and `ringctl traffic judge` tell it.
struct Warning {
  std::string rule;  ///< one word that stays the same: "hop"
  std::string text;  ///< a sentence without the node at which it was found
};

/// Finds neighbours that break the rules of docs/protocol.md, by what this node counts and by others' beacons. Time is
/// an argument. (ours)
///
/// A rule that is broken by ordinary faults, too, is told of only if it is broken more often than they do it.
class NeighbourWatch {
 public:
  static constexpr std::chrono::seconds kLook{1};
  static constexpr unsigned kWindow = 10;  ///< looks
  static constexpr std::chrono::seconds kToldAgain{60};

  /// What the node sees now. The counts are sums of both lines.
  struct Look {
    core::Time now;
    const core::Counters& counters;
    const core::Peers& peers;
    core::NodeState state = core::NodeState::starting;
    std::size_t ring_size = 0;
    std::optional<std::uint8_t> from;   ///< the upstream neighbour on the first line
    std::uint64_t no_slices = 0;        ///< streams and datagrams that held no slice
    std::uint64_t other_session = 0;    ///< datagrams of a session that this node does not have
    std::uint8_t other_session_of = 0;  ///< who has sent the last of them
    std::uint64_t line_losses = 0;      ///< of lines into this node and out of it
    std::string last_loss = {};         ///< for people
  };

  NeighbourWatch(const config::RingConfig& ring, std::uint8_t self) : ring_(ring), self_(self) {}

  bool is_due(core::Time now) const { return now - looked_ >= kLook; }
  /// @return what is to be logged: a warning that is new, or goes on for kToldAgain
  std::vector<std::string> look(const Look& look);
  const std::vector<Warning>& warnings() const { return warnings_; }

 private:
  struct Rule;
  struct Kept {
    std::uint64_t value = 0;
    std::array<std::uint64_t, kWindow> grown{};  ///< by look, the last one first
    unsigned looks = 0;                          ///< in a row at which a state was found
    std::optional<core::Time> told;
  };

  static const std::array<Rule, 8> kCounted;
  std::string name(std::uint8_t node) const { return ring_.name_of(node); }
  std::string upstream(const Look& look) const;
  std::string hop_of_neighbour(const Look& look) const;
  std::string relay_of_neighbour(const Look& look) const;
  bool is_fresh(std::uint8_t node, const Look& look) const;
  void judge(const Rule& rule, Kept& kept, const Look& look, std::vector<std::string>& log);
  void tell(const char* rule, Kept& kept, const std::string& text, const Look& look, std::vector<std::string>& log);

  const config::RingConfig& ring_;
  const std::uint8_t self_;
  core::Time looked_{};
  std::array<Kept, 8> counted_;
  Kept hop_, relay_;
  std::vector<Warning> warnings_;
};

}  // namespace limb_ring::runtime
