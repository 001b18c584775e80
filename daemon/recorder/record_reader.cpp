#include "recorder/record_reader.h"

#include <cstring>
#include <utility>

#include "recorder/record_format.h"
#include "recorder/slices_taken_in.h"

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
  const auto* packet = std::get_if<core::ReceivedPacket>(&record.what);
  if (packet != nullptr) return packet->size <= packet->data.size();
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
  const wire::ByteView before = records_.first(records_.size - rest_.rest().size);
  std::uint8_t tag = 0xFF;
  rest_("tag", tag);
  if (rest_.failed()) return std::nullopt;
  const core::Duration step = read_step(tag);
  if (!follows(last_, step)) return std::nullopt;
  last_ += step;
  const auto record = read(tag & ~(kSameTime | kMuchLater), before);
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

std::optional<Record> RecordReader::read(std::uint8_t tag, wire::ByteView before) {
  Record record;
  record.at = last_;
  if (tag < kInputTags) {
    auto& input = record.what.emplace<core::Input>(input_of(tag, std::make_index_sequence<kInputTags>()));
    std::visit([this](auto& call) { call.archive(rest_); }, input);
  } else if (tag == kWrittenTag) {
    if (!read(record.what.emplace<Written>(), before)) return std::nullopt;
  } else if (tag == kEventTag) {
    record.what.emplace<core::Event>().archive(rest_);
  } else if (tag == kPacketTag) {
    record.what.emplace<core::ReceivedPacket>().archive(rest_);
  } else {
    return std::nullopt;
  }
  return record;
}

bool RecordReader::read(Written& written, wire::ByteView before) {
  std::uint32_t size = 0;
  rest_("line", written.line)("size", size);
  std::swap(written_[0], written_[1]);
  wire::SliceWriter& slices = written_[0];
  slices.clear();
  if (size > kMostWritten) return false;
  while (slices.view().size < size)
    if (!read_slice(slices, before)) return false;
  written.slices = slices.view();
  return slices.view().size == size;
}

bool RecordReader::read_slice(wire::SliceWriter& slices, wire::ByteView before) {
  wire::SliceKind kind{};
  std::uint32_t back = 0;
  rest_("kind", kind)("back", back);
  if (back == 0) {
    wire::ByteView bytes;
    rest_("bytes", bytes);
    if (rest_.failed() || !wire::slice_size_fits(kind, bytes.size)) return false;
    slices.put(kind, bytes);
    return true;
  }
  std::uint16_t size = 0;
  std::uint8_t differing = 0;
  rest_("size", size)("differing", differing);
  if (rest_.failed() || !wire::slice_size_fits(kind, size) || size < 2 * Differences::kEnd) return false;
  if (back > before.size || back < size || differing >> Differences::kWords != 0) return false;
  std::uint8_t* const bytes = slices.put_space(kind, size);
  std::memcpy(bytes, before.end() - back, size);
  for (std::size_t i = 0; i < Differences::kWords; ++i) {
    if ((differing >> i & 1) == 0) continue;
    std::uint64_t word = 0;
    rest_("word", word);
    std::memcpy(bytes + Differences::place(i, size), &word, sizeof word);
  }
  return true;
}

}  // namespace limb_ring::recorder
