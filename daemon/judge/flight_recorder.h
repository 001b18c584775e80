#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/network_controller.h"
#include "io/regular_file.h"
#include "judge/record.h"

namespace limb_ring::recorder {

/// Fetches the memory that is written next into the caches. A recorder comes around to memory that is in none of them:
/// without this, each line that it writes waits for its old bytes. (ours)
class LinesAhead {
 public:
  /// Nothing was fetched behind `written`.
  explicit LinesAhead(const std::uint8_t* written) : fetched_(written) {}
  /// @param written up to there, and not less than before
  /// @param left bytes that may be written behind it
  void fetch(const std::uint8_t* written, std::size_t left) {
    if (left < kAhead) return;
    for (const std::uint8_t* const end = written + kAhead; fetched_ < end; fetched_ += kLine)
      __builtin_prefetch(fetched_, 1);
  }

 private:
  static constexpr std::size_t kAhead = 2048;  ///< bytes: some packets, as memory takes a while
  static constexpr std::size_t kLine = 64;     ///< bytes of a line; if they are more, it is fetched twice

  const std::uint8_t* fetched_;
};

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
  /// Bytes. From here on, if data was left out, the next half begins as soon as the core holds no packet.
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

/// A flight recorder whose memory is a file: what it has written is there after the process was killed. (ours)
class RecorderFile {
 public:
  /// An existing file, of the node's previous life, is renamed to `path` + ".former"; if this throws, it stays.
  /// @param size bytes of the file, at least FlightRecorder::kLeast
  /// @param on_too_small see FlightRecorder
  /// @throw std::system_error if it cannot be made
  RecorderFile(const std::string& path, std::size_t size, core::NetworkController& controller, const Title& title,
               core::Time now, std::function<void()> on_too_small);

  /// See FlightRecorder.
  void set_next(core::Journal* next) { recorder_.set_next(next); }
  /// False if it was removed from its folder, or cut off: what is recorded is lost.
  bool is_in_place() const;

 private:
  std::string path_;
  process::MappedFile memory_;
  FlightRecorder recorder_;
};

/// Where the node of that id records, in its ring's runtime folder.
std::string recording_of(const std::string& folder, unsigned id);

/// Names of the recordings in a ring's runtime folder, also of dead nodes: of each node's last life and the one before
/// it, "5.record" and "5.record.former".
std::vector<std::string> recordings_in(const std::string& folder);

/// That recording is of the life before the last.
bool is_of_former_life(const std::string& recording);

/// Saves one of them, also while its node goes on. @return bytes saved
/// @throw std::exception says what is wrong
std::size_t save_file(const std::string& recording, const std::string& to);

}  // namespace limb_ring::recorder
