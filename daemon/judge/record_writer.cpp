#include "judge/record_writer.h"

#include "judge/abridged.h"
#include "judge/packed.h"
#include "judge/record_format.h"

namespace limb_ring::recorder {
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

}  // namespace limb_ring::recorder
