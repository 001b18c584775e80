#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

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
  /// The limit is reached: the application has not taken its messages, and no more are accepted.
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

/// Calls that have not ended yet, by token. Each gets exactly one end: the daemon's, or if the
/// connection ends first, one from here.
class Pending {
 public:
  enum class Ends : std::uint8_t { with_result, with_reply };

  std::uint32_t add(Ends ends);
  /// @return false if no such call is outstanding: this is a second end, which must not be passed on
  bool remove(std::uint32_t token) { return calls_.erase(token) > 0; }
  /// One of that kind is outstanding.
  bool contains(std::uint32_t token, Ends ends) const {
    const auto call = calls_.find(token);
    return call != calls_.end() && call->second == ends;
  }
  /// Ends one here: with that result, or a Reply holding its reason as its error.
  void end(std::uint32_t token, const Result& result, Inbox& inbox);
  /// Ends all: results `cancelled`, replies with an error.
  void cancel_all(const std::string& reason, Inbox& inbox);

 private:
  std::uint32_t next_ = 1;
  std::map<std::uint32_t, Ends> calls_;
};

/// {"error": "..."}
std::string error_json(const std::string& reason);
/// The text of an error reply; empty if `json` is another reply. Only an error reply has "error" as its first member.
std::string error_of(const std::string& json);

}  // namespace limb_ring::client
