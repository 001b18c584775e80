#include "recorder/record_writer.h"

#include <cstring>

#include "recorder/record_format.h"

namespace limb_ring::recorder {
namespace {

// A writer changes nothing, but archive() is the same for one that reads.
template <class T>
void archive(core::StateWriter& room, const T& what) {
  const_cast<T&>(what).archive(room);
}

/// Bytes one behind the other. What each packet causes is written by it and not by an archive, which asks for room for
/// each number.
class Packed {
 public:
  explicit Packed(std::uint8_t* to) : to_(to) {}
  template <class T>
  Packed& operator<<(T value) {
    std::memcpy(to_, &value, sizeof value);
    to_ += sizeof value;
    return *this;
  }
  void bytes(wire::ByteView all) {
    if (!all.empty()) std::memcpy(to_, all.data, all.size);
  }

 private:
  std::uint8_t* to_;
};

}  // namespace

void RecordWriter::begin(std::uint8_t tag, core::Time at) {
  begun_ = room_.next();
  if (at == last_) tag |= kSameTime;
  if (std::uint8_t* const to = room_.space(1)) *to = tag;
  if (at == last_) return;
  TimeStep step{at - last_};
  room_("step", step);
  last_ = at;
}

// Nearly all inputs are slices and runs: asked for first, they are spared the table of std::visit.
void RecordWriter::put(core::Time at, const core::Input& input) {
  begin(static_cast<std::uint8_t>(input.index()), at);
  if (const auto* call = std::get_if<core::input::Receive>(&input)) return put_receive(*call);
  if (std::holds_alternative<core::input::Run>(input)) return;
  std::visit([this](const auto& other) { archive(room_, other); }, input);
}

// As Receive::archive() has it.
void RecordWriter::put_receive(const core::input::Receive& call) {
  const wire::ByteView bytes = call.slice.bytes;
  const auto size = static_cast<std::uint32_t>(bytes.size);
  std::uint8_t* const to = room_.space(sizeof call.line + sizeof call.slice.kind + sizeof size + size);
  if (to == nullptr) return;
  (Packed(to) << call.line << call.slice.kind << size).bytes(bytes);
  taken_in_.add({call.slice.kind, {room_.next() - size, size}});
}

void RecordWriter::put(core::Time at, const Written& written) {
  begin(kWrittenTag, at);
  const auto size = static_cast<std::uint32_t>(written.slices.size);
  if (std::uint8_t* const to = room_.space(sizeof written.line + sizeof size)) Packed(to) << written.line << size;
  wire::each_slice(written.slices, [this](const wire::Slice& slice) { put_slice(slice); });
  taken_in_.forget();
}

void RecordWriter::put_slice(const wire::Slice& slice) {
  Differences differences;
  const std::uint8_t* const taken_in = taken_in_.find(slice, differences);
  const auto back = static_cast<std::uint32_t>(taken_in == nullptr ? 0 : begun_ - taken_in);
  if (taken_in == nullptr) {
    const auto size = static_cast<std::uint32_t>(slice.bytes.size);
    if (std::uint8_t* const to = room_.space(sizeof slice.kind + sizeof back + sizeof size + size))
      (Packed(to) << slice.kind << back << size).bytes(slice.bytes);
    return;
  }
  const auto size = static_cast<std::uint16_t>(slice.bytes.size);
  std::uint8_t* const to = room_.space(sizeof slice.kind + sizeof back + sizeof size + 1 + 3u * differences.count);
  if (to == nullptr) return;
  Packed packed = Packed(to) << slice.kind << back << size << differences.count;
  for (std::size_t i = 0; i < differences.count; ++i)
    packed << differences.bytes[i].place << differences.bytes[i].value;
}

void RecordWriter::put(core::Time at, const core::Event& event) {
  begin(kEventTag, at);
  archive(room_, event);
}

void RecordWriter::put(core::Time at, const core::ReceivedPacket& packet) {
  begin(kPacketTag, at);
  archive(room_, packet);
}

}  // namespace limb_ring::recorder
