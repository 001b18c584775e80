// Stands between two nodes of a keyed ring, as somebody with a hand on the cable would: passes on what they say,
// records it, and on request says what it likes to both. To its own machine only.
//
//   forge_line LISTEN_PORT TARGET_PORT SEED
//
// What it passes on is not held up by what it forges: two threads.
//
// On standard input: `keep` remembers what was recorded so far as yesterday's; `forge COUNT RATE` sends so many
// datagrams, so many a second. After each it prints a line of JSON; the end of the input ends it.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

using Datagram = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;
constexpr std::size_t kHeader = 26, kTypeAt = 3, kRecorded = 1024, kLargest = 2048;
constexpr std::uint8_t kConnectKeyed = 8;

int udp_socket() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) std::exit(1);
  return fd;
}

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

const sockaddr* any(const sockaddr_in& address) { return reinterpret_cast<const sockaddr*>(&address); }

/// What was said lately in one direction.
class Recording {
 public:
  void add(const Datagram& datagram) {
    if (all_.size() < kRecorded)
      all_.push_back(datagram);
    else
      all_[next_++ % kRecorded] = datagram;
  }
  bool empty() const { return all_.empty(); }
  const Datagram& at(std::size_t index) const { return all_[index % all_.size()]; }
  std::size_t size() const { return all_.size(); }

 private:
  std::vector<Datagram> all_;
  std::size_t next_ = 0;
};

class Line {
 public:
  Line(int listen, int target, unsigned seed) : random_(seed), target_(loopback(target)) {
    const sockaddr_in here = loopback(listen);
    if (::bind(up_, any(here), sizeof here) != 0 || ::connect(down_, any(target_), sizeof target_) != 0) std::exit(1);
  }

  /// For good.
  void pass_on_always() {
    for (;;) {
      pollfd both[]{{up_, POLLIN, 0}, {down_, POLLIN, 0}};
      ::poll(both, 2, -1);
      pass_on();
    }
  }

  void keep() {
    const std::lock_guard lock(mutex_);
    yesterday_ = said_;
  }

  void forge(std::size_t count, double rate) {
    std::map<std::string, std::size_t> kinds;
    const std::uint64_t before = passed_on_;
    const auto start = Clock::now();
    for (std::size_t done = 0; done < count;) {
      const double due = std::chrono::duration<double>(Clock::now() - start).count() * rate;
      for (; done < count && static_cast<double>(done) < due; ++done) ++kinds[one(done)];
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::printf("{\"passed_on\": %llu", static_cast<unsigned long long>(passed_on_ - before));
    for (const auto& [name, number] : kinds) std::printf(", \"%s\": %zu", name.c_str(), number);
    std::printf("}\n");
  }

 private:
  void pass_on() {
    socklen_t size = sizeof from_;
    Datagram bytes(kLargest);
    for (ssize_t got;
         (got = ::recvfrom(up_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from_), &size)) >= 0;) {
      const Datagram datagram(bytes.begin(), bytes.begin() + got);
      ++passed_on_;
      ::send(down_, datagram.data(), datagram.size(), 0);
      const bool asks = datagram.size() > kTypeAt && datagram[kTypeAt] == kConnectKeyed;
      const std::lock_guard lock(mutex_);
      (asks ? asked_ : said_).add(datagram);
    }
    for (ssize_t got; (got = ::recv(down_, bytes.data(), bytes.size(), 0)) >= 0;) {
      const Datagram datagram(bytes.begin(), bytes.begin() + got);
      ::sendto(up_, datagram.data(), datagram.size(), 0, any(from_), sizeof from_);
      const std::lock_guard lock(mutex_);
      answered_.add(datagram);
    }
  }

  std::size_t number(std::size_t below) { return random_() % below; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  Datagram recorded(const Recording& recording) { return recording.at(number(recording.size())); }
  void say(const Datagram& datagram) { ::send(down_, datagram.data(), datagram.size(), 0); }

  /// @return the kind that it was
  std::string one(std::size_t turn) {
    const std::lock_guard lock(mutex_);
    if (turn % 16 == 15 && !answered_.empty()) return to_the_other_end();
    switch (turn % 8) {
      case 0:
        return forged();
      case 1:
        say(recorded(said_));
        return "replayed";
      case 2:
        return truncated();
      case 3:
        return flipped();
      case 4:  // backwards through what was said
        say(said_.at(said_.size() - 1 - turn / 8 % said_.size()));
        return "reordered";
      case 5:
        if (yesterday_.empty()) return forged();
        say(recorded(yesterday_));
        return "yesterday";
      case 6:
        return asks();
      default:
        return garbage();
    }
  }
  std::string forged() {
    Datagram datagram = recorded(said_);
    datagram.resize(kHeader);
    for (std::size_t more = 24 + number(540); more > 0; --more) datagram.push_back(byte());
    say(datagram);
    return "forged";
  }
  std::string truncated() {
    Datagram datagram = recorded(said_);
    datagram.resize(number(datagram.size()));
    say(datagram);
    return "truncated";
  }
  std::string flipped() {
    Datagram datagram = recorded(said_);
    const std::size_t bit = number(8 * datagram.size());
    datagram[bit / 8] = static_cast<std::uint8_t>(datagram[bit / 8] ^ 1u << bit % 8);
    say(datagram);
    return "flipped";
  }
  std::string asks() {
    if (asked_.empty()) return garbage();
    Datagram datagram = recorded(asked_);
    const bool again = number(2) == 0;
    if (!again) datagram.back() = static_cast<std::uint8_t>(datagram.back() ^ 1u);
    say(datagram);
    return again ? "asked_again" : "asked_forged";
  }
  std::string garbage() {
    Datagram datagram(number(600));
    for (std::uint8_t& each : datagram) each = byte();
    say(datagram);
    return "garbage";
  }
  std::string to_the_other_end() {
    Datagram datagram = recorded(answered_);
    if (number(2) == 0) datagram.back() = static_cast<std::uint8_t>(datagram.back() ^ 1u);
    ::sendto(up_, datagram.data(), datagram.size(), 0, any(from_), sizeof from_);
    return "to_sender";
  }

  std::mt19937 random_;
  sockaddr_in target_, from_{};
  int up_ = udp_socket(), down_ = udp_socket();
  Recording said_, asked_, answered_, yesterday_;
  std::atomic<std::uint64_t> passed_on_{0};
  std::mutex mutex_;
};

/// @return false: the input has ended
bool take_command(Line& line) {
  char text[128];
  if (std::fgets(text, sizeof text, stdin) == nullptr) return false;
  std::size_t count = 0;
  double rate = 0;
  if (std::sscanf(text, "forge %zu %lf", &count, &rate) == 2) {
    line.forge(count, rate);
  } else {
    line.keep();
    std::printf("{}\n");
  }
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  Line line(std::atoi(argv[1]), std::atoi(argv[2]), static_cast<unsigned>(std::atoi(argv[3])));
  std::thread([&line] { line.pass_on_always(); }).detach();
  while (take_command(line)) {
  }
  std::_Exit(0);  // the other thread is still at it
}
