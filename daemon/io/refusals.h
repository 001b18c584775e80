#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "io/endpoint.h"

namespace limb_ring::link {

/// The nodes that cannot connect to us at one end of a link: for each the last reason. At most 256.
class Refusals {
 public:
  struct Refusal {
    std::string reason;  ///< for people; "it" is the other node
    Time at{};           ///< when it was said last: a node that is refused asks again many times a second
  };

  void note(std::uint8_t node, std::string reason) { all_[node] = {std::move(reason), Clock::now()}; }
  void forget(std::uint8_t node) { all_.erase(node); }
  const std::map<std::uint8_t, Refusal>& all() const { return all_; }

 private:
  std::map<std::uint8_t, Refusal> all_;
};

}  // namespace limb_ring::link
