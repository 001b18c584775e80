#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include "io/admission.h"
#include "io/input.h"
#include "io/link_header.h"
#include "io/seal.h"
#include "io/udp_socket.h"

namespace limb_ring::link {

/// Discards what comes late or twice on a line that may reorder or double datagrams. (ours, protocol.md section 6.7)
class SequenceCheck {
 public:
  struct Arrival {
    bool fresh;          ///< false: lower or equal to one already seen; discard
    std::uint32_t lost;  ///< so many before this one are missing
  };
  /// A session's first number is 1. Numbers wrap.
  Arrival check(std::uint32_t sequence) {
    const std::uint32_t ahead = sequence - next_;
    if (ahead >= 0x80000000u) return {false, 0};
    next_ = sequence + 1;
    return {true, ahead};
  }
  void restart() { next_ = 1; }

 private:
  std::uint32_t next_ = 1;
};

/// What the receiving end of a UDP line makes of datagrams, and what it answers. Knows no socket: who has one hands in
/// what comes and the time, and sends what it is given. A connect is answered with the offer of a session; the first
/// slice in that session takes it up. So a connect that the network has kept for an hour changes nothing. On a keyed
/// line a datagram of somebody without the key leaves nothing behind but its count. (ours, protocol.md sections 6.7,
/// 6.8, 6.14)
class DatagramInput {
 public:
  using Send = std::function<void(wire::ByteView datagram, const UdpAddress& to)>;

  /// @param line as it is known to `upstream`
  DatagramInput(const InputSettings& settings, InputLine& line, InputHandler& handler, InputReport& report,
                Upstream& upstream, Send send);

  /// The handler may close this line in this call, and in those of end_batch(), tick() and lose_if_silent().
  void take(wire::ByteView datagram, const UdpAddress& sender, Time now);
  /// No more datagrams are there for now.
  void end_batch();
  /// To be called every `timing.idle`. @return true if nothing has come for `timing.silence`: take() what is there,
  /// then call lose_if_silent()
  bool tick(Time now);
  void lose_if_silent();
  /// Silence::stood_still(), if somebody is upstream.
  bool stood_still(Time now) const { return from_ && silence_.stood_still(now); }
  /// The neighbour ends its session by it; on a keyed line it has to be authentic, and is not taken twice.
  bool is_bye(wire::ByteView datagram);
  /// The neighbour has given this end up while it stood still: the session is over, and what waited is stale.
  void given_up();

  std::optional<std::uint8_t> from() const { return from_; }
  /// As InputLine's.
  void replace(std::uint8_t by);
  /// Hangs up. No call of the handler afterwards, and nothing is sent.
  void close();
  bool closed() const { return closed_; }

 private:
  struct Session {
    std::uint64_t number = 0;
    UdpAddress address;
    Time since{};
    Nonce asker{}, answerer{};     ///< keyed: of its handshake, theirs and ours
    std::optional<Sealer> sealer;  ///< keyed: signs of life and refusals
    std::optional<Opener> opener;  ///< keyed: slices
  };

  void take_slices(const LinkHeader& header, wire::ByteView bytes, const UdpAddress& sender, Time now);
  void hand_on(wire::ByteView bytes);
  void on_unknown_peer(const std::string& why);
  void on_connect(const LinkHeader& header, wire::ByteView datagram, const UdpAddress& sender, Time now);
  void turn_away(const LinkHeader& connect, LinkHeader& refuse, const Nonce& asker, const UdpAddress& sender);
  Session new_session(const LinkHeader& connect, const Nonce& asker) const;
  bool may_ask(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender);
  bool is_authentic(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender);
  bool is_unsealed(const LinkHeader& header, wire::ByteView& datagram);
  void hint(const LinkHeader& connect, Refusal refusal, const UdpAddress& sender);
  void accept(const Session& session, std::uint8_t node);
  /// @return false if it has become too late; the sender has been told then
  bool take_up(Session offer, const LinkHeader& header, Time now);
  void count_stale(const LinkHeader& header);
  void on_stale(const LinkHeader& header, const UdpAddress& sender);
  bool present(const LinkHeader& header) const;
  void gap();
  void lose(std::string_view reason);
  void drop_old_offers(Time now);
  void tell(LinkHeaderType type, Session& session, Refusal refusal = Refusal::none);
  void send(wire::ByteView datagram, const UdpAddress& to);
  /// Sends `message`, on a keyed line with a tag behind it. @param to the node that has asked
  void send_tagged(wire::ByteView message, const Nonce& asker, std::uint8_t to, const UdpAddress& address);

  Identity self_;
  Timing timing_;
  InputLine& line_;
  InputHandler& handler_;
  InputReport& report_;
  Upstream& upstream_;
  Send send_;
  Admission admission_;
  std::map<std::uint8_t, Session> offers_;  ///< by node id: at most as many as the ring has
  std::optional<std::uint8_t> from_;
  Session session_;
  SequenceCheck sequence_;
  Silence silence_;
  bool batch_ = false;       ///< something was handed on since the last on_batch_end
  bool hinted_ = false;      ///< one answer that is not authenticated per tick is enough
  bool told_stale_ = false;  ///< one answer to stale sessions per tick is enough
  bool closed_ = false;
};

}  // namespace limb_ring::link
