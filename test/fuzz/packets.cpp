// What a relay does to a packet: HOP and FBC are other ones, all else stays, a good CRC stays good and a bad one bad.
#include <algorithm>
#include <vector>

#include "fuzz/fuzz.h"
#include "wire/packet.h"

using namespace limb_ring;

namespace {

using Bytes = std::vector<std::uint8_t>;

wire::PacketFields fields(const Bytes& packet) { return {{packet.data(), packet.size()}}; }

void relay(const Bytes& packet, std::uint8_t hop, std::uint8_t fbc) {
  Bytes passed = packet;
  wire::rewrite(passed.data(), passed.size(), hop, fbc);
  fuzz::require(fields(passed).hop() == hop && fields(passed).fbc() == fbc, "HOP and FBC are what they were set to");
  fuzz::require(fields(passed).crc_good() == fields(packet).crc_good(), "the CRC is as good as it was");
  wire::rewrite(passed.data(), passed.size(), fields(packet).hop(), fields(packet).fbc());
  fuzz::require(passed == packet, "with HOP and FBC put back it is the same packet");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < wire::kOverhead + 2 || size > wire::kMaxDataPacketSize + 2) return 0;
  Bytes packet(data + 2, data + size);
  relay(packet, data[0], data[1]);
  // Nobody guesses a CRC.
  const std::size_t covered = packet.size() - wire::kCrcSize;
  wire::store_u32(packet.data() + covered, wire::crc32({packet.data(), covered}));
  relay(packet, data[0], data[1]);
  return 0;
}
