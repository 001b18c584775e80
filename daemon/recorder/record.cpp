#include "recorder/record.h"

#include <utility>

namespace limb_ring::recorder {
namespace {

constexpr std::size_t kInputs = std::variant_size_v<core::Input>;
/// Tags of records that are no inputs. An input's tag is its index in core::Input.
constexpr std::uint8_t kWritten = kInputs, kEvent = kInputs + 1, kPacket = kInputs + 2, kTags = kInputs + 3;

template <std::size_t... kPlaces>
core::Input input_of(std::uint8_t tag, std::index_sequence<kPlaces...>) {
  core::Input input;
  ((tag == kPlaces ? void(input.emplace<kPlaces>()) : void()), ...);
  return input;
}

void begin(core::StateWriter& room, std::uint8_t tag, core::Time at, core::Time& last) {
  TimeStep step{at - last};
  room("tag", tag)("step", step);
  last = at;
}

// A writer changes nothing, but archive() is the same for one that reads.
template <class T>
void put(core::StateWriter& room, const T& what) {
  const_cast<T&>(what).archive(room);
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

void write(core::StateWriter& room, core::Time at, const core::Input& input, core::Time& last) {
  begin(room, static_cast<std::uint8_t>(input.index()), at, last);
  std::visit([&](const auto& call) { put(room, call); }, input);
}

void write(core::StateWriter& room, core::Time at, const Written& written, core::Time& last) {
  begin(room, kWritten, at, last);
  put(room, written);
}

void write(core::StateWriter& room, core::Time at, const core::Event& event, core::Time& last) {
  begin(room, kEvent, at, last);
  put(room, event);
}

void write(core::StateWriter& room, core::Time at, const core::ReceivedPacket& packet, core::Time& last) {
  begin(room, kPacket, at, last);
  put(room, packet);
}

std::optional<Record> read(core::StateReader& bytes, core::Time& last) {
  std::uint8_t tag = kTags;
  TimeStep step;
  bytes("tag", tag)("step", step);
  if (!follows(last, step.value())) return std::nullopt;
  Record record;
  record.at = last += step.value();
  if (tag < kInputs) {
    auto& input = record.what.emplace<core::Input>(input_of(tag, std::make_index_sequence<kInputs>()));
    std::visit([&](auto& call) { call.archive(bytes); }, input);
  } else if (tag == kWritten) {
    record.what.emplace<Written>().archive(bytes);
  } else if (tag == kEvent) {
    record.what.emplace<core::Event>().archive(bytes);
  } else if (tag == kPacket) {
    record.what.emplace<core::ReceivedPacket>().archive(bytes);
  } else {
    return std::nullopt;
  }
  if (bytes.failed() || !legal(record)) return std::nullopt;
  return record;
}

}  // namespace limb_ring::recorder
