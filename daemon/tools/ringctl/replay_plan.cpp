#include "tools/ringctl/replay_plan.h"

#include <map>
#include <tuple>

#include "tools/common/packet_text.h"
#include "wire/packet.h"
#include "wire/packet_filter.h"

namespace limb_ring::ringctl {

namespace {

using capture::PacketView;

/// Where packets were seen: whether at a node's input, and the line's two nodes (from, to).
using Place = std::tuple<bool, wire::NodeId, wire::NodeId>;
/// What a retry has in common with the try before: destination and sequence number.
using Mark = std::pair<wire::NodeId, std::uint8_t>;

Place place_of(const CapturedPacket& packet) {
  return {packet.info.input, wire::NodeId{packet.info.from}, wire::NodeId{packet.info.to}};
}

class Planner {
 public:
  void read(capture::PcapngReader& reader) {
    while (auto record = reader.next())
      if (auto* packet = std::get_if<CapturedPacket>(&*record)) sort(std::move(*packet));
  }

  ReplayPlan plan() {
    for (const CapturedPacket& packet : packets_) take(packet);
    return std::move(plan_);
  }

 private:
  void sort(CapturedPacket packet) {
    const PacketView view{{}, packet.info, app::bytes_of(packet)};
    if (!view.whole() || packet.info.crc_bad) {
      ++plan_.broken;
      return;
    }
    if (kind_of(view) == capture::Kind::control) {
      ++plan_.control;
      return;
    }
    choose_place(packet);
    packets_.push_back(std::move(packet));
  }

  void choose_place(const CapturedPacket& packet) {
    const wire::NodeId source = app::fields_of(packet).source();
    const auto [place, added] = places_.emplace(source, place_of(packet));
    const bool out_of_it = packet.info.from == source, had_that = std::get<1>(place->second) == source;
    if (!added && out_of_it && !had_that) place->second = place_of(packet);
  }

  void take(const CapturedPacket& packet) {
    const wire::PacketFields fields = app::fields_of(packet);
    if (places_[fields.source()] != place_of(packet)) {
      ++plan_.elsewhere;
      return;
    }
    const Mark mark{fields.destination(), fields.code().sequence};
    const auto [last, added] = last_.emplace(std::pair{fields.source(), fields.code().interrupt}, mark);
    if (!added && packet.info.retry && last->second == mark) {
      ++plan_.repeated;
      return;
    }
    last->second = mark;
    add(packet, fields);
  }

  void add(const CapturedPacket& packet, const wire::PacketFields& fields) {
    if (plan_.sends.empty()) first_ns_ = packet.time_ns;
    const wire::ByteView data = fields.data();
    plan_.sends.push_back({packet.time_ns - first_ns_,
                           fields.source(),
                           fields.destination(),
                           fields.code().interrupt,
                           fields.last(),
                           {data.begin(), data.end()}});
  }

  std::vector<CapturedPacket> packets_;
  std::map<wire::NodeId, Place> places_;
  std::map<std::pair<wire::NodeId, bool>, Mark> last_;
  std::int64_t first_ns_ = 0;
  ReplayPlan plan_;
};

}  // namespace

ReplayPlan plan_replay(capture::PcapngReader& reader) {
  Planner planner;
  planner.read(reader);
  return planner.plan();
}

}  // namespace limb_ring::ringctl
