#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "io/backlog.h"
#include "io/downstream.h"
#include "io/endpoint.h"
#include "io/link_counters.h"
#include "io/unique_fd.h"
#include "io/watch.h"

namespace limb_ring::link {

/// A candidate reached over a UNIX-domain stream socket: a connect header and slices go out, headers
/// come back.
class UnixDownstream : public Downstream, public std::enable_shared_from_this<UnixDownstream> {
 public:
  UnixDownstream(boost::asio::io_context& io, std::string path, const Identity& self, std::size_t candidate,
                 Owner& owner, OutputCounters& counters);
  bool start() override;
  void write(wire::ByteView slices) override;
  bool drained() const override { return !failed_ && backlog_.size() <= may_wait(); }
  void tick() override { read(); }
  void ask_again() override {}
  void close() override;

 protected:
  /// Sends the first header. @return false where it cannot
  virtual bool greet(const LinkHeader& connect);
  /// Sends what there is room for. @return bytes sent; -1 and `reason` if the line has failed
  virtual std::ptrdiff_t put(wire::ByteView slices, std::string& reason);
  /// So many bytes may wait here before the line takes no more: none, since a socket holds enough.
  virtual std::size_t may_wait() const { return 0; }
  /// Called when something waits for room. @return the epoll events that tell of room
  virtual std::uint32_t wait_for_room();

  bool open() const { return owner_ != nullptr; }
  const Agreement& agreement() const { return self_.agreement; }
  int socket() const { return socket_.get(); }
  OutputCounters& counters() { return counters_; }
  /// What waits is sent soon.
  void try_again() { watch_.call_again(); }
  void heard() { owner_->on_heard(candidate_); }

 private:
  void read();
  void on_ready(std::uint32_t events);
  void take_header();
  void send_backlog();
  std::size_t send(wire::ByteView slices);
  void fail(std::string reason);

  boost::asio::io_context& io_;
  std::string path_;
  Identity self_;
  std::size_t candidate_;
  Owner* owner_;
  OutputCounters& counters_;
  process::UniqueFd socket_;
  std::array<std::uint8_t, kLinkHeaderSize> header_{};
  std::size_t header_size_ = 0;
  event_loop::Backlog backlog_{kMostWaiting};
  bool failed_ = false;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
