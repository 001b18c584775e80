// Pieces of large messages from many sources, any of them wrong: what is held has its limit.
#include "fuzz/fuzz.h"
#include "limb_ring/payload/reassembler.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  payload::Reassembler::Limits limits;
  limits.message = 4096;
  limits.total = 16384;
  payload::Reassembler reassembler(limits);
  fuzz::Input input(data, size);
  while (!input.empty()) {
    const std::uint8_t source = input.byte();
    const wire::ByteView packet = input.bytes(input.byte() * 2u);
    const auto message = reassembler.take(source, {packet.data, packet.size});
    if (message) fuzz::require(message->bytes.size() <= limits.message, "a message has its limit");
    fuzz::require(reassembler.held() <= limits.total, "what is held has its limit");
  }
  return 0;
}
