#pragma once

#include <array>
#include <cstdint>

#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// Exactly once: a receiver remembers, per (SID, kind, unicast or broadcast), the last sequence
/// number it decided, and its verdict. Links keep order, so the last one is enough. (ours, protocol.md section 4.10)
///
/// Numbers are valid within one incarnation of their source. Each packet shows its incarnation (Code), so nothing
/// depends on whether a hello was heard in time: a later incarnation makes the receiver forget the one before, and
/// packets of an earlier one are not taken. The two bits in a packet distinguish the incarnation before the known one,
/// the known one, and the next two; hellos and beacons carry the whole boot number. (ours, protocol.md section 4.8)
class DuplicateMemory {
 public:
  enum class Verdict : std::uint8_t {
    none,
    taken,
    refused,
    doubtful  ///< it may be that of another packet with this number
  };

  /// @param horizon a first try with a number decided longer ago than this is new: no copy of the
  ///        former is left, and numbers wrap unseen behind a line that is down for long. (ours)
  /// @param falls_into_parts two breaks leave two working parts (fold-back). In the other part a source may have begun
  ///        four incarnations unseen, so that Code shows the same one again: verdicts on retries hold no longer than
  ///        tries go on
  DuplicateMemory(Duration horizon, bool falls_into_parts) : horizon_(horizon), falls_into_parts_(falls_into_parts) {}

  /// A packet of that incarnation came.
  /// @return false if a later incarnation of its source is known: the packet must not be taken
  bool meet(wire::NodeId source, wire::Incarnation incarnation) {
    Source& s = sources_[source];
    switch (s.known ? (incarnation - s.incarnation) & 3 : 2) {
      case 0:
        return true;
      case 3:
        return false;
      default:
        break;
    }
    s.entries = {};
    s.known = s.from_packet = true;
    s.incarnation = incarnation;
    return true;
  }
  /// A hello with that boot number came. It is the first packet of its incarnation.
  /// @return false if a later incarnation of its source is known
  bool meet_hello(wire::NodeId source, std::uint64_t boot) {
    return meet_boot(source, boot, [](Source& s) { s = {}; });
  }
  /// A beacon with that boot number came. If its hello was missed, other packets of this incarnation may have come
  /// before the beacon: verdicts on them stay. But if the last hello or beacon heard had the same two bits, it is at
  /// least four incarnations old, and nobody can tell to which one a verdict belongs: recent ones stay, for retries.
  /// @return false if a later incarnation of its source is known
  bool meet_beacon(wire::NodeId source, std::uint64_t boot, Time now) {
    return meet_boot(source, boot, [&](Source& s) {
      if (s.incarnation != wire::incarnation_of(boot)) s = {};
      if (!s.from_packet) age(s, now);
    });
  }

  /// The verdict on this sequence number, `none` if it is new. @pre meet() was true
  Verdict verdict(wire::NodeId source, wire::Code code, bool broadcast, Time now) const {
    const Entry& e = sources_[source].entries[place(code, broadcast)];
    if (e.sequence != code.sequence) return Verdict::none;
    const bool fresh = !e.aged && now - e.decided <= horizon_;
    if (e.verdict == Verdict::none || (code.attempt == 0 && !fresh)) return Verdict::none;
    return e.in_doubt || (falls_into_parts_ && is_old(e, now)) ? Verdict::doubtful : e.verdict;
  }
  void remember(wire::NodeId source, wire::Code code, bool broadcast, Verdict verdict, Time now) {
    sources_[source].entries[place(code, broadcast)] = {now, code.sequence, verdict};
  }

  /// The node's input is lost.
  void input_lost() {
    for (Source& source : sources_)
      for (Entry& e : source.entries) e.on_former_input = true;
  }
  /// For a node that starts over: numbers may have wrapped since its input was last lost. What it decided on the
  /// present one it knows: it has missed nothing there, and a line may have doubled what it took. In a ring that falls
  /// into parts the same copy may come again, by another way: no verdict that is younger than a copy can be is
  /// forgotten, but none is given either. Which incarnations it has met stays known, too.
  void forget_verdicts(Time now) {
    for (Source& source : sources_)
      for (Entry& e : source.entries) {
        if (!falls_into_parts_ && e.on_former_input) e = {};
        if (falls_into_parts_ && now - e.decided > horizon_) e = {};
        e.in_doubt = falls_into_parts_;
      }
  }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("sources", sources_);
  }

 private:
  /// A boot number that is lower by at most this is of an earlier incarnation; by more: the node's clock was set back.
  static constexpr std::uint64_t kEarlier = 1000;

  struct Entry {
    Time decided{};
    wire::Sequence sequence{};
    Verdict verdict = Verdict::none;
    bool aged = false;
    bool on_former_input = false;
    bool in_doubt = false;  ///< decided before the node started over: numbers may have wrapped since

    template <class Archive>
    void archive(Archive& a) {
      a("decided", decided)("sequence", sequence)("verdict", verdict)("aged", aged)("on_former_input", on_former_input);
      a("in_doubt", in_doubt);
    }
  };
  struct Source {
    std::array<Entry, 4> entries{};
    std::uint64_t boot = 0;  ///< of the last hello or beacon; 0: none was heard
    wire::Incarnation incarnation{};
    bool known = false;
    bool from_packet = false;  ///< the incarnation is known from a packet alone

    template <class Archive>
    void archive(Archive& a) {
      a("entries", entries)("boot", boot)("incarnation", incarnation)("known", known)("from_packet", from_packet);
    }
  };
  template <class Forget>
  bool meet_boot(wire::NodeId source, std::uint64_t boot, Forget forget) {
    Source& s = sources_[source];
    if (s.boot == boot) return true;
    if (s.boot > boot && s.boot - boot <= kEarlier) return false;
    forget(s);
    s.known = true;
    s.from_packet = false;
    s.incarnation = wire::incarnation_of(boot);
    s.boot = boot;
    return true;
  }
  /// Decided longer ago than the tries of a packet last, unless its source had to wait.
  bool is_old(const Entry& e, Time now) const { return now - e.decided > wire::kTries * horizon_; }
  /// From now on first tries are new. Retries stay known as long as a try of the same packet may still come.
  void age(Source& s, Time now) const {
    for (Entry& e : s.entries) {
      if (is_old(e, now)) e = {};
      e.aged = true;
    }
  }
  static std::size_t place(wire::Code code, bool broadcast) {
    return (code.interrupt ? 2u : 0u) + (broadcast ? 1u : 0u);
  }

  Duration horizon_;
  bool falls_into_parts_;
  std::array<Source, 256> sources_{};
};

}  // namespace limb_ring::core
