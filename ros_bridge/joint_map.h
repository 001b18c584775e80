#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// Which node owns which joint, by the ring's configuration.
class JointMap {
 public:
  struct Place {
    std::size_t node;   ///< in ring order
    std::size_t joint;  ///< in the node's configured order
  };

  explicit JointMap(const config::RingConfig& ring);
  std::optional<Place> find(const std::string& joint) const;
  std::uint8_t id(std::size_t node) const { return ids_[node]; }
  std::size_t joints(std::size_t node) const { return counts_[node]; }
  std::size_t nodes() const { return ids_.size(); }
  /// The joint that this one follows without a motor of its own; empty: it follows none.
  std::string leader_of(const std::string& joint) const;
  /// All joints, separated by commas.
  const std::string& names() const { return names_; }

 private:
  std::vector<std::uint8_t> ids_;
  std::vector<std::size_t> counts_;
  std::unordered_map<std::string, Place> places_;
  std::unordered_map<std::string, std::string> leaders_;
  std::string names_;
};

}  // namespace limb_ring::bridge
