#include "tools/ringctl/seen_packets.h"

#include <deque>

#include "tools/ringctl/capture_names.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/dump_filter.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/tell_user.h"
#include "wire/capture_file.h"

namespace limb_ring::ringctl {

namespace {

using std::chrono::steady_clock;

/// Of a live capture the latest so many are kept: about 70 bytes each.
constexpr std::size_t kWindow = 1000000;

/// Keeps the latest packets until its time is over.
class Window final : public CaptureSink {
 public:
  explicit Window(std::chrono::nanoseconds how_long) : end_(steady_clock::now() + how_long) {}

  void packet(const CapturedPacket& packet) override {
    lost_ += packet.lost_before;
    packets_.push_back(capture::seen(packet));
    if (packets_.size() <= kWindow) return;
    packets_.pop_front();
    ++lost_;
  }
  void event(const capture::CapturedEvent& event) override {
    if (events_.size() < kWindow) events_.push_back(event);
  }
  bool flush() override { return steady_clock::now() < end_; }

  SeenPackets take(capture::RingNames names) const {
    return {std::move(names), {packets_.begin(), packets_.end()}, events_, lost_};
  }

 private:
  steady_clock::time_point end_;
  std::deque<capture::SeenPacket> packets_;
  std::vector<capture::CapturedEvent> events_;
  std::uint64_t lost_ = 0;
};

}  // namespace

void tell_problems(const capture::PcapngReader& reader) {
  for (const std::string& problem : reader.problems()) tell_user(problem);
}

SeenPackets packets_of_file(const std::string& path) {
  capture::CaptureFile file(path);
  capture::PcapngReader& reader = file.reader();
  SeenPackets seen;
  const auto read = [&] {
    while (const auto record = reader.next()) {
      if (const auto* event = std::get_if<capture::CapturedEvent>(&*record)) seen.events.push_back(*event);
      const auto* packet = std::get_if<CapturedPacket>(&*record);
      if (packet == nullptr) continue;
      seen.packets.push_back(capture::seen(*packet));
      seen.lost += packet->lost_before;
    }
  };
  while_telling({}, read, "reading " + path);
  seen.names = reader.names();
  tell_problems(reader);
  return seen;
}

SeenPackets packets_of_ring(const std::string& ring, std::chrono::nanoseconds how_long) {
  const RingAccess access = RingAccess::open(choose_ring(ring));
  capture::Choice choice;
  choice.filter.output = true;
  Window window(how_long);
  const DumpTotals totals =
      LiveDump(access, access.nodes_here(), {{"kinds", {"state", "link", "pin", "cpu"}}, {"packets", order_of(choice)}},
               window)
          .run(0);
  if (totals.all_gone) throw HostPortError("no daemon is left to look at");
  return window.take(names_of(access));
}

}  // namespace limb_ring::ringctl
