#pragma once

#include <termios.h>

#include <string>

namespace limb_ring::ringctl {

/// The terminal while something is redrawn in place: another page of it, keys as they are pressed, no
/// cursor. As it was once this ends, however it ends. Plain ANSI.
class Screen {
 public:
  /// @throw UsageError where standard input or output is no terminal
  Screen();
  ~Screen() { close(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  struct Size {
    unsigned lines, columns;
  };
  static Size size();  ///< 24 x 80 where the terminal does not say
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

}  // namespace limb_ring::ringctl
