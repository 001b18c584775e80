#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "config/fault_parse.h"
#include "config/line_faults.h"
#include "support/node_literal.h"
#include "support/packets.h"

namespace limb_ring::fault {

using wire::SliceKind;
using namespace std::chrono_literals;

inline const RingNodes kNodes{{"hip", "10", 0_id}, {"knee", "11", 1_id}, {"ankle", "12", 2_id}};

/// The line hip -> knee: packets go in at the present, and come out as words: "3" is a whole DATP whose data are 3,
/// "start 3", "more", "end", "abort", "INTP 5" (factor 5), with a '!' where it is damaged.
class LineRig {
 public:
  explicit LineRig(std::uint64_t seed = 1, Duration byte_time = Duration{0}) : faults(seed, byte_time) {}

  LineFaults::Id begin(const std::string& words) { return faults.begin(from_words(words, kNodes), now); }

  void whole(unsigned number, std::uint8_t source = 0, std::uint8_t channel = 0) {
    const std::vector<std::uint8_t> bytes = packet(number, source, channel);
    put({SliceKind::whole, {bytes.data(), bytes.size()}});
  }
  /// The parts of a DATP with 16 bytes of data.
  void start(unsigned number) {
    image_ = packet(number, 0, 0);
    put({SliceKind::start, {image_.data(), 8}});
  }
  void more() { put({SliceKind::more, {image_.data() + 8, 8}}); }
  void end() { put({SliceKind::end, {image_.data() + 16, image_.size() - 16}}); }
  void interrupt(std::uint8_t factor) {
    test::InterruptPacket intp;
    intp.factor = wire::Factor{factor};
    const std::vector<std::uint8_t> bytes = encoded(intp);
    put({SliceKind::interrupt, {bytes.data(), bytes.size()}});
  }
  void put(const wire::Slice& slice) {
    faults.pass(slice, now);
    poll();
  }

  /// Polls when the line says so, and no more often.
  void run_for(Duration duration) {
    const Time until = now + duration;
    while (faults.next_deadline() <= until) {
      now = std::max(now, faults.next_deadline());
      poll();
    }
    now = until;
  }
  /// What has come out since the last call.
  std::vector<std::string> came() { return std::exchange(came_, {}); }

  LineFaults faults;
  Time now{};
  bool cut = false;

 private:
  static std::vector<std::uint8_t> packet(unsigned number, std::uint8_t source, std::uint8_t channel) {
    const std::vector<std::uint8_t> data(16, static_cast<std::uint8_t>(number));
    test::DataPacket datp;
    datp.source = NodeId{source};
    datp.destination = 1_id;
    datp.pri = wire::pri_byte(wire::Priority{0}, wire::ChannelId{channel});
    datp.data = {data.data(), data.size()};
    return encoded(datp);
  }

  void poll() {
    cut = faults.cut(now);
    wire::SliceWriter out;
    faults.take(now, out);
    for (wire::ByteView rest = out.view(); !rest.empty();) {
      const wire::SliceParse parse = wire::parse_slice(rest);
      came_.push_back(word_of(parse.slice));
      rest = rest.from(parse.consumed);
    }
  }

  std::string word_of(const wire::Slice& slice) const {
    const auto number = [&](std::size_t at) { return std::to_string(slice.bytes[at]); };
    switch (slice.kind) {
      case SliceKind::whole:
        return number(wire::kHeaderSize) + (wire::PacketFields{slice.bytes}.crc_good() ? "" : "!");
      case SliceKind::interrupt:
        return "INTP " + number(7) + (wire::PacketFields{slice.bytes}.crc_good() ? "" : "!");
      case SliceKind::start:
        return "start " + number(wire::kHeaderSize);
      case SliceKind::more:
        return "more";
      case SliceKind::end:
        return image_.empty() || std::equal(slice.bytes.begin(), slice.bytes.end(), image_.begin() + 16) ? "end"
                                                                                                         : "end!";
      case SliceKind::abort:
        return "abort";
      case SliceKind::idle:
        return "idle";
      case SliceKind::fold:
        return "fold";
    }
    return "";
  }

  std::vector<std::uint8_t> image_;
  std::vector<std::string> came_;
};

}  // namespace limb_ring::fault
