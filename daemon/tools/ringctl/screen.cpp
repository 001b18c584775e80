#include "tools/ringctl/screen.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <iostream>
#include <sstream>
#include <utility>

#include "limb_ring/host_port.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {
namespace {

constexpr const char* kOpen = "\033[?1049h\033[?25l\033[?7l";  // another page, no cursor, what is too wide is cut
constexpr const char* kClose = "\033[?7h\033[?25h\033[?1049l";
constexpr const char* kHome = "\033[H";
constexpr const char* kRestOfLine = "\033[K";
constexpr const char* kRestOfPage = "\033[J";

}  // namespace

Screen::Screen() {
  if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1)
    throw UsageError("standard input or output is not a terminal; --once prints once");
  open();
}

void Screen::open() {
  ::tcgetattr(STDIN_FILENO, &before_);
  termios keys = before_;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  keys.c_cc[VSUSP] = _POSIX_VDISABLE;  // it is a key here: the shell is not to have this page, without a cursor
  ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  std::cout << kOpen << std::flush;
}

void Screen::stop_and_go_on() {
  close();
  ::raise(SIGTSTP);
  open();
}

void Screen::close() const {
  std::cout << kClose << std::flush;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

Screen::Size Screen::size() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 || size.ws_col == 0) return {24, 80};
  return {size.ws_row, size.ws_col};
}

void Screen::draw(const std::string& text) const {
  const Size fits = size();
  std::istringstream lines(text);
  std::string page = kHome, line;
  for (unsigned i = 0; i < fits.lines && std::getline(lines, line); ++i)
    page += (i == 0 ? "" : "\r\n") + line + kRestOfLine;
  std::cout << page << kRestOfPage << std::flush;
}

char Screen::key() const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (::poll(&input, 1, 0) <= 0 || ::read(STDIN_FILENO, &key, 1) != 1) return 0;
  return key;
}

namespace {
constexpr std::chrono::seconds kEvery{2};
constexpr std::chrono::milliseconds kWorkTick{200};
}  // namespace

Progress::Progress(std::string ring) : ring_(std::move(ring)), next_(std::chrono::steady_clock::now() + kEvery) {}

void Progress::tell(const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kEvery;
  const std::string standing = ring_.empty() ? "" : standing_clock(ring_);
  if (!standing.empty())
    tell_user("waiting: " + standing);
  else if (!what.empty())
    tell_user(what + " ...");
}

void while_telling(const std::string& ring, const std::function<void()>& work, const std::string& what) {
  Progress progress(ring);
  std::future<void> done = std::async(std::launch::async, work);
  while (done.wait_for(kWorkTick) != std::future_status::ready) progress.tell(what);
  try {
    done.get();
  } catch (const HostPortTimeout&) {
    require_clock_goes(ring);
    throw;
  }
}

void tell_user(const std::string& what) { std::cerr << "ringctl: " << what << std::endl; }

void tell_standstill(std::chrono::nanoseconds time) {
  if (time.count() == 0) return;
  const auto seconds = std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count());
  tell_user("stood still for " + seconds + " s; goes on that much later");
}

}  // namespace limb_ring::ringctl
