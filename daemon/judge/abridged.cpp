#include "judge/abridged.h"

namespace limb_ring::recorder {
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
