#include "io/udp_input.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <utility>

namespace limb_ring::link {
namespace {

constexpr std::size_t kReadSize = 64 * 1024;
/// Reads in a row at most, so that the timers get their turn under any load.
constexpr int kReadsPerTurn = 64;
/// Runs of datagrams that can have waited in the socket (kSocketBuffer).
constexpr std::size_t kMostWaiting = 4096;

struct Run {
  std::vector<std::uint8_t> bytes;
  std::size_t segment;
  UdpAddress sender;
};

template <class Visit>
void each_datagram(wire::ByteView run, std::size_t segment, Visit visit) {
  do {
    const std::size_t one = std::min(segment, run.size);
    visit(run.first(one));
    run = run.from(one);
  } while (!run.empty());
}

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
  if (datagrams_.stood_still(now)) return read_after_standstill(now);
  bool found = read_run(now);
  for (int reads = 1; found && reads < kReadsPerTurn && read_again_.wanted(); ++reads) {
    found = read_run(now);
    read_again_.found(found);
  }
  datagrams_.end_batch();
}

// The neighbour may have given this end up meanwhile. Its bye is behind all that waits, or found no room there. What
// waits is old then: packets have taken the way past this node since, and their copies would come behind them.
void UdpInput::read_after_standstill(Time now) {
  bool given_up = dropped_datagrams(socket_.native_handle()) != dropped_;
  std::vector<Run> waiting;
  while (waiting.size() < kMostWaiting) {
    UdpAddress sender;
    const UdpRead read = receive_run(socket_.native_handle(), buffer_.data(), buffer_.size(), sender);
    if (read.size < 0) break;
    const wire::ByteView run{buffer_.data(), static_cast<std::size_t>(read.size)};
    waiting.push_back({{run.begin(), run.end()}, read.segment, sender});
    each_datagram(run, read.segment, [&](wire::ByteView one) { given_up = given_up || datagrams_.is_bye(one); });
  }
  if (given_up || waiting.size() == kMostWaiting) datagrams_.given_up();
  for (const Run& run : waiting) take_run({run.bytes.data(), run.bytes.size()}, run.segment, run.sender, now);
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
  watch_.found_packets();
  take_run({buffer_.data(), static_cast<std::size_t>(read.size)}, read.segment, sender, now);
  return true;
}

void UdpInput::take_run(wire::ByteView run, std::size_t segment, const UdpAddress& sender, Time now) {
  ++report_.counters.reads;
  report_.counters.bytes += run.size;
  each_datagram(run, segment, [&](wire::ByteView one) { datagrams_.take(one, sender, now); });
}

void UdpInput::tick(Time now) {
  if (datagrams_.stood_still(now)) read_after_standstill(now);
  dropped_ = dropped_datagrams(socket_.native_handle());
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
