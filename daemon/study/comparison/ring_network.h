#pragma once

#include <functional>
#include <utility>

#include "study/comparison/network.h"

namespace limb_ring::study {

/// Our ring as a method among others: the core of the daemon, sim::VirtualRing, with lines of rate R
/// and relay delay d, beacons off, joined before time zero. (ours; protocol.md section 7.2)
///
/// Delivered is what the destination's controller has in its receive buffer with a good CRC; an
/// interrupt-like message is an INTP, delivered when the pin is pulled.
class RingNetwork : public Network {
 public:
  /// @param goes_on called now and then while it is at work: large rings take long
  explicit RingNetwork(std::function<void()> goes_on = [] {}) : goes_on_(std::move(goes_on)) {}

  /// @throw std::runtime_error where the ring does not close: the settings are wrong
  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// Until the hello is home: the longest time for several moments spread over a lap. The links are moved,
  /// and packets that are on them at that moment are lost and sent again by their sources.
  /// @throw std::runtime_error as above
  Duration time_to_join(const Medium& medium) const override;

 private:
  /// @param wait in full load, before the newcomer is switched on
  Duration time_to_join_after(const Medium& medium, Duration wait) const;

  std::function<void()> goes_on_;
};

}  // namespace limb_ring::study
