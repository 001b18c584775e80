#include "io/memory_stream.h"

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <string>

namespace limb_ring::link {
namespace {

/// Reads in a row, before the host port and the timers get their turn.
constexpr int kMostReads = 8;

}  // namespace

process::UniqueFd open_wake(const process::UniqueFd& given) {
  struct stat found {};
  if (::fstat(given.get(), &found) != 0 || !S_ISFIFO(found.st_mode)) return {};
  const std::string path = "/proc/self/fd/" + std::to_string(given.get());
  return process::UniqueFd(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
}

MemoryStream::MemoryStream(boost::asio::io_context& io, process::UniqueFd socket, QueueMemory memory,
                           process::UniqueFd wake, const LinkHeader& alive, Owner& owner, InputHandler& handler,
                           InputCounters& counters)
    : UnixStream(io, std::move(socket), alive, owner, handler, counters),
      memory_(std::move(memory)),
      queue_(memory_),
      wake_(std::move(wake)),
      woken_(io, wake_.get(), EPOLLIN, [this](std::uint32_t events) { on_woken(events); }) {
  woken_.call_again();
}

// The pipe is emptied, since a full one wakes nobody.
void MemoryStream::on_woken(std::uint32_t events) {
  std::array<char, 4096> bytes;
  if (events != 0) (void)!::read(wake_.get(), bytes.data(), bytes.size());
  read();
}

void MemoryStream::read() {
  const auto self = shared_from_this();  // the handler may close the input
  if (ended_if_given_up()) return;
  int reads = 0;
  do {
    while (read_once())
      if (++reads == kMostReads) return woken_.call_again();
    if (!open()) return;
  } while (!queue_.sleep());
  if (ending()) owner().on_ended("its end was closed");
}

bool MemoryStream::read_once() {
  const auto got = queue_.take(feed().space(), feed().space_size());
  if (got < 0) {
    ++counters().queue_invalid;
    owner().on_ended(kInvalidQueue);
    return false;
  }
  if (got == 0) return false;
  woken_.found_packets();
  if (queue_.must_tell_of_room()) say_alive();
  take(static_cast<std::size_t>(got));
  return open();
}

void MemoryStream::tick() {
  queue_.beat();
  if (!queue_.heard_beat()) return;
  ++counters().beats;
  owner().on_heard();
}

void MemoryStream::close() {
  woken_.stop();
  UnixStream::close();
}

}  // namespace limb_ring::link
