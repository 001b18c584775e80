#include "link/udp_input.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>

namespace limb_ring::link {
namespace {

constexpr std::size_t kReadSize = 64 * 1024;
/// Reads in a row at most, so that the timers get their turn under any load.
constexpr int kReadsPerTurn = 64;

}  // namespace

UdpInput::UdpInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                   InputReport& report, Upstream& upstream)
    : io_(io),
      report_(report),
      socket_(listen_udp(io, settings.endpoint)),
      datagrams_(settings, *this, handler, report, upstream,
                 [this](wire::ByteView datagram, const UdpAddress& to) { send(datagram, to); }),
      buffer_(kReadSize),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {}

void UdpInput::close() {
  if (datagrams_.closed()) return;
  datagrams_.close();
  ticker_.stop();
  watch_.stop();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

void UdpInput::start() {
  const auto on_ready = [this](std::uint32_t) {
    const auto self = shared_from_this();  // the handler may close the input
    read();
  };
  watch_ = event_loop::Watch(io_, socket_.native_handle(), EPOLLIN, on_ready, event_loop::Watch::Trigger::level);
}

void UdpInput::read() {
  const Time now = Clock::now();
  bool found = read_run(now);
  for (int reads = 1; found && reads < kReadsPerTurn && read_again_.wanted(); ++reads) {
    found = read_run(now);
    read_again_.found(found);
  }
  datagrams_.end_batch();
}

void UdpInput::drain() {
  const Time now = Clock::now();
  int reads = 0;
  while (reads < kReadsPerTurn && read_run(now)) ++reads;
  datagrams_.end_batch();
}

bool UdpInput::read_run(Time now) {
  if (datagrams_.closed()) return false;
  UdpAddress sender;
  const UdpRead read = receive_run(socket_.native_handle(), buffer_.data(), buffer_.size(), sender);
  if (read.size < 0) return false;
  take_run(static_cast<std::size_t>(read.size), read.segment, sender, now);
  return true;
}

void UdpInput::take_run(std::size_t size, std::size_t segment, const UdpAddress& sender, Time now) {
  ++report_.counters.reads;
  report_.counters.bytes += size;
  wire::ByteView rest{buffer_.data(), size};
  do {
    const std::size_t one = std::min(segment, rest.size);
    datagrams_.take(rest.first(one), sender, now);
    rest = rest.from(one);
  } while (!rest.empty() && !datagrams_.closed());
}

void UdpInput::tick(Time now) {
  if (!datagrams_.tick(now)) return;
  drain();  // this end may not have been scheduled: see what has come
  datagrams_.lose_if_silent();
}

void UdpInput::send(wire::ByteView datagram, const UdpAddress& to) {
  // What the kernel does not take is lost, as on the wire: everything told is told again.
  ::sendto(socket_.native_handle(), datagram.data, datagram.size, MSG_DONTWAIT | MSG_NOSIGNAL, to.data(),
           static_cast<socklen_t>(to.size()));
}

}  // namespace limb_ring::link
