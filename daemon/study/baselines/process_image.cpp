#include "study/baselines/process_image.h"

#include <algorithm>

namespace limb_ring::study {

namespace {

constexpr unsigned kFront = 8 + 14 + 2;  // preamble, Ethernet header, EtherCAT header
constexpr unsigned kDatagramHeader = 10, kWorkingCounter = 2;
constexpr unsigned kDatagram = kDatagramHeader + kWorkingCounter;
constexpr unsigned kMostDatagrams = 1498, kLeastDatagrams = 44;
constexpr unsigned kFcs = 4, kGap = 12;

unsigned divided_up(unsigned value, unsigned by) { return (value + by - 1) / by; }

}  // namespace

ProcessImage::ProcessImage(const Medium& medium) : nodes_(medium.nodes), slot_(medium.payload) {
  const unsigned most = kMostDatagrams - (kDatagram + nodes_) - kDatagram;
  frames_ = divided_up(nodes_ * slot_, most);
  share_ = divided_up(nodes_ * slot_, frames_);
}

unsigned ProcessImage::length(unsigned frame) const {
  const unsigned data = std::min(share_, nodes_ * slot_ - frame * share_);
  return kFront + std::max(kDatagram + nodes_ + kDatagram + data, kLeastDatagrams) + kFcs;
}

unsigned ProcessImage::pitch(unsigned frame) const { return length(frame) + kGap; }

unsigned ProcessImage::slot(NodeId node) const {
  return kFront + kDatagram + nodes_ + kDatagramHeader + node * slot_ % share_;
}

unsigned ProcessImage::event(NodeId node) const { return kFront + kDatagramHeader + node; }

}  // namespace limb_ring::study
