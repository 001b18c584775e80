#include "judge/record.h"

#include <algorithm>
#include <utility>

namespace limb_ring::recorder {
namespace {

template <std::size_t... kPlaces>
core::Input input_of(std::uint8_t tag, std::index_sequence<kPlaces...>) {
  core::Input input;
  ((tag == kPlaces ? void(input.emplace<kPlaces>()) : void()), ...);
  return input;
}

/// @name What a driver may pass to a core. Checked because the bytes may come from anybody
///@{
bool exists(core::Line line) { return line == core::Line::first || line == core::Line::second; }
template <class Call>
auto legal(const Call& call) -> decltype(exists(call.line)) {
  return exists(call.line);
}
bool legal(const core::input::Receive& call) {
  return exists(call.line) && wire::slice_size_fits(call.slice.kind, call.slice.bytes.size);
}
bool legal(const core::input::Cpu& call) { return call.report.state <= wire::CpuState::failed; }
template <class... None>
bool legal(const None&...) {
  return true;
}
bool legal(const Record& record) {
  if (const auto* input = std::get_if<core::Input>(&record.what))
    return std::visit([](const auto& call) { return legal(call); }, *input);
  const auto* written = std::get_if<Written>(&record.what);
  return written == nullptr || exists(written->line);
}
///@}

/// Time never runs backwards, and stays between the start of the core and ten thousand years later.
bool follows(core::Time last, core::Duration step) {
  constexpr core::Time kLatest{std::chrono::hours(24 * 366 * 10000LL)};
  return last >= core::Time{} && last <= kLatest && step >= core::Duration{0} && step <= kLatest - last;
}

}  // namespace

std::optional<Record> RecordReader::next() {
  std::uint8_t tag = 0xFF;
  rest_("tag", tag);
  if (rest_.failed()) return std::nullopt;
  const core::Duration step = read_step(tag);
  if (!follows(last_, step)) return std::nullopt;
  last_ += step;
  const auto record = read(tag & ~(kSameTime | kMuchLater));
  if (rest_.failed() || !record || !legal(*record)) return std::nullopt;
  return record;
}

core::Duration RecordReader::read_step(std::uint8_t tag) {
  std::uint64_t step = 0;
  core::Int128 long_step = 0;
  if ((tag & kSameTime) != 0) return core::Duration{0};
  if ((tag & kMuchLater) == 0) {
    rest_("step", step);
    return core::Duration{step};
  }
  rest_("step", long_step);
  return core::Duration{long_step};
}

std::optional<Record> RecordReader::read(std::uint8_t tag) {
  Record record;
  record.at = last_;
  if (tag < kInputTags) {
    auto& input = record.what.emplace<core::Input>(input_of(tag, std::make_index_sequence<kInputTags>()));
    if (auto* const call = std::get_if<core::input::Receive>(&input)) {
      if (!read(*call, record.data_left_out)) return std::nullopt;
    } else {
      std::visit([this](auto& other) { other.archive(rest_); }, input);
    }
  } else if (tag == kWrittenTag) {
    record.what.emplace<Written>().archive(rest_);
  } else if (tag == kEventTag) {
    record.what.emplace<core::Event>().archive(rest_);
  } else if (tag == kPacketTag) {
    record.what.emplace<Taken>().archive(rest_);
  } else {
    return std::nullopt;
  }
  return record;
}

bool RecordReader::read(core::input::Receive& call, bool& data_left_out) {
  std::uint8_t kind = 0;
  rest_("line", call.line)("kind", kind);
  data_left_out = (kind & kAbridged) != 0;
  call.slice.kind = wire::SliceKind(kind & ~kAbridged);
  if (!data_left_out) {
    rest_("bytes", call.slice.bytes);
    return true;
  }
  std::uint32_t size = 0;
  rest_("size", size);
  return read_abridged(call.slice, size);
}

bool RecordReader::read_abridged(wire::Slice& slice, std::uint32_t size) {
  if (slice.kind != wire::SliceKind::whole || size < kLeastAbridged || size > wire::kMaxDataPacketSize) return false;
  std::array<std::uint8_t, kAbridgedSize> left{};
  rest_("left", left, left.size());
  packet_.fill(0);
  std::copy_n(left.begin(), wire::kHeaderSize, packet_.begin());
  std::copy_n(left.begin() + wire::kHeaderSize, kTail, packet_.begin() + size - kTail);
  slice.bytes = {packet_.data(), size};
  return true;
}

namespace {

// A writer changes nothing, but archive() is the same for one that reads.
template <class T>
void archive(core::StateWriter& room, const T& what) {
  const_cast<T&>(what).archive(room);
}

}  // namespace

// One space for all, since asking for it takes as long as writing.
std::uint8_t* RecordWriter::begin(std::uint8_t tag, core::Time at, std::size_t size) {
  const core::Int128 step = (at - last_).count();
  last_ = at;
  const auto low = static_cast<std::uint64_t>(step);
  const std::uint8_t how = step == 0 ? kSameTime : step != static_cast<core::Int128>(low) ? kMuchLater : 0;
  const std::size_t step_size = how == kSameTime ? 0 : how == kMuchLater ? sizeof step : sizeof low;
  std::uint8_t* const to = room_.space(1 + step_size + size);
  if (to == nullptr) return nullptr;
  Packed packed = Packed(to) << static_cast<std::uint8_t>(tag | how);
  if (how == kMuchLater) packed << step;
  if (how == 0) packed << low;
  return to + 1 + step_size;
}

// Nearly all inputs are slices and runs: asked for first, they are spared the table of std::visit.
void RecordWriter::put(core::Time at, const core::Input& input) {
  const auto tag = static_cast<std::uint8_t>(input.index());
  if (const auto* call = std::get_if<core::input::Receive>(&input)) return put_receive(tag, at, *call);
  begin(tag, at);
  if (std::holds_alternative<core::input::Run>(input)) return;
  std::visit([this](const auto& other) { archive(room_, other); }, input);
}

// As Receive::archive() has it, but for what is left out.
void RecordWriter::put_receive(std::uint8_t tag, core::Time at, const core::input::Receive& call) {
  const wire::ByteView bytes = call.slice.bytes;
  const auto kind = static_cast<std::uint8_t>(call.slice.kind);
  const auto size = static_cast<std::uint32_t>(bytes.size);
  const bool abridged = call.only_passes && can_be_abridged(call.slice);
  std::uint8_t* const to =
      begin(tag, at, sizeof call.line + sizeof kind + sizeof size + (abridged ? kAbridgedSize : bytes.size));
  if (to == nullptr) return;
  Packed packed = Packed(to) << call.line << static_cast<std::uint8_t>(kind | (abridged ? kAbridged : 0)) << size;
  left_out_ = left_out_ || abridged;
  if (abridged)
    put_abridged(packed, bytes);
  else
    packed << bytes;
}

void RecordWriter::put(core::Time at, const Written& written) {
  begin(kWrittenTag, at);
  archive(room_, written);
}

void RecordWriter::put_written(core::Time at, core::Line line, wire::ByteView framed_slices) {
  std::uint32_t size = 0;
  std::uint8_t* const to = begin(kWrittenTag, at, sizeof line + sizeof size);
  if (to == nullptr) return;
  const std::size_t before = room_.size();
  put_slices(room_, framed_slices);
  size = static_cast<std::uint32_t>(room_.size() - before);
  Packed(to) << line << size;
}

void RecordWriter::put(core::Time at, const core::Event& event) {
  begin(kEventTag, at);
  archive(room_, event);
}

void RecordWriter::put(core::Time at, const Taken& packet) {
  begin(kPacketTag, at);
  archive(room_, packet);
}

namespace {

/// Zeroes, but for the four bytes before the trailer, which make the CRC right.
void make_up(std::uint8_t* packet, std::size_t size) {
  constexpr std::size_t kFour = sizeof(std::uint32_t);
  const std::size_t covered = size - wire::kCrcSize;
  std::uint8_t* const four = packet + covered - wire::kTrailerSize - kFour;
  std::fill(packet + wire::kHeaderSize, four + kFour, std::uint8_t{0});
  const std::uint32_t change = wire::crc32({packet, covered}) ^ wire::load_u32(packet + covered);
  const std::uint32_t bytes = wire::crc32_cause(change, wire::kTrailerSize);
  for (std::size_t i = 0; i < kFour; ++i) four[i] = static_cast<std::uint8_t>(bytes >> 8 * i);
}

}  // namespace

// As its source has sent it: on its way HOP and FBC change, and the CRC with them.
std::uint64_t key_of(const wire::PacketFields& packet) {
  const std::uint32_t crc =
      wire::carried_crc(packet.crc(), packet.bytes.size, packet.hop(), packet.fbc() ^ wire::kFbcUntaken);
  return std::uint64_t{crc} << 32 | std::uint64_t{packet.code_byte()} << 24 | std::uint64_t{packet.source()} << 16 |
         std::uint64_t{packet.destination()} << 8 | packet.last();
}

void PacketData::put(std::uint64_t key, wire::ByteView data, bool made_up) {
  const auto [place, added] = packets_.try_emplace(key);
  place->second = {{data.begin(), data.end()}, made_up};
  if (!added) return;
  order_.push_back(key);
  if (order_.size() <= kMost) return;
  packets_.erase(order_.front());
  order_.pop_front();
}

void PacketData::keep(wire::ByteView packet) {
  const wire::PacketFields fields{packet};
  put(key_of(fields), fields.data(), false);
}

bool PacketData::fill_in(std::uint8_t* packet, std::size_t size) {
  const wire::PacketFields fields{{packet, size}};
  const auto found = packets_.find(key_of(fields));
  const bool kept = found != packets_.end() && found->second.data.size() == fields.data().size;
  if (kept) {
    std::copy(found->second.data.begin(), found->second.data.end(), packet + wire::kHeaderSize);
    if (fields.crc_good()) return !found->second.made_up;
  }
  make_up(packet, size);
  put(key_of(fields), fields.data(), true);
  return false;
}

bool PacketData::is_made_up(wire::ByteView packet) const {
  const auto found = packets_.find(key_of({packet}));
  return found != packets_.end() && found->second.made_up;
}

namespace {

void put(core::StateWriter& room, const wire::Slice& slice) {
  const wire::ByteView bytes = slice.bytes;
  const auto size = static_cast<std::uint16_t>(bytes.size);
  const auto kind = static_cast<std::uint8_t>(slice.kind);
  if (can_be_abridged(slice)) {
    std::uint8_t* const to = room.space(sizeof kind + sizeof size + kAbridgedSize);
    if (to == nullptr) return;
    put_abridged(Packed(to) << static_cast<std::uint8_t>(kind | kAbridged) << size, bytes);
  } else if (std::uint8_t* const to = room.space(sizeof kind + sizeof size + size)) {
    Packed(to) << kind << size << bytes;
  }
}

}  // namespace

void put_abridged(Packed to, wire::ByteView packet) {
  to << packet.first(wire::kHeaderSize) << packet.from(packet.size - kTail);
}

void put_slices(core::StateWriter& room, wire::ByteView framed_slices) {
  wire::each_slice(framed_slices, [&room](const wire::Slice& slice) { put(room, slice); });
}

}  // namespace limb_ring::recorder
