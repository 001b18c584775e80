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

std::size_t bytes_of(const Differences& differences) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < differences.words.size(); ++i)
    bytes += (differences.differing >> i & 1) * sizeof differences.words[i];
  return bytes;
}

}  // namespace

void RecordWriter::begin(std::uint8_t tag, core::Time at) {
  begun_ = room_.next();
  const core::Int128 step = (at - last_).count();
  last_ = at;
  const auto low = static_cast<std::uint64_t>(step);
  const std::uint8_t how = step == 0 ? kSameTime : step != static_cast<core::Int128>(low) ? kMuchLater : 0;
  std::uint8_t* const to = room_.space(1 + (how == kSameTime ? 0 : how == kMuchLater ? sizeof step : sizeof low));
  if (to == nullptr) return;
  Packed packed = Packed(to) << static_cast<std::uint8_t>(tag | how);
  if (how == kSameTime) return;
  how == kMuchLater ? packed << step : packed << low;
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
  std::uint8_t* const to = room_.space(sizeof slice.kind + sizeof back + sizeof size + 1 + bytes_of(differences));
  if (to == nullptr) return;
  Packed packed = Packed(to) << slice.kind << back << size << differences.differing;
  for (std::size_t i = 0; i < differences.words.size(); ++i)
    if ((differences.differing >> i & 1) != 0) packed << differences.words[i];
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
