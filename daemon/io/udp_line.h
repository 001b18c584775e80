#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/datagram_input.h"
#include "io/input.h"
#include "io/link_counters.h"
#include "io/link_header.h"
#include "io/node_clock.h"
#include "io/output.h"
#include "io/packet_loop.h"
#include "io/seal.h"
#include "io/udp_socket.h"

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

/// The receiving end on a UDP socket: reads it, and hands on each datagram.
class UdpInput : public InputLine, public std::enable_shared_from_this<UdpInput> {
 public:
  /// @throw std::runtime_error if it cannot be bound, with the address and the cause
  UdpInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler, InputReport& report,
           Upstream& upstream);
  void start();
  void close() override;
  std::optional<std::uint8_t> from() const override { return datagrams_.from(); }
  void replace(std::uint8_t by) override { datagrams_.replace(by); }

 private:
  void read();
  void read_after_standstill(Time now);
  /// Reads until nothing is left.
  void drain();
  /// @return false: nothing was there
  bool read_run(Time now);
  void take_run(wire::ByteView run, std::size_t segment, const UdpAddress& sender, Time now);
  void tick(Time now);
  void send(wire::ByteView datagram, const UdpAddress& to);

  boost::asio::io_context& io_;
  InputReport& report_;
  UdpSocket socket_;
  DatagramInput datagrams_;
  std::vector<std::uint8_t> buffer_;
  ReadAgain read_again_;
  std::uint32_t dropped_ = 0;  ///< dropped_datagrams(), when that was last asked
  Suspension suspension_;
  event_loop::Ticker ticker_;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
