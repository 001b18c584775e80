#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <unordered_set>

#include "core/network_controller.h"
#include "judge/packet_data.h"
#include "judge/record_reader.h"
#include "judge/recording.h"

namespace limb_ring::recorder {

/// Where a replayed core does not do what the recorded one did.
struct Difference {
  core::Time at{};
  std::string what;                ///< "bytes for the line", "the state", "an event" ...
  std::string recorded, replayed;  ///< both versions, in words or as bytes
};

/// Feeds the recorded inputs into a core, and compares all its outputs with the recorded ones. (ours)
class Replay {
 public:
  /// @param recording must outlive this
  /// @param data of packets of the ring, for those whose data was left out; must outlive this
  /// @throw std::runtime_error where its core is not of this program
  Replay(const Recording& recording, PacketData& data);

  /// Does the next record. @return false at the end, and where there is a difference
  /// @throw std::runtime_error where what was recorded is damaged
  bool step();
  /// The time of the next record; kNever at the end.
  core::Time next() const { return next_ ? next_->at : core::kNever; }
  /// The record that was done last, with the data that was left out of it if it is known. @pre step() was called
  const Record& last() const { return last_; }
  /// The packet that the CPU has taken. @pre last() is a Taken, and there is no difference()
  const core::ReceivedPacket& taken() const { return taken_; }
  const std::optional<Difference>& difference() const { return difference_; }
  /// The core as it is now. At the end of a half it is replaced by another object, so do not keep the reference.
  core::NetworkController& controller() { return *controller_; }
  /// Sees the packets from now on; may be null.
  void set_tap(core::NetworkController::Tap* tap) {
    tap_ = tap;
    controller_->set_tap(tap);
  }
  core::Time now() const { return last_.at; }
  std::uint64_t records() const { return records_; }

 private:
  void read_next();
  void begin_half(std::size_t half);
  void look_at_data(core::input::Receive& taken_in);
  void compare(const Written& written);
  void look_at_data(const wire::Slice& given_out);
  template <class T>
  void compare(const T& recorded, const char* what, bool taken, const T& replayed);
  void differ(std::string what, std::string recorded, std::string replayed);

  const Recording& recording_;
  std::size_t half_ = 0;
  RecordReader reader_;
  std::unique_ptr<core::NetworkController> controller_;
  core::NetworkController::Tap* tap_ = nullptr;
  PacketData& data_;
  std::optional<Record> next_;
  Record last_;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> packet_{};  ///< of last_, if its data was left out
  core::ReceivedPacket taken_;
  std::unordered_set<std::uint64_t> damaged_;  ///< packets that have come in so, by key_of()
  bool holds_unseen_ = false;                  ///< the core may hold packets that did not come in whole since
  std::optional<Difference> difference_;
  std::uint64_t records_ = 0;
};

/// All members of a core that differ from a new core's, one per line: "membership.ring_size 16".
std::string describe_state(core::NetworkController& controller);
/// One record in a line.
std::string describe(const Record& record);

}  // namespace limb_ring::recorder
