#pragma once

#include <atomic>
#include <utility>

namespace limb_ring::bridge {

/// Whether all publishers of a topic of any type are connected to its subscription. (ours)
///
/// roscpp takes type and definition of the first publisher for those of the subscription, and publishers with others
/// refuse it: nobody is told. So a subscription that had a publisher and has none any more is made anew; it takes any
/// type again. Where a publisher is there and not connected while others are, a person has to be told.
class PublisherCheck {
 public:
  enum class Verdict { well, renew, warn };

  /// Any thread: the subscription has a type.
  void heard() { has_type_ = true; }
  /// Something may have changed since the last look, or is not yet clear. What is not seen from here, such as a further
  /// publisher of another type, is left to a look now and then.
  bool wants_look(unsigned connected) {
    if (connected > 0) has_type_ = true;
    return connected != connected_ || (connected == 0 && has_type_) || (missing_ > 0 && !warned_);
  }
  /// @param published nodes that publish it, as far as the master knows
  /// @param connected those that are connected
  /// @return renew: the subscription is to be made anew; warn: tell a person, once
  Verdict look(unsigned published, unsigned connected) {
    connected_ = connected;
    missing_ = published > connected ? missing_ + 1 : 0;
    if (missing_ == 0) warned_ = false;
    alone_ = connected == 0 && (published > 0 || has_type_) ? alone_ + 1 : 0;
    if (alone_ >= kLooks) {
      alone_ = missing_ = 0;
      has_type_ = false;
      return Verdict::renew;
    }
    if (connected == 0 || missing_ < kLooks || std::exchange(warned_, true)) return Verdict::well;
    return Verdict::warn;
  }

 private:
  // A publisher that has just come is not yet connected, and of one that has just gone messages may still wait.
  static constexpr unsigned kLooks = 2;

  std::atomic<bool> has_type_{false};
  unsigned connected_ = 0;  ///< at the last look
  unsigned missing_ = 0;    ///< looks in a row at which a publisher was there, and not connected
  bool warned_ = false;     ///< of those
  unsigned alone_ = 0;      ///< looks in a row at which none was connected, though there is or was one
};

}  // namespace limb_ring::bridge
