#pragma once

#include <array>
#include <memory>
#include <string>

#include "link/backlog.h"
#include "link/counters.h"
#include "link/downstream.h"
#include "link/endpoint.h"
#include "link/unix_socket.h"

namespace limb_ring::link {

/// A candidate reached over a UNIX-domain stream socket: a connect header and slices go out, headers
/// come back.
class UnixDownstream : public Downstream, public std::enable_shared_from_this<UnixDownstream> {
 public:
  UnixDownstream(boost::asio::io_context& io, std::string path, const Identity& self, std::size_t candidate,
                 Owner& owner, OutputCounters& counters);
  bool start() override;
  void write(wire::ByteView slices) override;
  bool drained() const override { return !failed_ && backlog_.empty(); }
  void read() override;
  void ask_again() override {}
  void close() override;

 private:
  bool open() const { return owner_ != nullptr; }
  void wait_for_headers();
  void wait_for_room();
  void take_header();
  void send_backlog();
  void fail(std::string reason);

  boost::asio::io_context& io_;
  std::string path_;
  Identity self_;
  std::size_t candidate_;
  Owner* owner_;
  OutputCounters& counters_;
  UnixSocket socket_;
  std::array<std::uint8_t, kLinkHeaderSize> header_{};
  std::size_t header_size_ = 0;
  Backlog backlog_;
  bool failed_ = false;
};

}  // namespace limb_ring::link
