// Hellos and beacons of other nodes.
#include <algorithm>
#include <array>

#include "fuzz/fuzz.h"
#include "wire/control_message.h"

using namespace limb_ring;

namespace {

template <class Message>
void encodes_to(const Message& message, wire::ByteView bytes) {
  std::array<std::uint8_t, 64> again{};
  const std::size_t size = wire::encode(message, again.data());
  fuzz::require(size == bytes.size, "a control message has its size");
  Message read{};
  if constexpr (std::is_same_v<Message, wire::Hello>)
    read = *wire::decode_hello({again.data(), size});
  else
    read = *wire::decode_beacon({again.data(), size});
  fuzz::require(read.boot == message.boot, "what is encoded decodes");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto hello = wire::decode_hello({data, size})) encodes_to(*hello, {data, size});
  if (const auto beacon = wire::decode_beacon({data, size})) encodes_to(*beacon, {data, size});
  return 0;
}
