#pragma once

#include <boost/asio/io_context.hpp>
#include <map>
#include <memory>
#include <vector>

#include "event_loop/ticker.h"
#include "event_loop/watch.h"
#include "link/admission.h"
#include "link/link_header.h"
#include "link/seal.h"
#include "link/sequence_check.h"
#include "link/silence.h"
#include "link/udp_socket.h"
#include "link/upstream.h"

namespace limb_ring::link {

/// The receiving end on a UDP socket. A connect is answered with the offer of a session; the
/// first slice in that session takes it up. So a connect that the network has kept for an hour
/// changes nothing. On a keyed line (protocol.md section 6.14) a datagram of somebody without the key leaves nothing
/// behind but its count.
class UdpInput : public InputLine, public std::enable_shared_from_this<UdpInput> {
 public:
  /// @throw std::runtime_error where it cannot be bound, with the address and the cause
  UdpInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler, InputReport& report,
           Upstream& upstream);
  void start();
  void close() override;
  std::optional<std::uint8_t> from() const override;
  void replace(std::uint8_t by) override;

 private:
  struct Session {
    std::uint64_t number = 0;
    UdpAddress address;
    Time since{};
    Nonce asker{}, answerer{};     ///< keyed: of its handshake, theirs and ours
    std::optional<Sealer> sealer;  ///< keyed: signs of life and refusals
    std::optional<Opener> opener;  ///< keyed: slices
  };

  void drain();
  void take_run(std::size_t size, std::size_t segment, const UdpAddress& sender);
  void take(wire::ByteView datagram, const UdpAddress& sender);
  void take_slices(const LinkHeader& header, wire::ByteView bytes, const UdpAddress& sender);
  void hand_on(wire::ByteView bytes);
  void on_unknown_peer(const std::string& why);
  void on_connect(const LinkHeader& header, wire::ByteView datagram, const UdpAddress& sender);
  void turn_away(const LinkHeader& connect, LinkHeader& refuse, const Nonce& asker, const UdpAddress& sender);
  Session new_session(const LinkHeader& connect, const Nonce& asker) const;
  bool may_ask(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender);
  bool is_authentic(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender);
  bool is_unsealed(const LinkHeader& header, wire::ByteView& datagram);
  void hint(const LinkHeader& connect, Refusal refusal, const UdpAddress& sender);
  void accept(const Session& session, std::uint8_t node);
  bool take_up_offer(const LinkHeader& header);
  void on_stale(const LinkHeader& header, const UdpAddress& sender);
  bool present(const LinkHeader& header) const;
  void gap(std::uint32_t lost);
  void lose(std::string_view reason);
  void tick(Time now);
  void drop_old_offers(Time now);
  void tell(LinkHeaderType type, Session& session, Refusal refusal = Refusal::none);
  void send(wire::ByteView datagram, const UdpAddress& to);
  /// Sends `message`, on a keyed line with a tag behind it. @param to the node that has asked
  void send_tagged(wire::ByteView message, const Nonce& asker, std::uint8_t to, const UdpAddress& address);

  boost::asio::io_context& io_;
  InputSettings settings_;
  InputHandler& handler_;
  InputReport& report_;
  Upstream& upstream_;
  Admission admission_;
  UdpSocket socket_;
  std::vector<std::uint8_t> buffer_;
  std::map<std::uint8_t, Session> offers_;  ///< by node id: at most as many as the ring has
  std::optional<std::uint8_t> from_;
  Session session_;
  SequenceCheck sequence_;
  Silence silence_;
  event_loop::Ticker ticker_;
  bool batch_ = false;       ///< something was handed on since the last on_batch_end
  bool hinted_ = false;      ///< one answer that nobody can trust per tick is enough
  bool told_stale_ = false;  ///< one answer to stale sessions per tick is enough
  bool closed_ = false;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
