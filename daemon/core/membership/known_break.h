#pragma once

#include <optional>

#include "wire/control_message.h"

namespace limb_ring::core {

using wire::NodeId;

/// A line of the ring, by the nodes on both sides of it.
struct BrokenLine {
  NodeId before, behind;
};

/// The broken line that this node knows of; it is stored nowhere else. Only the node behind a break is believed: the
/// beacons of others would still tell of the break after it is mended. (ours, protocol.md section 8.3)
class KnownBreak {
 public:
  explicit KnownBreak(NodeId id) : id_(id) {}

  bool known() const { return known_; }
  std::optional<BrokenLine> line() const {
    if (!known_) return std::nullopt;
    return BrokenLine{before_, behind_};
  }
  /// True if the line into this node is the broken one.
  bool is_own() const { return known_ && behind_ == id_; }

  /// The line from `before` into this node counts as broken.
  void found(NodeId before) { set(before, id_); }
  /// A beacon of another node came. @return true where it tells of a break that is believed
  bool heard(const wire::Beacon& beacon, NodeId source) {
    if (!beacon.break_known || beacon.break_behind != source || is_own()) return false;
    set(beacon.break_before, beacon.break_behind);
    return true;
  }
  /// A beacon of `source` says that it knows of no break.
  void withdrawn_by(NodeId source) {
    if (behind_ == source) known_ = false;
  }
  /// The line into this node is up again, or the second line no longer stands for it.
  void own_mended() {
    if (is_own()) known_ = false;
  }
  /// No fold is left in the ring: only a break that this node sees itself may still be there.
  void keep_own_alone() { known_ = is_own(); }
  /// The ring is closed again. `folded`: it is closed by the second line, which stands for this node's input; then a
  /// break of the own input is still there.
  void ring_closed(bool folded) { known_ = folded && is_own(); }
  void forget() { known_ = false; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("known", known_)("before", before_)("behind", behind_);
  }

 private:
  void set(NodeId before, NodeId behind) {
    known_ = true;
    before_ = before;
    behind_ = behind;
  }

  NodeId id_;
  bool known_ = false;
  NodeId before_{0};
  NodeId behind_{0};
};

}  // namespace limb_ring::core
