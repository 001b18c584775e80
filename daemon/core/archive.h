#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/slot_queue.h"
#include "core/time.h"
#include "wire/slice.h"

/// Turns the state of a network controller into bytes, so that another controller can go on from them. Each class lists
/// its members, with their names, in one place, its archive():
///
///     template <class Archive>
///     void archive(Archive& a) {
///       a("open", open_)("hop", hop_);
///     }
///
/// The same function writes, reads and describes the state. A test that goes on from copies of random states finds a
/// member that is missing there. (ours)
namespace limb_ring::core {

namespace archived {
template <class T>
struct IsNumber : std::false_type {};
template <class What>
struct IsNumber<wire::Number<What>> : std::true_type {};
/// Written as they lie in memory.
template <class T>
constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, Int128>;
}  // namespace archived

/// The base of all archives. It handles containers: first the count, then the elements. `Derived` provides plain(),
/// bytes(), view() and count(); enter(), element() and leave() tell it where in the state it is. It may provide its own
/// instant() or elements().
template <class Derived>
class Archive {
 public:
  template <class T>
  Derived& operator()(const char* name, T& what) {
    self().enter(name);
    value(what);
    self().leave();
    return self();
  }
  /// The first `size` bytes of an array; `size` is archived before it.
  template <std::size_t kMost, class Size>
  Derived& operator()(const char* name, std::array<std::uint8_t, kMost>& bytes, Size size) {
    self().enter(name);
    self().bytes(bytes.data(), size < kMost ? static_cast<std::size_t>(size) : kMost);
    self().leave();
    return self();
  }

 protected:
  ~Archive() = default;
  /// A point in time: its picoseconds.
  void instant(Time& time) {
    Int128 count = time.time_since_epoch().count();
    self().plain(count);
    time = Time{Duration{count}};
  }
  /// @return how many of a container's `count` elements are archived
  template <class T>
  std::size_t elements(std::size_t count) {
    return count;
  }

 private:
  Derived& self() { return static_cast<Derived&>(*this); }

  template <class T>
  void value(T& what) {
    if constexpr (archived::is_plain<T>) {
      self().plain(what);
    } else if constexpr (archived::IsNumber<T>::value) {
      std::uint8_t number = what;
      self().plain(number);
      what = T{number};
    } else {
      container(what);
    }
  }
  void container(wire::ByteView& bytes) { self().view(bytes); }
  void container(Time& time) { self().instant(time); }
  void container(Duration& span) {
    Int128 count = span.count();
    self().plain(count);
    span = Duration{count};
  }
  template <std::size_t kBits>
  void container(std::bitset<kBits>& bits) {
    for (std::size_t i = 0; i < kBits; ++i) {
      bool bit = bits[i];
      self().plain(bit);
      bits[i] = bit;
    }
  }
  template <class T, std::size_t kSize>
  void container(std::array<T, kSize>& all) {
    each(all);
  }
  template <class T>
  void container(std::optional<T>& maybe) {
    bool there = maybe.has_value();
    self().plain(there);
    if (!there) return maybe.reset();
    if (!maybe) maybe.emplace();
    value(*maybe);
  }
  template <class T>
  void container(std::vector<T>& all) {
    all.resize(self().count(all.size()));
    each(all);
  }
  template <class T>
  void container(std::deque<T>& all) {
    all.resize(self().count(all.size()));
    each(all);
  }
  template <class T>
  void container(SlotQueue<T>& all) {
    const std::size_t count = self().count(all.size());
    while (all.size() < count) all.push();
    each(all);
  }
  void container(std::string& text) {
    text.resize(self().count(text.size()));
    self().bytes(text.data(), text.size());
  }
  template <class... T>
  void container(std::variant<T...>& one) {
    std::uint8_t index = static_cast<std::uint8_t>(one.index());
    self().plain(index);
    std::size_t place = 0;
    ((place++ == index && one.index() != index ? void(one.template emplace<T>()) : void()), ...);
    std::visit([this](auto& what) { value(what); }, one);
  }
  void container(wire::SliceWriter& slices) {
    std::vector<std::uint8_t> framed(slices.view().begin(), slices.view().end());
    container(framed);
    slices.clear();
    wire::ByteView rest{framed.data(), framed.size()};
    for (wire::SliceParse parse; (parse = wire::parse_slice(rest)).status == wire::SliceParse::Status::slice;
         rest = rest.from(parse.consumed))
      slices.put(parse.slice.kind, parse.slice.bytes);
  }
  template <class All>
  void each(All& all) {
    const std::size_t end = self().template elements<typename All::value_type>(all.size());
    for (std::size_t i = 0; i < end; ++i) {
      self().element(i);
      value(all[i]);
      self().leave();
    }
  }
  template <class T>
  auto container(T& what) -> decltype(what.archive(*this)) {
    what.archive(self());
  }
};

/// Writes a state into a buffer of the caller's. The state does not change.
class StateWriter : public Archive<StateWriter> {
 public:
  StateWriter(std::uint8_t* room, std::size_t size) : first_(room), next_(room), end_(room + size) {}
  /// Bytes written.
  std::size_t size() const { return static_cast<std::size_t>(next_ - first_); }
  std::size_t left() const { return static_cast<std::size_t>(end_ - next_); }
  /// Where the next byte goes.
  const std::uint8_t* next() const { return next_; }
  /// `size` bytes for the caller to write; null if there is no room for them.
  std::uint8_t* space(std::size_t size) {
    failed_ = failed_ || size > left();
    if (failed_) return nullptr;
    next_ += size;
    return next_ - size;
  }
  /// There was not room enough.
  bool failed() const { return failed_; }

 private:
  friend class Archive<StateWriter>;
  void enter(const char*) {}
  void element(std::size_t) {}
  void leave() {}
  template <class T>
  void plain(const T& what) {
    bytes(&what, sizeof what);
  }
  void bytes(const void* from, std::size_t size) {
    std::uint8_t* const to = space(size);
    if (to != nullptr && size != 0) std::memcpy(to, from, size);
  }
  void view(const wire::ByteView& what) {
    plain(static_cast<std::uint32_t>(what.size));
    bytes(what.data, what.size);
  }
  std::size_t count(std::size_t size) {
    plain(static_cast<std::uint32_t>(size));
    return size;
  }

  std::uint8_t *first_, *next_, *end_;
  bool failed_ = false;
};

/// Reads what a StateWriter has written. Other bytes give an arbitrary state; see complete().
class StateReader : public Archive<StateReader> {
 public:
  explicit StateReader(wire::ByteView bytes) : rest_(bytes) {}
  /// True if no byte was missing, and none is left.
  bool complete() const { return !failed_ && rest_.empty(); }
  bool failed() const { return failed_; }
  wire::ByteView rest() const { return rest_; }

 private:
  friend class Archive<StateReader>;
  void enter(const char*) {}
  void element(std::size_t) {}
  void leave() {}
  template <class T>
  void plain(T& what) {
    bytes(&what, sizeof what);
  }
  void plain(bool& what) {
    std::uint8_t byte = 0;
    bytes(&byte, 1);
    what = byte != 0;
  }
  void bytes(void* to, std::size_t size) {
    failed_ = failed_ || size > rest_.size;
    if (failed_) return;
    std::memcpy(to, rest_.data, size);
    rest_ = rest_.from(size);
  }
  /// Points into what is read.
  void view(wire::ByteView& what) {
    std::uint32_t size = 0;
    plain(size);
    failed_ = failed_ || size > rest_.size;
    if (failed_) return;
    what = rest_.first(size);
    rest_ = rest_.from(size);
  }
  /// No more than there are bytes left: every element takes one at least.
  std::size_t count(std::size_t) {
    std::uint32_t count = 0;
    plain(count);
    failed_ = failed_ || count > rest_.size;
    return failed_ ? 0 : count;
  }

  wire::ByteView rest_;
  bool failed_ = false;
};

/// A hash of the layout of a state: it differs if the members, their names, sizes or order differ. It depends on the
/// program, not on the values of one state.
class StateLayout : public Archive<StateLayout> {
 public:
  std::uint64_t value() const { return value_; }

 private:
  friend class Archive<StateLayout>;
  void enter(const char* name) {
    while (*name != 0) mix(static_cast<std::uint8_t>(*name++));
  }
  void element(std::size_t) {}
  void leave() {}
  template <class T>
  void plain(const T&) {
    mix(sizeof(T));
  }
  void bytes(const void*, std::size_t) { mix(0xB5); }
  void view(const wire::ByteView&) { mix(0xB6); }
  /// One element of each container, so that the layout of its elements counts, too.
  std::size_t count(std::size_t) { return 1; }
  void mix(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3u; }  // FNV-1a

  std::uint64_t value_ = 0xCBF29CE484222325u;
};

}  // namespace limb_ring::core
