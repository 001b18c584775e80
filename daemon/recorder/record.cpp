#include "recorder/record.h"

#include <utility>

namespace limb_ring::recorder {
namespace {

constexpr std::size_t kInputs = std::variant_size_v<core::Input>;
/// Of what is no input; those are tagged by their place in core::Input.
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
  if (bytes.failed()) return std::nullopt;
  return record;
}

}  // namespace limb_ring::recorder
