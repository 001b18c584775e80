#include "wire/control_message.h"

namespace limb_ring::wire {
namespace {

constexpr std::uint8_t kTypeHello = 1;
constexpr std::uint8_t kTypeBeacon = 2;
constexpr std::size_t kTypeAt = 0;

/// Where the fields of a hello lie.
namespace hello_field {
constexpr std::size_t kBoot = 1, kRemembers = 9;
}
/// Where those of a beacon do.
namespace beacon_field {
constexpr std::size_t kBoot = 1, kCpuBoots = 9, kCpuState = 13, kCpuSilent = 14, kInput = 18, kInputFrom = 19,
                      kOutput = 20, kOutputTo = 21, kBreakKnown = 22, kBreakBefore = 23, kBreakBehind = 24,
                      kCpuComesBack = 25, kStopLatched = 26, kLatches = 27, kLatchSource = 31, kLatchClock = 32;
}

bool has_tail(const Beacon& b) { return b.stop_latched || b.latch.count != 0; }

void encode_tail(const Beacon& b, std::uint8_t* out) {
  using namespace beacon_field;
  out[kStopLatched] = b.stop_latched ? 1 : 0;
  store_u32(out + kLatches, b.latch.count);
  out[kLatchSource] = b.latch.source;
  store_u64(out + kLatchClock, b.latch.clock_ns);
}

/// @return false if it is no valid tail: it must tell something, and the latch fields must be 0 without a latch
bool decode_tail(ByteView data, Beacon& b) {
  using namespace beacon_field;
  if (data[kStopLatched] > 1) return false;
  b.stop_latched = data[kStopLatched] == 1;
  b.latch.count = load_u32(data.data + kLatches);
  b.latch.source = NodeId{data[kLatchSource]};
  b.latch.clock_ns = load_u64(data.data + kLatchClock);
  return has_tail(b) && (b.latch.count != 0 || (b.latch.source == 0 && b.latch.clock_ns == 0));
}

bool is(ByteView data, std::uint8_t type, std::size_t size) { return data.size == size && data[kTypeAt] == type; }

}  // namespace

const char* to_string(CpuState state) {
  switch (state) {
    case CpuState::none:
      return "none";
    case CpuState::absent:
      return "absent";
    case CpuState::booting:
      return "booting";
    case CpuState::running:
      return "running";
    case CpuState::silent:
      return "silent";
    case CpuState::failed:
      return "failed";
  }
  return "unknown";
}

const char* to_string(LinkState state) {
  switch (state) {
    case LinkState::down:
      return "down";
    case LinkState::up:
      return "up";
    case LinkState::silent:
      return "silent";
    case LinkState::folded:
      return "folded";
  }
  return "unknown";
}

std::size_t encode(const Hello& hello, std::uint8_t* out) {
  using namespace hello_field;
  out[kTypeAt] = kTypeHello;
  store_u64(out + kBoot, hello.boot);
  out[kRemembers] = hello.remembers ? 1 : 0;
  return kHelloSize;
}

std::size_t encode(const Beacon& b, std::uint8_t* out) {
  using namespace beacon_field;
  out[kTypeAt] = kTypeBeacon;
  store_u64(out + kBoot, b.boot);
  store_u32(out + kCpuBoots, b.cpu_boots);
  out[kCpuState] = static_cast<std::uint8_t>(b.cpu_state);
  store_u32(out + kCpuSilent, b.cpu_silent_ms);
  out[kInput] = static_cast<std::uint8_t>(b.input);
  out[kInputFrom] = b.input_from;
  out[kOutput] = static_cast<std::uint8_t>(b.output);
  out[kOutputTo] = b.output_to;
  out[kBreakKnown] = b.break_known ? 1 : 0;
  out[kBreakBefore] = b.break_before;
  out[kBreakBehind] = b.break_behind;
  out[kCpuComesBack] = b.cpu_comes_back ? 1 : 0;
  if (!has_tail(b)) return kBeaconSize;
  encode_tail(b, out);
  return kLongBeaconSize;
}

std::optional<Hello> decode_hello(ByteView data) {
  using namespace hello_field;
  if (!is(data, kTypeHello, kHelloSize) || data[kRemembers] > 1) return std::nullopt;
  return Hello{load_u64(data.data + kBoot), data[kRemembers] == 1};
}

std::optional<Beacon> decode_beacon(ByteView data) {
  using namespace beacon_field;
  if (!is(data, kTypeBeacon, kBeaconSize) && !is(data, kTypeBeacon, kLongBeaconSize)) return std::nullopt;
  const bool legal = data[kCpuState] <= static_cast<std::uint8_t>(CpuState::failed) &&
                     data[kInput] <= static_cast<std::uint8_t>(LinkState::folded) &&
                     data[kOutput] <= static_cast<std::uint8_t>(LinkState::folded) && data[kBreakKnown] <= 1 &&
                     data[kCpuComesBack] <= 1;
  if (!legal) return std::nullopt;
  Beacon b;
  b.boot = load_u64(data.data + kBoot);
  b.cpu_boots = load_u32(data.data + kCpuBoots);
  b.cpu_state = static_cast<CpuState>(data[kCpuState]);
  b.cpu_silent_ms = load_u32(data.data + kCpuSilent);
  b.input = static_cast<LinkState>(data[kInput]);
  b.input_from = NodeId{data[kInputFrom]};
  b.output = static_cast<LinkState>(data[kOutput]);
  b.output_to = NodeId{data[kOutputTo]};
  b.break_known = data[kBreakKnown] == 1;
  b.break_before = NodeId{data[kBreakBefore]};
  b.break_behind = NodeId{data[kBreakBehind]};
  b.cpu_comes_back = data[kCpuComesBack] == 1;
  if (data.size == kLongBeaconSize && !decode_tail(data, b)) return std::nullopt;
  return b;
}

}  // namespace limb_ring::wire
