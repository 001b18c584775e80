#pragma once

#include <sys/types.h>

#include <boost/asio/basic_datagram_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <vector>

#include "io/link_counters.h"
#include "io/link_header.h"
#include "io/seal.h"
#include "wire/bytes.h"

namespace limb_ring::link {

using UdpSocket = boost::asio::basic_datagram_socket<boost::asio::ip::udp, boost::asio::io_context::executor_type>;
using UdpAddress = boost::asio::ip::udp::endpoint;

/// @throw std::runtime_error if the address is not numeric, saying so
UdpAddress udp_address(const Endpoint& endpoint);

/// Bound to exactly this endpoint, taking runs of datagrams in one read if the kernel can.
/// @throw std::runtime_error naming the endpoint and the cause
UdpSocket listen_udp(boost::asio::io_context& io, const Endpoint& endpoint);

/// Connected, so that nobody else's datagrams reach it. @return a closed socket if that fails
UdpSocket connect_udp(boost::asio::io_context& io, const UdpAddress& to);

/// One read: a datagram, or a run of them that the kernel has joined (UDP_GRO). All have
/// `segment` bytes but the last, which may have fewer.
struct UdpRead {
  ssize_t size;  ///< -1: see errno
  std::size_t segment;
};
UdpRead receive_run(int socket, std::uint8_t* space, std::size_t size, UdpAddress& from);

/// How many datagrams the socket had no room for, since it was made; modulo 2^32.
std::uint32_t dropped_datagrams(int socket);

/// One write of a run of datagrams of `segment` bytes each (UDP_SEGMENT), the last one possibly
/// shorter; to the connected end. @return as send()
ssize_t send_run(int socket, wire::ByteView bytes, std::size_t segment);

/// Puts slices into datagrams, one each, and sends runs of equal-sized ones in one system call.
/// The kernel then carries a run through its stack as one piece, which is what makes UDP as fast
/// as a stream under load.
class UdpBatch {
 public:
  static constexpr std::size_t kMostLate = 64;  ///< datagrams
  enum class Status { sent, blocked, gone };
  struct Result {
    Status status;
    std::size_t taken;  ///< bytes of slices that need not be given again
  };

  UdpBatch(const Identity& self, OutputCounters& counters);
  /// @param sealer of a keyed line, outlives the session; null: it is not keyed
  void start_session(std::uint64_t session, Sealer* sealer = nullptr);
  /// @param slices whole slices, framed
  Result send(int socket, wire::ByteView slices);
  /// The slice gets its sequence number now, but is sent after the next datagram: it arrives late.
  /// @return false, and it was not taken: kMostLate are held back already
  bool hold_back(wire::ByteView slice);
  /// For tests: one datagram per call, as on kernels without UDP_SEGMENT, which are detected without this.
  void send_singly() { joined_ = false; }

 private:
  struct Run {
    std::size_t slices = 0;  ///< bytes of slices in it
    std::size_t segment = 0;
    std::uint32_t count = 0;
  };
  Run fill(wire::ByteView slices);
  void append(wire::ByteView slice);
  /// Of a datagram, beside its slice.
  std::size_t overhead() const { return kLinkHeaderSize + (sealer_ != nullptr ? kSealSize : 0); }
  /// @return true: done with this run. False: `status` says why not.
  bool transmit(int socket, const Run& run, Status& status);
  void send_late(int socket);

  LinkHeader header_;
  Sealer* sealer_ = nullptr;
  OutputCounters& counters_;
  std::vector<std::uint8_t> buffer_;
  std::size_t size_ = 0;
  bool joined_ = true;
  std::vector<std::vector<std::uint8_t>> late_;  ///< whole datagrams
};

}  // namespace limb_ring::link
