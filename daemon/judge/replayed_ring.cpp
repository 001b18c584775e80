#include "judge/replayed_ring.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <variant>

#include "core/ring_order.h"
#include "judge/flight_recorder.h"
#include "judge/record.h"
#include "wire/packet_assembler.h"

namespace limb_ring::recorder {
namespace {

using std::chrono::nanoseconds;

// Only a regular file: reading a pipe or a device might never end.
std::vector<std::uint8_t> bytes_of_file(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw std::runtime_error("is not a file; allowed: a regular file");
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) throw std::runtime_error("cannot be read");
  return bytes;
}

}  // namespace

ReplayedLife::ReplayedLife(std::string file, std::vector<std::uint8_t> saved, PacketData& data)
    : file_(std::move(file)),
      saved_(std::move(saved)),
      recording_(read_saved({saved_.data(), saved_.size()})),
      replay_(recording_, data),
      began_(machine_time(replay_.next())) {}

nanoseconds ReplayedLife::machine_time(core::Time at) const {
  return nanoseconds(title().zero) + core::whole_nanoseconds(at.time_since_epoch());
}

ReplayedRing::ReplayedRing(const std::string& folder) {
  for (const std::string& path : recordings_in(folder)) {
    try {
      lives_.push_back(std::make_unique<ReplayedLife>(path, bytes_of_file(path), data_));
    } catch (const std::exception& problem) {
      throw std::runtime_error(path + ": " + problem.what());
    }
    const std::string &ring = lives_.back()->title().ring, &first = lives_.front()->title().ring;
    if (ring != first)
      throw std::runtime_error(path + ": is of ring " + ring + ", and " + lives_.front()->file() + " is of ring " +
                               first + "; allowed: recordings of one ring");
  }
  if (lives_.empty()) throw std::runtime_error(folder + ": no recordings are there; 'ringctl record save' makes them");
  const auto first = std::min_element(lives_.begin(), lives_.end(),
                                      [](const auto& a, const auto& b) { return a->began() < b->began(); });
  began_ = (*first)->began();
}

ReplayedLife* ReplayedRing::step(nanoseconds until) {
  ReplayedLife* next = nullptr;
  nanoseconds at = began_ + until;
  for (const auto& life : lives_) {
    Replay& replay = life->replay();
    if (replay.next() == core::kNever || replay.difference()) continue;
    const nanoseconds due = life->machine_time(replay.next());
    if (due > at || (next != nullptr && due == at)) continue;
    next = life.get();
    at = due;
  }
  if (next != nullptr) next->replay().step();
  return next;
}

using promises::NodeObserver;
using promises::Observation;
using promises::PromiseJudge;

namespace {

/// Rounds after the last record, so that everything that can be judged is.
constexpr int kLastRounds = 4;

}  // namespace

/// One life, as its recorder has seen it.
class ReplayedPromises::NodeHistory final : promises::ObservationSink {
 public:
  NodeHistory(ReplayedLife& life, PromiseJudge& judge, core::Duration goes_on)
      : judge_(judge),
        id_(life.node()),
        observer_(
            life.title().settings, nanoseconds(life.title().zero),
            [&life] { return life.replay().controller().received_waiting(); }, *this, goes_on) {}

  void see(const Replay& replay) {
    const Record& record = replay.last();
    if (const auto* input = std::get_if<core::Input>(&record.what)) observer_.goes_in(*input, record.at);
    if (const auto* event = std::get_if<core::Event>(&record.what)) observer_.taken(*event, record.at);
    if (std::holds_alternative<Taken>(record.what)) observer_.taken(replay.taken(), record.at);
  }

 private:
  void put(const Observation& seen) override { judge_.see(id_, seen); }

  PromiseJudge& judge_;
  std::uint8_t id_;
  NodeObserver observer_;
};

ReplayedPromises::ReplayedPromises(ReplayedRing& ring, const promises::JudgeTimes& times, core::Duration goes_on,
                                   nanoseconds round)
    : ring_(ring),
      goes_on_(goes_on),
      round_(round),
      round_ends_(ring.began() + round),
      judge_(
          ring.lives().front()->title().settings.fold_back,
          [this](const promises::Breach& breach) { breaches_.push_back(breach); }, times) {}

ReplayedPromises::~ReplayedPromises() = default;

void ReplayedPromises::begin(ReplayedLife& life) {
  const auto state = static_cast<std::uint8_t>(life.replay().controller().membership().state());
  judge_.begins(life.node(), state, promises::longest_send(life.title().settings), life.began().count());
  histories_[&life] = std::make_unique<NodeHistory>(life, judge_, goes_on_);
}

// If a later life of the node follows, the process ended here. Otherwise the file was merely saved before the others,
// and what other nodes did after its last record cannot be judged.
void ReplayedPromises::end(ReplayedLife& life) {
  const auto follows = [&](const auto& other) { return other->node() == life.node() && other->began() > life.began(); };
  if (std::any_of(ring_.lives().begin(), ring_.lives().end(), follows) && !life.replay().difference())
    judge_.ends(life.node());
  else
    judge_.leaves(life.node());
}

void ReplayedPromises::has_done(ReplayedLife& life) {
  const Record& record = life.replay().last();
  for (const nanoseconds now = life.machine_time(record.at); now >= round_ends_; round_ends_ += round_)
    judge_.round_is_over();
  if (histories_.count(&life) == 0) begin(life);
  if (!life.replay().difference()) histories_[&life]->see(life.replay());
  if (life.replay().difference() || life.replay().next() == core::kNever) end(life);
}

void ReplayedPromises::finish() {
  for (int i = 0; i < kLastRounds; ++i) judge_.round_is_over();
}

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

class ReplayCapture::NodeTap : public core::Tap {
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
