#pragma once

#include <array>
#include <memory>
#include <string>

#include "event_loop/watch.h"
#include "link/backlog.h"
#include "link/counters.h"
#include "link/downstream.h"
#include "link/endpoint.h"
#include "link/udp_batch.h"
#include "link/udp_socket.h"

namespace limb_ring::link {

/// A candidate reached over UDP: connects go out until answered, then datagrams of one slice.
class UdpDownstream : public Downstream, public std::enable_shared_from_this<UdpDownstream> {
 public:
  UdpDownstream(boost::asio::io_context& io, UdpAddress address, const Identity& self, std::size_t candidate,
                Owner& owner, OutputCounters& counters);
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
  void take_header(const LinkHeader& header);
  void accept(const LinkHeader& header);
  std::size_t send(wire::ByteView slices);
  void send_backlog();
  bool tell(LinkHeaderType type);
  void fail(std::string reason);

  boost::asio::io_context& io_;
  UdpAddress address_;
  Identity self_;
  std::size_t candidate_;
  Owner* owner_;
  OutputCounters& counters_;
  UdpSocket socket_;
  UdpBatch batch_;
  std::uint64_t session_;  ///< the upper half is ours; the lower one theirs, 0 until accepted
  bool accepted_ = false;
  Backlog backlog_;
  bool failed_ = false;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
