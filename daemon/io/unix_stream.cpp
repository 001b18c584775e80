#include "io/unix_stream.h"

#include <sys/epoll.h>

#include <cerrno>
#include <system_error>

#include "io/unix_line_socket.h"

namespace limb_ring::link {

UnixStream::UnixStream(boost::asio::io_context& io, process::UniqueFd socket, const LinkHeader& alive, Owner& owner,
                       InputHandler& handler, InputCounters& counters)
    : socket_(std::move(socket)),
      alive_(alive),
      owner_(&owner),
      handler_(handler),
      counters_(counters),
      watch_(io, socket_.get(), EPOLLIN | EPOLLRDHUP, [this](std::uint32_t events) {
        if ((events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0) ending_ = true;
        read();
      }) {}

// epoll tells of the end only once, but what came before it may take more than one read.
void UnixStream::read() {
  const auto self = shared_from_this();  // the handler may close the input
  if (ended_if_given_up()) return;
  const std::size_t space = feed_.space_size();
  const auto got = receive_now(socket_.get(), feed_.space(), space);
  if (got > 0) {
    watch_.found_packets();
    take(static_cast<std::size_t>(got));
    if (open() && (ending_ || static_cast<std::size_t>(got) == space)) watch_.call_again();
    return;
  }
  if (got == 0 || (got < 0 && errno == ECONNRESET)) return owner_->on_ended("its end was closed");
  if (would_block(errno)) return;
  owner_->on_ended("reading failed: " + std::generic_category().message(errno));
}

// What waits is old then: packets have taken the way past this node since, and their copies would come behind them.
bool UnixStream::ended_if_given_up() {
  if (!owner_->stood_still() || !has_hung_up(socket_.get())) return false;
  ++counters_.given_up;
  owner_->on_ended(kGivenUp);
  return true;
}

void UnixStream::take(std::size_t size) {
  ++counters_.reads;
  counters_.bytes += size;
  owner_->on_heard();
  if (feed_.commit(size, handler_, counters_)) return;
  ++counters_.malformed;
  if (owner_ != nullptr) owner_->on_ended("what it sent is no slice");
}

void UnixStream::tell(const LinkHeader& header) {
  const auto bytes = encode(header);
  send_now(socket_.get(), {bytes.data(), bytes.size()});
}

void UnixStream::close() {
  owner_ = nullptr;
  feed_.stop();
  watch_.stop();
  socket_.reset();
}

}  // namespace limb_ring::link
