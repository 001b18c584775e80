#include "wire/control_message.h"

#include <array>
#include <limits>
#include <type_traits>

namespace limb_ring::wire {
namespace {

constexpr std::uint8_t kTypeHello = 1;
constexpr std::uint8_t kTypeBeacon = 2;
constexpr std::size_t kTypeAt = 0, kFieldsAt = 1;

/// The least and the greatest value that a field may have.
template <class T>
struct Range {
  static constexpr std::uint64_t least = 0, most = std::numeric_limits<std::uint64_t>::max() >> (64 - 8 * sizeof(T));
};
template <>
struct Range<bool> {
  static constexpr std::uint64_t least = 0, most = 1;
};
template <class E, E kFirst, E kLast>
struct States {
  static constexpr auto least = static_cast<std::uint64_t>(kFirst), most = static_cast<std::uint64_t>(kLast);
};
template <>
struct Range<CpuState> : States<CpuState, CpuState::none, CpuState::failed> {};
template <>
struct Range<LinkState> : States<LinkState, LinkState::down, LinkState::folded> {};
template <>
struct Range<FoldWordKind> : States<FoldWordKind, FoldWordKind::begin, FoldWordKind::hears> {};

/// Writes a field, big-endian, and moves `to` behind it.
template <class T>
void put_field(std::uint8_t*& to, const T& field) {
  for (std::size_t left = sizeof(T); left-- > 0;)
    *to++ = static_cast<std::uint8_t>(static_cast<std::uint64_t>(field) >> 8 * left);
}
void put_field(std::uint8_t*& to, const ClockLatch& latch) {
  ClockLatch::fields([&](auto member, const Field&) { put_field(to, latch.*member); });
}

/// Reads a field and moves `from` behind it. @return whether it may have that value
template <class T>
bool take_field(const std::uint8_t*& from, T& field) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = value << 8 | *from++;
  if constexpr (std::is_same_v<T, NodeId>)
    field = NodeId{static_cast<std::uint8_t>(value)};
  else
    field = static_cast<T>(value);
  return value >= Range<T>::least && value <= Range<T>::most;
}
/// Without a latch its other fields are 0.
bool take_field(const std::uint8_t*& from, ClockLatch& latch) {
  bool legal = true;
  ClockLatch::fields([&](auto member, const Field&) { legal = take_field(from, latch.*member) && legal; });
  return legal && (latch.count != 0 || latch == ClockLatch{});
}

/// For one of a message's functions that visit its fields: reads each.
template <class Message>
auto taker(const std::uint8_t*& from, Message& message, bool& legal) {
  return [&](auto member, const Field&) { legal = take_field(from, message.*member) && legal; };
}

template <class T>
bool says_something(const T& field) {
  return static_cast<std::uint64_t>(field) != 0;
}
bool says_something(const ClockLatch& latch) { return latch.count != 0; }

bool has_latched(const Beacon& beacon) {
  bool says = false;
  Beacon::latched([&](auto member, const Field&) { says = says || says_something(beacon.*member); });
  return says;
}

bool is(ByteView data, std::uint8_t type, std::size_t size) { return data.size == size && data[kTypeAt] == type; }

}  // namespace

std::size_t encode(const Hello& hello, std::uint8_t* out) {
  std::uint8_t* to = out + kFieldsAt;
  out[kTypeAt] = kTypeHello;
  Hello::fields([&](auto member, const Field&) { put_field(to, hello.*member); });
  return kHelloSize;
}

std::size_t encode(const Beacon& beacon, std::uint8_t* out) {
  std::uint8_t* to = out + kFieldsAt;
  const auto put = [&](auto member, const Field&) { put_field(to, beacon.*member); };
  out[kTypeAt] = kTypeBeacon;
  Beacon::always(put);
  if (!has_latched(beacon)) return kBeaconSize;
  Beacon::latched(put);
  return kLongBeaconSize;
}

std::optional<Hello> decode_hello(ByteView data) {
  if (!is(data, kTypeHello, kHelloSize)) return std::nullopt;
  const std::uint8_t* from = data.data + kFieldsAt;
  Hello hello;
  bool legal = true;
  Hello::fields(taker(from, hello, legal));
  return legal ? std::optional(hello) : std::nullopt;
}

std::optional<Beacon> decode_beacon(ByteView data) {
  const bool is_long = is(data, kTypeBeacon, kLongBeaconSize);
  if (!is_long && !is(data, kTypeBeacon, kBeaconSize)) return std::nullopt;
  const std::uint8_t* from = data.data + kFieldsAt;
  Beacon beacon;
  bool legal = true;
  Beacon::always(taker(from, beacon, legal));
  if (is_long) Beacon::latched(taker(from, beacon, legal));
  return legal && is_long == has_latched(beacon) ? std::optional(beacon) : std::nullopt;
}

void put(SliceWriter& line, FoldWord word) {
  std::array<std::uint8_t, kFoldWordSize> bytes{};
  std::uint8_t* to = bytes.data();
  FoldWord::fields([&](auto member, const Field&) { put_field(to, word.*member); });
  *to = fold_check(static_cast<std::uint8_t>(word.kind), word.node);
  line.put(SliceKind::fold, {bytes.data(), bytes.size()});
}

std::optional<FoldWord> fold_word(const Slice& slice) {
  if (slice.kind != SliceKind::fold || slice.bytes.size != kFoldWordSize) return std::nullopt;
  const std::uint8_t* from = slice.bytes.data;
  FoldWord word;
  bool legal = true;
  FoldWord::fields(taker(from, word, legal));
  return legal && *from == fold_check(slice.bytes[0], word.node) ? std::optional(word) : std::nullopt;
}

bool is_news(const Beacon& before, const Beacon& now) {
  bool news = false;
  Beacon::fields(
      [&](auto member, const Field& field) { news = news || (field.news && !(before.*member == now.*member)); });
  return news;
}

bool operator==(const ClockLatch& one, const ClockLatch& other) {
  bool same = true;
  ClockLatch::fields([&](auto member, const Field&) { same = same && one.*member == other.*member; });
  return same;
}

}  // namespace limb_ring::wire
