#include "tools/common/colour.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace limb_ring::app {

bool colour_wanted(int file) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool refused =
      (no_colour != nullptr && *no_colour != '\0') || (terminal != nullptr && std::strcmp(terminal, "dumb") == 0);
  return !refused && ::isatty(file) == 1;
}

}  // namespace limb_ring::app
