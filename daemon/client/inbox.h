#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "limb_ring/host_port.h"

namespace limb_ring::client {

/// What has come and was not yet taken by the application.
///
/// Interrupts are handed out first. Everything else keeps its order of arrival, except that a
/// packet's place in that order is given to the packet of the highest priority that is here.
/// Limits: Observed and CapturedPacket to 4096 each, those beyond are counted; all together to 65536, see full(), of
/// which packets are few by the credit granted to the daemon.
class Inbox {
 public:
  /// @pre its priority is 0 to 3
  void put(Packet packet);
  void put(Interrupt interrupt);
  void put(Observed observed);
  void put(ObservedLost lost);
  void put(CapturedPacket captured);
  void put(CaptureCounts counts) { put_other(counts); }
  void put(Result result) { put_other(std::move(result)); }
  void put(Reply reply) { put_other(std::move(reply)); }
  void put(Disconnected end) { put_other(std::move(end)); }

  std::optional<Message> take();
  std::optional<Result> take_result(std::uint32_t token);
  std::optional<Reply> take_reply(std::uint32_t token);
  bool empty() const;
  /// The application has left so many messages untaken that no more are accepted.
  bool full() const;

 private:
  struct Other {
    std::uint64_t arrival;
    Message message;
  };
  void put_other(Message message);
  void tell_lost();
  bool packet_is_next() const;
  Packet take_packet();
  Message take_other();
  template <typename Kind>
  std::optional<Kind> take_with_token(std::uint32_t token);

  std::uint64_t arrivals_ = 0;
  std::deque<Interrupt> interrupts_;
  std::array<std::deque<Packet>, 4> packets_;  // by priority
  std::deque<std::uint64_t> packet_turns_;     // arrivals of the packets, whichever takes the turn
  std::deque<Other> others_;
  std::size_t observed_ = 0;
  std::uint64_t observed_lost_ = 0;
  std::size_t captured_ = 0;
  std::uint32_t captured_lost_ = 0;
};

}  // namespace limb_ring::client
