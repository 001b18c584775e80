#pragma once

#include <cstdint>
#include <functional>

#include "core/network_controller.h"
#include "judge/lines_ahead.h"
#include "judge/record_layout.h"
#include "judge/record_writer.h"

namespace limb_ring::recorder {

/// Writes down all that goes into a network controller and comes out of it, into memory of a fixed size: the newest
/// stays. No system call, and of packets that only pass no copy of their data. (ours)
class FlightRecorder final : public core::Journal {
 public:
  /// Least size of its memory, bytes.
  static constexpr std::size_t kLeast = 1u << 18;

  /// It is the controller's journal until it is destroyed.
  /// @param memory zeroes, `size` bytes, at least kLeast, aligned to 8; must outlive this
  /// @param title `layout`, `program` and `half` are filled in
  /// @param on_too_small called if the state of the core does not fit into a half: recording has stopped then
  FlightRecorder(core::NetworkController& controller, std::uint8_t* memory, std::size_t size, Title title,
                 core::Time now, std::function<void()> on_too_small);
  ~FlightRecorder() override { controller_.set_journal(nullptr); }
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// Passes everything on to another journal, too; null: to none. It must outlive this, or the next set_next().
  void set_next(core::Journal* next) {
    next_ = next;
    if (stopped_) controller_.set_journal(next);
  }

  void goes_in(const core::Input& input, core::Time now) override;
  void goes_out(core::Line line, wire::ByteView framed_slices) override;
  void taken(const core::Event& event, core::Time now) override;
  void taken(const core::ReceivedPacket& packet, core::Time now) override;

 private:
  /// Bytes. Enough for all that follows from one input: the outputs of a turn are at most a few largest packets.
  static constexpr std::size_t kMargin = 1u << 15;
  /// Bytes. From here on, where data was left out, the next half begins as soon as the core holds no packet.
  static constexpr std::size_t kSoon = kMargin + kMargin / 4;

  bool half_is_over() const;
  void begin_half();
  void stop();
  /// What was written counts from now on.
  void show();

  core::NetworkController& controller_;
  std::uint8_t* halves_;
  std::size_t half_;  ///< bytes
  std::uint64_t generation_ = 0;
  HalfHead* head_;        ///< of the half in use
  RecordWriter records_;  ///< behind it
  LinesAhead ahead_;      ///< of them
  bool stopped_ = false;
  std::function<void()> on_too_small_;
  core::Journal* next_ = nullptr;
};

}  // namespace limb_ring::recorder
