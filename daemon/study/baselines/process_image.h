#pragma once

#include "study/analysis/medium.h"

namespace limb_ring::study {

/// How EtherCAT's process image lies in its frames. All in bytes, from the first of the preamble.
class ProcessImage {
 public:
  explicit ProcessImage(const Medium& medium);

  unsigned frames() const { return frames_; }
  /// Preamble to FCS.
  unsigned length(unsigned frame) const;
  /// To the first byte of the next frame.
  unsigned pitch(unsigned frame) const;

  /// The frames with the first and the last byte of the node's slot.
  unsigned first_frame(NodeId node) const { return node * slot_ / share_; }
  unsigned last_frame(NodeId node) const { return (node * slot_ + slot_ - 1) / share_; }
  /// The first byte of its slot in first_frame().
  unsigned slot(NodeId node) const;
  /// Its byte for interrupt-like messages, in every frame.
  unsigned event(NodeId node) const;

 private:
  unsigned nodes_, slot_;
  unsigned frames_;
  unsigned share_;  ///< of the image, in every frame but the last
};

}  // namespace limb_ring::study
