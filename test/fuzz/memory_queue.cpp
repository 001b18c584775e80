// A neighbour that writes anything over the shared memory of a line: what it says is checked before use.
#include <array>
#include <cstring>

#include "fuzz/fuzz.h"
#include "io/memory_line.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static link::QueueMemory memory = *link::QueueMemory::make(link::QueueMemory::kSmallest);
  std::memset(static_cast<void*>(&memory.control()), 0, sizeof(link::QueueControl));
  link::QueueReader reader(memory);
  link::QueueWriter writer(memory);
  fuzz::Input input(data, size);
  std::array<std::uint8_t, 512> space;
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    if (what & 0x80) {  // the other end scribbles
      const wire::ByteView scribble = input.bytes(what & 0x3F);
      std::memcpy(reinterpret_cast<std::uint8_t*>(&memory.control()) + (what & 0x40), scribble.data, scribble.size);
    } else if (what & 0x40) {
      const std::ptrdiff_t taken = reader.take(space.data(), space.size());
      fuzz::require(taken >= -1 && taken <= static_cast<std::ptrdiff_t>(space.size()), "no more is taken than fits");
      reader.must_tell_of_room();
      reader.sleep();
      reader.heard_beat();
    } else {
      const wire::ByteView bytes = input.bytes(what);
      const std::ptrdiff_t put = writer.put(bytes);
      fuzz::require(put >= -1 && put <= static_cast<std::ptrdiff_t>(bytes.size), "no more is put than is there");
      writer.must_wake();
      writer.wait_for_room();
      writer.heard_beat();
    }
  }
  return 0;
}
