// A stream of bytes from a neighbour, in reads of any size: the same slices come out as from one read.
#include <algorithm>
#include <vector>

#include "fuzz/fuzz.h"
#include "io/input.h"

using namespace limb_ring;

namespace {

struct Slices : link::InputHandler {
  void on_slice(const wire::Slice& slice) override { taken.put(slice.kind, slice.bytes); }
  void on_batch_end() override {}
  void on_input_gap() override {}
  void on_input_up(std::uint8_t) override {}
  void on_input_lost(std::string_view) override {}
  void on_unknown_peer(std::string_view) override {}
  wire::SliceWriter taken;
};

void feed(wire::ByteView bytes, std::size_t at_once, Slices& slices) {
  link::SliceFeed input;
  link::InputCounters counters;
  while (!bytes.empty()) {
    const std::size_t size = std::min(std::min(at_once, bytes.size), input.space_size());
    fuzz::require(size != 0, "there is always room for a read");
    std::copy(bytes.begin(), bytes.begin() + size, input.space());
    if (!input.commit(size, slices, counters)) return;
    bytes = bytes.from(size);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t at_once = 1 + input.byte();
  const wire::ByteView bytes = input.bytes(4096);
  Slices whole, in_pieces;
  feed(bytes, bytes.size, whole);
  feed(bytes, at_once, in_pieces);
  const wire::ByteView a = whole.taken.view(), b = in_pieces.taken.view();
  fuzz::require(a.size == b.size && std::equal(a.begin(), a.end(), b.begin()),
                "reads of any size give the same slices");
  return 0;
}
