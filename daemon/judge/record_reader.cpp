#include "judge/record_reader.h"

#include <algorithm>
#include <utility>

#include "judge/abridged.h"
#include "judge/record_format.h"

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

}  // namespace limb_ring::recorder
