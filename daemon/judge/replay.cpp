#include "judge/replay.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>

#include "judge/record.h"

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

}  // namespace limb_ring::recorder
