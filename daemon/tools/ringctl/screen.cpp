#include "tools/ringctl/screen.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <sstream>

#include "tools/ringctl/problems.h"

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

}  // namespace limb_ring::ringctl
