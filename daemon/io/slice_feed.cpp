#include "io/slice_feed.h"

#include <cstring>

namespace limb_ring::link {

bool SliceFeed::commit(std::size_t size, InputHandler& handler, InputCounters& counters) {
  using Status = wire::SliceParse::Status;
  wire::ByteView rest{buffer_.data(), kept_ + size};
  const std::uint64_t before = counters.slices;
  bool well_formed = true;
  for (;;) {
    const wire::SliceParse parse = wire::parse_slice(rest);  // a copy of it would take longer than all else here
    well_formed = parse.status != Status::malformed;
    if (parse.status != Status::slice) break;
    rest = rest.from(parse.consumed);
    if (parse.slice.kind == wire::SliceKind::idle) {
      ++counters.idle_slices;
      continue;
    }
    ++counters.slices;
    handler.on_slice(parse.slice);
    if (stopped_) return true;
  }
  kept_ = rest.size;
  if (kept_ != 0) std::memmove(buffer_.data(), rest.data, kept_);
  if (counters.slices != before) handler.on_batch_end();
  return well_formed;
}

}  // namespace limb_ring::link
