#include "study/scenario/line_faults.h"

#include <algorithm>

namespace limb_ring::study::scenario {

using wire::Slice;
using wire::SliceKind;

namespace {

bool begins(const Slice& slice) { return slice.kind == SliceKind::whole || slice.kind == SliceKind::start; }
bool ends(const Slice& slice) { return slice.kind == SliceKind::whole || slice.kind == SliceKind::end; }

/// What has a header and whole words of it has begun; then nothing more comes.
void cut_short(const Slice& slice, wire::SliceWriter& arriving) {
  if (slice.kind == SliceKind::whole) {
    const std::size_t words = (slice.bytes.size - wire::kOverhead) / 4;
    arriving.put(SliceKind::start, slice.bytes.first(wire::kHeaderSize + 4 * words));
  }
  arriving.put(SliceKind::abort, {});
}

}  // namespace

void LineFaults::begin(const Fault& fault) {
  constexpr std::uint64_t kNoLimit = UINT64_MAX;
  const core::Time until = fault.lasts.count() == 0 ? core::kNever : ring_.now() + core::Duration(fault.lasts);
  for (const NodeId id : fault.nodes) {
    lines_[id].active.push_back({fault.name, fault.packets == 0 ? kNoLimit : fault.packets, fault.once_in, until});
    ring_.tap(id, [this, id](const Slice& slice, core::Time, wire::SliceWriter& arriving) {
      pass(id, slice, arriving);
    });
  }
}

// The first that hits counts; an INTP is too short to be truncated in a way of its own.
std::optional<FaultName> LineFaults::decide(Line& line, bool interrupt) {
  for (Active& active : line.active) {
    if (active.left == 0 || ring_.now() >= active.until) continue;
    if (interrupt && active.name == FaultName::truncate) continue;
    if (random_() % active.once_in != 0) continue;
    --active.left;
    return active.name;
  }
  return std::nullopt;
}

void LineFaults::pass(NodeId id, const Slice& slice, wire::SliceWriter& arriving) {
  Line& line = lines_[id];
  if (begins(slice)) line.on_data = decide(line, false);
  const bool interrupt = slice.kind == SliceKind::interrupt;
  const auto fault = interrupt ? decide(line, true) : line.on_data;
  if (ends(slice) || slice.kind == SliceKind::abort) line.on_data.reset();
  if (fault == FaultName::drop) return;
  if (fault == FaultName::corrupt && (interrupt || ends(slice))) return damage(slice, arriving);
  if (fault == FaultName::truncate && ends(slice)) return cut_short(slice, arriving);
  arriving.put(slice.kind, slice.bytes);
}

// A wrong bit elsewhere in the packet shows the same way, unless it makes the packet none at all or another's.
void LineFaults::damage(const Slice& slice, wire::SliceWriter& arriving) {
  std::uint8_t* bytes = arriving.put_space(slice.kind, slice.bytes.size);
  std::copy(slice.bytes.begin(), slice.bytes.end(), bytes);
  const std::uint64_t bit = random_() % (8 * wire::kCrcSize);
  bytes[slice.bytes.size - 1 - bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
}

}  // namespace limb_ring::study::scenario
