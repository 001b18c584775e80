#include "judge/replay_capture.h"

#include "core/ring_order.h"
#include "judge/abridged.h"
#include "wire/packet_assembler.h"

namespace limb_ring::recorder {
namespace {

using core::Line;

capture::RingNames names_of(ReplayedRing& ring) {
  capture::RingNames names{ring.lives().front()->title().ring, {}};
  for (const auto& life : ring.lives()) names.nodes[life->node()] = life->title().node;
  return names;
}

std::string comment_on(wire::ByteView packet, const PacketData& data) {
  if (packet.size < kLeastAbridged || !data.is_made_up(packet)) return {};
  return "not its data: that was not recorded";
}

}  // namespace

class ReplayCapture::NodeTap : public core::NetworkController::Tap {
 public:
  NodeTap(ReplayedLife& life, std::chrono::nanoseconds date, capture::PcapngWriter& writer, const PacketData& data)
      : life_(life), date_(date), in_(to(writer, data)), out_(to(writer, data)) {}
  ~NodeTap() override { life_.replay().set_tap(nullptr); }

  void arrives(const wire::Slice& slice, Line line, core::Time now) override {
    in_.set_line(true, neighbour(line == Line::first ? size() - 1 : 1), life_.node());
    in_.put(slice, at(now));
  }
  void leaves(wire::ByteView framed_slices, Line line, core::Time now) override {
    out_.set_line(false, life_.node(), neighbour(line == Line::first ? 1 : size() - 1));
    wire::each_slice(framed_slices, [&](const wire::Slice& slice) { out_.put(slice, at(now)); });
  }

 private:
  static capture::PacketAssembler::Sink to(capture::PcapngWriter& writer, const PacketData& data) {
    return [&writer, &data](const capture::PacketView& packet) {
      writer.packet(packet.at.count(), packet.info, packet.bytes, 0, comment_on(packet.bytes, data));
    };
  }
  const core::Settings& settings() const { return life_.title().settings; }
  std::size_t size() const { return settings().order.size(); }
  wire::NodeId neighbour(std::size_t lines) const { return core::node_after(settings().order, settings().id, lines); }
  std::chrono::nanoseconds at(core::Time now) const { return life_.machine_time(now) + date_; }

  ReplayedLife& life_;
  std::chrono::nanoseconds date_;
  capture::PacketAssembler in_, out_;
};

// One offset from machine time to dates for all nodes: each read the date when it started, and somebody may have set
// the clock in between.
ReplayCapture::ReplayCapture(ReplayedRing& ring, std::ostream& out) : writer_(out, names_of(ring)) {
  const Title& first = ring.lives().front()->title();
  const std::chrono::nanoseconds date(first.date - first.zero);
  for (const auto& life : ring.lives()) {
    taps_.push_back(std::make_unique<NodeTap>(*life, date, writer_, ring.data()));
    life->replay().set_tap(taps_.back().get());
  }
}

ReplayCapture::~ReplayCapture() = default;

}  // namespace limb_ring::recorder
