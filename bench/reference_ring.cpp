#include "bench/reference_ring.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "bench/cores.h"
#include "bench/samples.h"
#include "bench/shared.h"
#include "bench/waits.h"
#include "bench/worker.h"
#include "io/unique_fd.h"
#include "wire/packet.h"

namespace limb_ring::bench {
namespace {

using process::UniqueFd;

constexpr std::size_t kReadSize = 64 * 1024;

struct ReferenceOutcome {
  std::atomic<bool> done{false};
  Measurement measured;
};

struct Line {
  UniqueFd in, out;
};

std::vector<Line> make_lines(unsigned count) {
  std::vector<Line> lines(count);
  for (Line& line : lines) {
    std::array<int, 2> ends;
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      throw std::system_error(errno, std::generic_category(), "sockets of the reference ring");
    line.in.reset(ends[0]);
    line.out.reset(ends[1]);
  }
  return lines;
}

void write_all(int fd, const std::uint8_t* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t wrote = ::write(fd, bytes, size);
    if (wrote <= 0) ::_exit(0);  // the next one has ended, so it is over
    bytes += wrote;
    size -= static_cast<std::size_t>(wrote);
  }
}

/// Waits until all have started: otherwise the first lap would include the time that this takes.
void meet(std::atomic<unsigned>& started, unsigned all) {
  ++started;
  while (started < all) std::this_thread::yield();
}

/// One process of the ring.
class ReferenceNode {
 public:
  ReferenceNode(unsigned id, const Setup& setup, ReferenceOutcome& outcome)
      : id_(static_cast<std::uint8_t>(id)),
        packet_size_(setup.payload + wire::kOverhead),
        samples_(setup.round_seconds()),
        outcome_(outcome) {}

  void run(int in, int out, bool sends) {
    if (sends) send_first(out);
    for (;;) {
      const ssize_t got = ::read(in, buffer_.data(), buffer_.size());
      if (got <= 0) return;
      if (sends) look_for_own(static_cast<std::size_t>(got));
      write_all(out, buffer_.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  void send_first(int out) {
    const std::vector<std::uint8_t> packet(packet_size_, id_);
    samples_.begin(Samples::Clock::now());
    write_all(out, packet.data(), packet.size());
  }

  void look_for_own(std::size_t size) {
    std::size_t at = to_next_packet_;
    for (; at < size; at += packet_size_)
      if (buffer_[at] == id_ && !outcome_.done) lap();
    to_next_packet_ = at - size;
  }

  void lap() {
    if (samples_.lap(Samples::Clock::now())) return;
    outcome_.measured = samples_.measurement();
    outcome_.done = true;  // the packet goes on, so that the others measure a full ring
  }

  std::uint8_t id_;
  std::size_t packet_size_;
  std::size_t to_next_packet_ = 0;
  Samples samples_;
  ReferenceOutcome& outcome_;
  std::array<std::uint8_t, kReadSize> buffer_;
};

std::vector<Worker> start(const Setup& setup, Pinning pinning, unsigned senders, Shared<ReferenceOutcome>& outcomes,
                          std::atomic<unsigned>& started) {
  const auto cores = cores_for(pinning);
  const std::vector<Line> lines = make_lines(setup.nodes);
  std::vector<Worker> workers;
  for (unsigned id = 0; id < setup.nodes; ++id) {
    const int in = lines[(id + setup.nodes - 1) % setup.nodes].in.get();
    const int out = lines[id].out.get();
    workers.emplace_back([&setup, &cores, &outcomes, &started, id, senders, in, out] {
      stay_on(cores);
      meet(started, setup.nodes);
      ReferenceNode(id, setup, outcomes[id]).run(in, out, id < senders);
    });
  }
  return workers;
}

void wait_until_done(const Setup& setup, ReferenceOutcome& outcome, Samples::Clock::time_point deadline) {
  while (!outcome.done) {
    setup.poll();
    if (Samples::Clock::now() > deadline)
      throw std::runtime_error("the reference ring does not go round; is the machine overloaded?");
    std::this_thread::sleep_for(kTick);
  }
}

}  // namespace

Measurement measure_reference(const Setup& setup, Pinning pinning, Sending sending) {
  const unsigned senders = sending == Sending::one ? 1 : setup.nodes;
  Shared<ReferenceOutcome> outcomes(setup.nodes);
  Shared<std::atomic<unsigned>> started(1);
  const std::vector<Worker> workers = start(setup, pinning, senders, outcomes, started[0]);
  const auto deadline = Samples::Clock::now() + kPatience + setup.case_time();
  std::vector<Measurement> measured;
  for (unsigned id = 0; id < senders; ++id) {
    wait_until_done(setup, outcomes[id], deadline);
    measured.push_back(outcomes[id].measured);
  }
  return together(measured);
}

}  // namespace limb_ring::bench
