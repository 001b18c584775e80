#include "wire/control_message.h"

namespace limb_ring::wire {
namespace {

constexpr std::uint8_t kTypeHello = 1;
constexpr std::uint8_t kTypeBeacon = 2;

bool is(ByteView data, std::uint8_t type, std::size_t size) {
  return data.size == size && data[0] == type;
}

}  // namespace

const char* to_string(CpuState state) {
  switch (state) {
    case CpuState::none: return "none";
    case CpuState::absent: return "absent";
    case CpuState::booting: return "booting";
    case CpuState::running: return "running";
    case CpuState::silent: return "silent";
    case CpuState::failed: return "failed";
  }
  return "unknown";
}

const char* to_string(LinkState state) {
  switch (state) {
    case LinkState::down: return "down";
    case LinkState::up: return "up";
    case LinkState::silent: return "silent";
    case LinkState::folded: return "folded";
  }
  return "unknown";
}

std::size_t encode(const Hello& hello, std::uint8_t* out) {
  out[0] = kTypeHello;
  store_u64(out + 1, hello.boot);
  out[9] = hello.remembers ? 1 : 0;
  return kHelloSize;
}

std::size_t encode(const Beacon& b, std::uint8_t* out) {
  out[0] = kTypeBeacon;
  store_u64(out + 1, b.boot);
  store_u32(out + 9, b.cpu_boots);
  out[13] = static_cast<std::uint8_t>(b.cpu_state);
  store_u32(out + 14, b.cpu_silent_ms);
  out[18] = static_cast<std::uint8_t>(b.input);
  out[19] = b.input_from;
  out[20] = static_cast<std::uint8_t>(b.output);
  out[21] = b.output_to;
  out[22] = b.break_known ? 1 : 0;
  out[23] = b.break_before;
  out[24] = b.break_behind;
  out[25] = b.cpu_comes_back ? 1 : 0;
  return kBeaconSize;
}

std::optional<Hello> decode_hello(ByteView data) {
  if (!is(data, kTypeHello, kHelloSize) || data[9] > 1) return std::nullopt;
  return Hello{load_u64(data.data + 1), data[9] == 1};
}

std::optional<Beacon> decode_beacon(ByteView data) {
  if (!is(data, kTypeBeacon, kBeaconSize)) return std::nullopt;
  const std::uint8_t* p = data.data;
  const bool legal = p[13] <= static_cast<std::uint8_t>(CpuState::failed) &&
                     p[18] <= static_cast<std::uint8_t>(LinkState::folded) &&
                     p[20] <= static_cast<std::uint8_t>(LinkState::folded) && p[22] <= 1 && p[25] <= 1;
  if (!legal) return std::nullopt;
  Beacon b;
  b.boot = load_u64(p + 1);
  b.cpu_boots = load_u32(p + 9);
  b.cpu_state = static_cast<CpuState>(p[13]);
  b.cpu_silent_ms = load_u32(p + 14);
  b.input = static_cast<LinkState>(p[18]);
  b.input_from = p[19];
  b.output = static_cast<LinkState>(p[20]);
  b.output_to = p[21];
  b.break_known = p[22] == 1;
  b.break_before = p[23];
  b.break_behind = p[24];
  b.cpu_comes_back = p[25] == 1;
  return b;
}

}  // namespace limb_ring::wire
