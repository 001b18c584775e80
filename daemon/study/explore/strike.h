#pragma once

#include <string>
#include <vector>

#include "wire/packet.h"

namespace limb_ring::study {

/// What goes wrong in an explored run, just as a slice leaves a node.
struct Strike {
  enum class Kind : std::uint8_t {
    lost,            ///< that slice
    header_damaged,  ///< a bit of its first byte
    data_damaged,    ///< of the one in its middle
    end_damaged,     ///< of its last one: the CRC's, where it ends a packet
    doubled,         ///< its packet
    late,            ///< its line holds it back, and what follows it
    restart,         ///< of a node
    freeze,          ///< of a node, for 3 ms
    cut,             ///< of the line out of a node (of the cable, where the ring folds back), for 3 ms
    interrupt        ///< no fault: a node sends an INTP to the next one
  } kind = Kind::lost;
  wire::NodeId node{0};  ///< of the last four

  bool is_of_node() const { return kind >= Kind::restart; }
};
const char* to_string(Strike::Kind kind);

/// One of them, and at which place of the run: that of the first slice that leaves any node after all have joined is 0.
struct Choice {
  unsigned place = 0;
  Strike strike;
};

/// As `12:lost,20:restart:1`; empty for none.
std::string to_text(const std::vector<Choice>& choices);
/// The same back. @throw std::invalid_argument naming the part that is wrong, and what would be right
std::vector<Choice> choices_from(const std::string& text);

}  // namespace limb_ring::study
