#pragma once

#include <array>
#include <cstdint>

#include "core/mutation.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// Exactly once: a receiver remembers, per (SID, kind, unicast or broadcast), the last sequence
/// number it decided, and its verdict. Links keep order, so the last one is enough. (ours)
class DuplicateMemory {
 public:
  enum class Verdict : std::uint8_t { none, taken, refused };

  /// @param horizon a first try with a number decided longer ago than this is new: no copy of the
  ///        former is left, and numbers wrap unseen behind a line that is down for long. (ours)
  explicit DuplicateMemory(Duration horizon) : horizon_(horizon) {}

  /// The verdict on this sequence number, `none` where it is new.
  Verdict verdict(wire::NodeId source, wire::Code code, bool broadcast, Time now) const {
    const Entry& e = entry(source, code, broadcast);
    if (e.sequence != code.sequence || broken(Mutation::forgets_duplicates)) return Verdict::none;
    const bool fresh = !e.aged && now - e.decided <= horizon_;
    return fresh || code.attempt > 0 ? e.verdict : Verdict::none;
  }
  void remember(wire::NodeId source, wire::Code code, bool broadcast, Verdict verdict, Time now) {
    entry(source, code, broadcast) = {now, code.sequence, verdict, false};
  }
  void forget(wire::NodeId source) { entries_[source] = {}; }
  void forget_all() { entries_ = {}; }
  /// From now on a first try is new, whatever its number; a retry is still known. For a node that
  /// was bypassed, until its hello is home: until then a source may repeat what was taken before.
  void age_all() { each([](Entry& e) { e.aged = true; }); }
  void forget_aged() {
    each([](Entry& e) {
      if (e.aged) e = {};
    });
  }

 private:
  struct Entry {
    Time decided{};
    std::uint8_t sequence = 0;
    Verdict verdict = Verdict::none;
    bool aged = false;
  };
  template <class Visit>
  void each(Visit visit) {
    for (auto& source : entries_)
      for (Entry& e : source) visit(e);
  }
  static std::size_t place(wire::Code code, bool broadcast) {
    return (code.interrupt ? 2u : 0u) + (broadcast ? 1u : 0u);
  }
  const Entry& entry(wire::NodeId source, wire::Code code, bool broadcast) const {
    return entries_[source][place(code, broadcast)];
  }
  Entry& entry(wire::NodeId source, wire::Code code, bool broadcast) {
    return entries_[source][place(code, broadcast)];
  }

  Duration horizon_;
  std::array<std::array<Entry, 4>, 256> entries_{};
};

}  // namespace limb_ring::core
