// Slices from a line, cut anywhere: what is one is put back byte for byte, and a cut changes nothing.
#include <vector>

#include "fuzz/fuzz.h"
#include "wire/control_message.h"
#include "wire/slice.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Status = wire::SliceParse::Status;
  wire::ByteView rest{data, size};
  wire::SliceWriter again;
  wire::SliceParse parse;
  while ((parse = wire::parse_slice(rest)).status == Status::slice) {
    fuzz::require(parse.consumed <= rest.size, "a slice lies within what was read");
    fuzz::require(wire::slice_size_fits(parse.slice.kind, parse.slice.bytes.size), "a slice has a size of its kind");
    fuzz::require(wire::parse_slice(rest.first(parse.consumed - 1)).status == Status::incomplete,
                  "a slice without its last byte is incomplete");
    if (const auto word = wire::fold_word(parse.slice)) {
      wire::SliceWriter put;
      wire::put(put, *word);
      fuzz::require(put.view().size == parse.consumed, "a fold word has its size");
    }
    again.put(parse.slice.kind, parse.slice.bytes);
    rest = rest.from(parse.consumed);
  }
  const wire::ByteView whole = wire::ByteView{data, size}.first(size - rest.size);
  fuzz::require(again.view().size == whole.size && std::equal(whole.begin(), whole.end(), again.view().begin()),
                "slices put together are what was read");
  return 0;
}
