#pragma once

#include <cstdint>
#include <vector>

#include "limb_ring/payload/fragment.h"

namespace limb_ring::payload {

/// Cuts messages of one topic into packets, one message after the other. The packets are made
/// one by one as they are asked for, so a sender never queues more than it wants to.
class Fragmenter {
 public:
  explicit Fragmenter(std::uint8_t topic) : topic_(topic) {}

  /// Takes the next message; the rest of the one before is dropped.
  /// @return false, with nothing changed, if it is longer than kMaxMessage
  bool start(Fragment::Kind kind, std::vector<std::uint8_t> message);
  bool done() const { return index_ == count_; }
  /// The next packet, at most 512 bytes.
  /// @pre !done()
  std::vector<std::uint8_t> next();

 private:
  std::uint8_t topic_;
  Fragment::Kind kind_ = Fragment::Kind::data;
  std::vector<std::uint8_t> message_;
  std::uint32_t number_ = 0xFFFFFFFF;  // of the message under way; the first is 0
  std::uint32_t checksum_ = 0;
  std::uint16_t index_ = 0;
  std::uint16_t count_ = 0;
};

}  // namespace limb_ring::payload
