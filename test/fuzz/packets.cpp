// DATP and INTP: what decodes is encoded to the same bytes.
#include <algorithm>
#include <array>

#include "fuzz/fuzz.h"
#include "wire/data_packet.h"
#include "wire/interrupt_packet.h"

using namespace limb_ring;

namespace {

bool same(wire::ByteView a, wire::ByteView b) { return a.size == b.size && std::equal(a.begin(), a.end(), b.begin()); }

// So that an input need not guess a CRC, the last bytes become one where the first says so.
void data_packet(wire::ByteView bytes) {
  wire::DataPacket packet;
  if (wire::decode(bytes, packet) != wire::PacketError::none) return;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> again;
  const std::size_t size = wire::encode(packet, again.data());
  fuzz::require(same(bytes, {again.data(), size}), "a DATP is encoded as it was decoded");
}

void interrupt_packet(wire::ByteView bytes) {
  wire::InterruptPacket packet;
  if (wire::decode(bytes, packet) != wire::PacketError::none) return;
  const auto again = wire::encode(packet);
  fuzz::require(same(bytes, {again.data(), again.size()}), "an INTP is encoded as it was decoded");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  data_packet({data, size});
  interrupt_packet({data, size});
  if (size < wire::kOverhead || size > wire::kMaxDataPacketSize) return 0;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes;
  std::copy(data, data + size, bytes.begin());
  wire::rewrite(bytes.data(), size, data[2], data[size - wire::kCrcSize - 3]);
  const std::uint32_t crc = wire::crc32({bytes.data(), size - wire::kCrcSize});
  wire::store_u32(bytes.data() + size - wire::kCrcSize, crc);
  data_packet({bytes.data(), size});
  interrupt_packet({bytes.data(), size});
  return 0;
}
