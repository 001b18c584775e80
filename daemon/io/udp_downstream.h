#pragma once

#include <memory>
#include <optional>
#include <string>

#include "io/backlog.h"
#include "io/downstream.h"
#include "io/endpoint.h"
#include "io/link_counters.h"
#include "io/seal.h"
#include "io/udp_batch.h"
#include "io/udp_socket.h"
#include "io/watch.h"

namespace limb_ring::link {

/// A candidate reached over UDP: connects go out until answered, then datagrams of one slice. On a keyed line
/// (protocol.md section 6.14) only what the candidate can prove to have said counts.
class UdpDownstream : public Downstream, public std::enable_shared_from_this<UdpDownstream> {
 public:
  struct Peer {
    std::size_t candidate;
    std::uint8_t id;
  };
  UdpDownstream(boost::asio::io_context& io, UdpAddress address, const Identity& self, Peer peer, Owner& owner,
                OutputCounters& counters);
  bool start() override;
  void write(wire::ByteView slices) override;
  bool hold_back(wire::ByteView slice) override;
  bool drained() const override { return !failed_ && backlog_.empty(); }
  void tick() override { read(); }
  void ask_again() override;
  void close() override;
  void sever() override;

 private:
  void read();
  bool open() const { return owner_ != nullptr; }
  void on_ready(std::uint32_t events);
  void take(wire::ByteView datagram);
  bool is_authentic(const LinkHeader& header, wire::ByteView datagram);
  bool is_of_handshake(const LinkHeader& header, wire::ByteView datagram);
  bool is_of_session(wire::ByteView datagram);
  void take_header(const LinkHeader& header);
  void accept(const LinkHeader& header);
  std::size_t send(wire::ByteView slices);
  void send_backlog();
  bool tell(LinkHeaderType type);
  void fail(std::string reason);

  boost::asio::io_context& io_;
  UdpAddress address_;
  Identity self_;
  Peer peer_;
  Owner* owner_;
  OutputCounters& counters_;
  UdpSocket socket_;
  UdpBatch batch_;
  Nonce asker_{}, answerer_{};  ///< keyed: of this handshake, ours and theirs
  std::optional<Sealer> sealer_;
  std::optional<Opener> opener_;
  std::uint64_t session_;  ///< the upper half is ours; the lower one theirs, 0 until accepted
  bool accepted_ = false;
  event_loop::Backlog backlog_{kMostWaiting};
  bool failed_ = false;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
