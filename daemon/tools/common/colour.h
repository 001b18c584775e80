#pragma once

namespace limb_ring::app {

/// Whether output there is to be coloured: on a terminal that can, unless NO_COLOR is set
/// (https://no-color.org).
bool colour_wanted(int file);

// Plain ANSI.
constexpr const char* kRed = "\033[31m";
constexpr const char* kYellow = "\033[33m";
constexpr const char* kMagenta = "\033[35m";
constexpr const char* kDim = "\033[2m";
constexpr const char* kChanged = "\033[7m";  ///< light and dark exchanged
constexpr const char* kPlain = "\033[0m";

}  // namespace limb_ring::app
