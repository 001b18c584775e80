#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <vector>

#include "io/datagram_input.h"
#include "io/read_again.h"
#include "io/ticker.h"
#include "io/watch.h"

namespace limb_ring::link {

/// The receiving end on a UDP socket: reads it, and hands on each datagram.
class UdpInput : public InputLine, public std::enable_shared_from_this<UdpInput> {
 public:
  /// @throw std::runtime_error where it cannot be bound, with the address and the cause
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
  event_loop::Ticker ticker_;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
