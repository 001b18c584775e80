#include "judge/replay.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "core/ring_order.h"
#include "judge/flight_recorder.h"
#include "judge/record.h"
#include "wire/packet_assembler.h"

namespace limb_ring::recorder {
namespace {

using core::NetworkController;
namespace input = core::input;

const char* const kInputNames[] = {"input_up", "input_lost",  "input_gap", "output_up", "output_lost", "output_ready",
                                   "receive",  "send",        "interrupt", "pull",      "cancel",      "cpu_reset",
                                   "cpu",      "cpu_present", "timeout",   "run"};
static_assert(std::size(kInputNames) == std::variant_size_v<core::Input>);

template <class T>
std::string in_words(T what, TextArchive::Form form = TextArchive::Form::one_line) {
  TextArchive text(form);
  what.archive(text);
  return text.text();
}

std::string lines_of(NetworkController& controller) {
  TextArchive text(TextArchive::Form::lines);
  controller.archive(text);
  return text.text();
}

/// The first line that differs, of both.
std::pair<std::string, std::string> first_difference(const std::string& a, const std::string& b) {
  std::istringstream in_a(a), in_b(b);
  std::string line_a, line_b;
  for (;;) {
    const bool more_a = static_cast<bool>(std::getline(in_a, line_a));
    const bool more_b = static_cast<bool>(std::getline(in_b, line_b));
    if (!more_a) line_a = "nothing";
    if (!more_b) line_b = "nothing";
    if (line_a != line_b || (!more_a && !more_b)) return {line_a, line_b};
  }
}

}  // namespace

Replay::Replay(const Recording& recording, PacketData& data) : recording_(recording), reader_({}, {}), data_(data) {
  if (recording.title.layout != state_layout())
    throw std::runtime_error("the recorded core is not this program's: recorded by limb_ring " +
                             recording.title.program + ", or by one built from other sources");
  begin_half(0);
  read_next();
}

void Replay::begin_half(std::size_t half) {
  half_ = half;
  core::StateReader bytes(recording_.halves[half].bytes);
  core::Time begun{};
  bytes("time", begun);
  auto controller = std::make_unique<NetworkController>(recording_.title.settings, begun);
  controller->archive(bytes);
  if (bytes.failed()) throw std::runtime_error("the recorded state is damaged");
  reader_ = RecordReader(bytes.rest(), begun);
  controller->set_tap(tap_);
  controller->set_journal(journal_);
  std::swap(controller, controller_);
  holds_unseen_ = controller_->holds_packets();
  if (controller == nullptr) return;  // the first half
  if (bytes_of(*controller) == bytes_of(*controller_)) return;
  const auto lines = first_difference(lines_of(*controller_), lines_of(*controller));
  differ("the state", lines.first, lines.second);
}

void Replay::read_next() {
  next_.reset();
  if (reader_.complete()) {
    if (half_ + 1 == recording_.halves.size()) return;
    begin_half(half_ + 1);
  }
  next_ = reader_.next();
  if (!next_) throw std::runtime_error("a record is damaged");
}

bool Replay::step() {
  if (!next_ || difference_) return false;
  last_ = *next_;
  ++records_;
  if (auto* input = std::get_if<core::Input>(&last_.what)) {
    if (auto* call = std::get_if<input::Receive>(input)) look_at_data(*call);
    controller_->apply(*input, last_.at);
  } else if (const auto* written = std::get_if<Written>(&last_.what)) {
    compare(*written);
  } else if (const auto* event = std::get_if<core::Event>(&last_.what)) {
    core::Event replayed;
    const bool taken = controller_->take_event(last_.at, replayed);
    compare(*event, "an event", taken, replayed);
  } else {
    const bool taken = controller_->take(last_.at, taken_);
    compare(std::get<Taken>(last_.what), "a packet for the CPU", taken, taken ? Taken(taken_) : Taken());
  }
  read_next();
  return !difference_;
}

void Replay::look_at_data(input::Receive& taken_in) {
  wire::ByteView& bytes = taken_in.slice.bytes;
  if (last_.data_left_out) {
    std::copy(bytes.begin(), bytes.end(), packet_.begin());  // they lie in the reader, which reads on
    bytes.data = packet_.data();
    last_.data_left_out = !data_.fill_in(packet_.data(), bytes.size);
  } else if (can_be_abridged(taken_in.slice)) {
    if (taken_in.slice.crc_good())
      data_.keep(bytes);
    else
      damaged_.insert(key_of({bytes}));
  } else if (taken_in.slice.kind == wire::SliceKind::end) {
    holds_unseen_ = true;
  }
}

void Replay::compare(const Written& written) {
  wire::SliceWriter& output = controller_->output(written.line);
  std::vector<std::uint8_t> room(output.view().size);  // abridged it is shorter
  core::StateWriter replayed(room.data(), room.size());
  put_slices(replayed, output.view());
  const wire::ByteView bytes{room.data(), replayed.size()};
  if (bytes.size != written.slices.size || !std::equal(bytes.begin(), bytes.end(), written.slices.begin()))
    differ(written.line == core::Line::first ? "bytes for the line" : "bytes for the second line", in_words(written),
           in_words(Written{written.line, bytes}));
  wire::each_slice(output.view(), [this](const wire::Slice& slice) { look_at_data(slice); });
  output.clear();
  holds_unseen_ = holds_unseen_ && controller_->holds_packets();
}

// Of a packet the CRC was compared, but not its data, which has to fit. What has come in damaged goes on damaged.
void Replay::look_at_data(const wire::Slice& given_out) {
  if (!can_be_abridged(given_out)) return;
  const wire::PacketFields packet{given_out.bytes};
  const bool own = packet.source() == controller_->settings().id;
  if (given_out.crc_good()) {
    if (own) data_.keep(given_out.bytes);
  } else if ((own || data_.knows(given_out.bytes)) && !holds_unseen_ && damaged_.count(key_of(packet)) == 0) {
    differ("the data of a packet", "that of its CRC", "other data");
  }
}

template <class T>
void Replay::compare(const T& recorded, const char* what, bool taken, const T& replayed) {
  if (!taken) return differ(what, in_words(recorded), "none");
  if (bytes_of(recorded) != bytes_of(replayed)) differ(what, in_words(recorded), in_words(replayed));
}

void Replay::differ(std::string what, std::string recorded, std::string replayed) {
  if (!difference_) difference_ = Difference{last_.at, std::move(what), std::move(recorded), std::move(replayed)};
}

std::string describe_state(core::NetworkController& controller) {
  NetworkController fresh(controller.settings(), core::Time{});
  std::istringstream usual(lines_of(fresh)), now(lines_of(controller));
  std::set<std::string> known;
  std::string line, text;
  while (std::getline(usual, line)) known.insert(line);
  while (std::getline(now, line))
    if (known.count(line) == 0) text += line + '\n';
  return text;
}

std::string describe(const Record& record) {
  if (const auto* call = std::get_if<core::Input>(&record.what)) {
    const std::string words = std::visit([](const auto& what) { return in_words(what); }, *call);
    return std::string(kInputNames[call->index()]) + (words.empty() ? "" : " " + words) +
           (record.data_left_out ? ", whose data was not recorded" : "");
  }
  if (const auto* written = std::get_if<Written>(&record.what)) return "written " + in_words(*written);
  if (const auto* event = std::get_if<core::Event>(&record.what)) return "event " + in_words(*event);
  return "taken " + in_words(std::get<Taken>(record.what));
}

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
