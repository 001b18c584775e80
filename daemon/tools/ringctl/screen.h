#pragma once

#include <termios.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>

#include "limb_ring/host_port.h"
#include "ring/observed_daemon.h"
#include "ring/ring_client.h"

namespace limb_ring::ringctl {

/// The terminal while something is redrawn in place: another page of it, keys as they are pressed, no
/// cursor. As it was once this ends, however it ends. Plain ANSI.
class Screen {
 public:
  /// @throw UsageError if standard input or output is not a terminal
  Screen();
  ~Screen() { close(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  struct Size {
    unsigned lines, columns;
  };
  static Size size();  ///< 24 x 80 if the terminal does not say
  /// Shows `text` from the top left corner, as much of it as fits.
  void draw(const std::string& text) const;
  /// A key that was pressed; 0: none.
  char key() const;
  static constexpr char kCtrlZ = 0x1A;
  /// What Ctrl-Z asks for: the terminal as it was, until the shell lets us go on.
  void stop_and_go_on();

 private:
  void open();
  void close() const;

  termios before_{};
};

/// Says on standard error what is being waited for, once it takes longer than two seconds, and
/// then every two seconds.
class Progress {
 public:
  /// @param ring if its virtual clock stands, that is said instead: nothing else comes. Empty: no such ring
  explicit Progress(std::string ring = {});
  /// @param what empty: nothing but that the clock stands
  void tell(const std::string& what = {});

 private:
  std::string ring_;
  std::chrono::steady_clock::time_point next_;
};

/// Does `work`, which tells nothing, and tells meanwhile `what` it is, or where the ring's virtual clock stands.
/// @param ring, what as in Progress
/// @throw what `work` throws; NotKnown instead of HostPortTimeout if the clock stands
void while_telling(const std::string& ring, const std::function<void()>& work, const std::string& what = {});

/// A line on standard error, for who has called ringctl: "ringctl: WHAT".
void tell_user(const std::string& what);
/// The same of a process::Standstill; nothing if it is 0.
void tell_standstill(std::chrono::nanoseconds time);

/// What ringctl ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  kNotDone = 1,  ///< the thing asked for did not happen
  kUsage = 2,    ///< wrong arguments, or a configuration that is refused
  kNoRing = 3,   ///< no such ring, or a daemon that does not answer
  kUnknown = 4   ///< sent, but nobody knows whether it has happened
};

/// Of the help of a subcommand.
constexpr const char* kExitCodesInShort =
    "Exit code: 0 done, 1 not done, 2 wrong arguments, 3 no ring, 4 nobody knows.";

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done\n"
    "  1 it did not happen: not delivered, ring not closed in time ...\n"
    "  2 wrong arguments or configuration\n"
    "  3 no such ring, or its daemon does not answer\n"
    "  4 sent, and nobody knows if it happened: open ring, or lost on the way home";

/// Ends ringctl with kNotDone.
using live::NotDone;

/// The user wants no more of it: ends ringctl with kNotDone.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// It was asked for, and may still happen: ends ringctl with kUnknown.
struct NotKnown : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends ringctl with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends ringctl with kNoRing, as limb_ring::HostPortError does.
struct NoRing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Only daemons of another host can do it: ends ringctl with kNoRing, or it is done there (--ssh).
struct Elsewhere : NoRing {
  Elsewhere(const std::string& what, std::string ssh_destination, std::string of_ring = {})
      : NoRing(what), destination(std::move(ssh_destination)), ring(std::move(of_ring)) {}
  std::string destination;  ///< as ssh takes it
  std::string ring;         ///< empty if no ring runs yet
};

}  // namespace limb_ring::ringctl
