#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/archive.h"
#include "core/network_controller.h"
#include "judge/observation_file.h"
#include "judge/promise_judge.h"
#include "judge/record.h"
#include "judge/recording.h"
#include "wire/pcapng.h"

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
  /// @throw std::runtime_error if its core is not of this program
  Replay(const Recording& recording, PacketData& data);

  /// Does the next record. @return false at the end, and if there is a difference
  /// @throw std::runtime_error if what was recorded is damaged
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
  void set_tap(core::Tap* tap) {
    tap_ = tap;
    controller_->set_tap(tap);
  }
  /// Sees what goes in and out from now on; may be null.
  void set_journal(core::Journal* journal) {
    journal_ = journal;
    controller_->set_journal(journal);
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
  core::Tap* tap_ = nullptr;
  core::Journal* journal_ = nullptr;
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

/// Values as text, with the names of their members: all in one line, "from 3 line 0", or one per line with the path to
/// the member, "membership.peers[4].boot 17". (ours)
class TextArchive : public core::Archive<TextArchive> {
 public:
  enum class Form { one_line, lines };
  explicit TextArchive(Form form) : form_(form) {}
  const std::string& text() const { return text_; }

 private:
  friend class core::Archive<TextArchive>;
  void enter(const char* name) {
    lengths_.push_back(path_.size());
    if (*name == 0) return;
    if (form_ == Form::one_line)
      path_ = name;
    else
      path_ += (path_.empty() ? "" : ".") + std::string(name);
  }
  void element(std::size_t i) {
    lengths_.push_back(path_.size());
    if (form_ == Form::lines) path_ += '[' + std::to_string(i) + ']';
  }
  void leave() {
    path_.resize(std::min(path_.size(), lengths_.back()));
    lengths_.pop_back();
  }
  void say(const std::string& value) {
    if (form_ == Form::lines)
      text_ += path_ + ' ' + value + '\n';
    else
      text_ += (text_.empty() ? "" : " ") + path_ + ' ' + value;
  }
  template <class T>
  void plain(const T& what) {
    if constexpr (std::is_same_v<T, core::Int128>) {
      if (what == core::kNever.time_since_epoch().count()) return say("never");
      char text[48];
      std::snprintf(text, sizeof text, "%.12Lf s", static_cast<long double>(what) / 1e12L);
      say(text);
    } else if constexpr (std::is_enum_v<T>) {
      say(std::to_string(static_cast<std::underlying_type_t<T>>(what)));
    } else {
      say(std::to_string(what));
    }
  }
  void bytes(const void* from, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    view({first, size});
  }
  void view(const wire::ByteView& what) {
    std::string hex;
    char digits[3];
    for (const std::uint8_t byte : what) {
      std::snprintf(digits, sizeof digits, "%02x", byte);
      hex += digits;
    }
    say(hex.empty() ? "-" : hex);
  }
  std::size_t count(std::size_t size) { return size; }

  Form form_;
  std::string text_, path_;
  std::vector<std::size_t> lengths_;
};

/// One saved recording: a life of a node, or as much of it as is left.
class ReplayedLife {
 public:
  /// @throw std::runtime_error says what is wrong with it
  /// @param data see Replay
  ReplayedLife(std::string file, std::vector<std::uint8_t> saved, PacketData& data);

  const std::string& file() const { return file_; }
  const Title& title() const { return recording_.title; }
  wire::NodeId node() const { return title().settings.id; }
  Replay& replay() { return replay_; }
  /// `at` on the machine's steady clock, which all nodes of a host share.
  std::chrono::nanoseconds machine_time(core::Time at) const;
  std::chrono::nanoseconds began() const { return began_; }
  /// False if its recording begins in the middle of the life, because the recorder's memory was full.
  bool from_its_start() const { return recording_.halves.front().generation == 1; }

 private:
  std::string file_;
  std::vector<std::uint8_t> saved_;
  Recording recording_;
  Replay replay_;
  std::chrono::nanoseconds began_;
};

/// All that was saved of a ring, replayed in the order of time. (ours)
class ReplayedRing {
 public:
  /// @param folder of `ringctl record save`
  /// @throw std::runtime_error names the file
  explicit ReplayedRing(const std::string& folder);

  std::vector<std::unique_ptr<ReplayedLife>>& lives() { return lives_; }
  const std::vector<std::unique_ptr<ReplayedLife>>& lives() const { return lives_; }
  /// Machine time of the very first record.
  std::chrono::nanoseconds began() const { return began_; }
  /// `machine_time` counted from began().
  std::chrono::nanoseconds after(std::chrono::nanoseconds machine_time) const { return machine_time - began_; }
  /// Does the next record of all, unless it is later than `until` after the first. Each life stops at its first
  /// difference.
  /// @return whose it was; null if nothing is left
  ReplayedLife* step(std::chrono::nanoseconds until);
  /// Of the packets that were replayed last.
  const PacketData& data() const { return data_; }

 private:
  PacketData data_;
  std::vector<std::unique_ptr<ReplayedLife>> lives_;
  std::chrono::nanoseconds began_{0};
};

/// Judges the ring's promises over all nodes of a replayed ring together. A recording may begin in the middle of a
/// life, and end with the process. What cannot be judged because of that is counted. (ours)
class ReplayedPromises {
 public:
  /// @param ring must outlive this
  explicit ReplayedPromises(ReplayedRing& ring, const promises::JudgeTimes& times = {},
                            core::Duration goes_on = std::chrono::milliseconds(50),
                            std::chrono::nanoseconds round = std::chrono::milliseconds(100));
  ~ReplayedPromises();

  /// That life has done one more record.
  void has_done(ReplayedLife& life);
  /// Nothing more will be done.
  void finish();

  const std::vector<promises::Breach>& breaches() const { return breaches_; }
  const promises::JudgeCounts& counts() const { return judge_.counts(); }

 private:
  class NodeHistory;

  void begin(ReplayedLife& life);
  void end(ReplayedLife& life);

  ReplayedRing& ring_;
  core::Duration goes_on_;
  std::chrono::nanoseconds round_, round_ends_;
  std::vector<promises::Breach> breaches_;
  promises::PromiseJudge judge_;
  std::map<ReplayedLife*, std::unique_ptr<NodeHistory>> histories_;
};

/// Writes what is on the lines of a replayed ring as pcapng, by the dates at which it was recorded. (ours)
class ReplayCapture {
 public:
  /// Both must outlive this.
  ReplayCapture(ReplayedRing& ring, std::ostream& out);
  ~ReplayCapture();

 private:
  class NodeTap;
  capture::PcapngWriter writer_;
  std::vector<std::unique_ptr<NodeTap>> taps_;  ///< of each life
};

}  // namespace limb_ring::recorder
