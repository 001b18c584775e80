#pragma once

#include "core/archive.h"

namespace limb_ring::study {

/// A 64-bit hash of anything that has an archive() (core/archive.h), such as a whole virtual ring with all that judges
/// it. Mere counters are left out: two states go on in the same way, however many packets were lost on the way to
/// them.
class StateHash : public core::Archive<StateHash> {
 public:
  /// @param nodes of the ring: of tables with an entry for every id only those of its nodes are looked at
  StateHash(unsigned nodes, core::Time now) : nodes_(nodes), now_(now) {}
  std::uint64_t value() const { return value_; }

 private:
  friend class core::Archive<StateHash>;
  static constexpr std::size_t kIds = 256;

  void enter(const char* name) { skipped_ += skipped_ != 0 || std::strcmp(name, "counters") == 0 ? 1u : 0u; }
  void element(std::size_t) { skipped_ += skipped_ != 0 ? 1u : 0u; }
  void leave() { skipped_ -= skipped_ != 0 ? 1u : 0u; }
  template <class T>
  std::size_t elements(std::size_t count) const {
    return count == kIds && sizeof(T) > 1 ? nodes_ : count;
  }
  template <class T>
  void plain(const T& what) {
    static_assert(sizeof what <= sizeof(std::uint64_t) || sizeof what == 2 * sizeof(std::uint64_t));
    if constexpr (sizeof what > sizeof(std::uint64_t)) mix(static_cast<std::uint64_t>(what >> 64));
    mix(static_cast<std::uint64_t>(what));
  }
  void bytes(const std::uint8_t* from, std::size_t size) {
    for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), from += sizeof(std::uint64_t)) {
      std::uint64_t word;
      std::memcpy(&word, from, sizeof word);
      mix(word);
    }
    for (; size > 0; --size) mix(*from++);
  }
  void bytes(const char* from, std::size_t size) { bytes(reinterpret_cast<const std::uint8_t*>(from), size); }
  void view(const wire::ByteView& what) {
    mix(what.size);
    bytes(what.data, what.size);
  }
  std::size_t count(std::size_t size) {
    mix(size);
    return size;
  }
  void instant(const core::Time& time) { plain((time - now_).count()); }
  void mix(std::uint64_t word) {
    if (skipped_ != 0) return;
    value_ = (value_ ^ word) * 0x9E3779B97F4A7C15u;
    value_ ^= value_ >> 32;
  }

  std::size_t nodes_;
  core::Time now_;
  unsigned skipped_ = 0;  ///< so deep in what is left out
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

}  // namespace limb_ring::study
