#include "io/standard_descriptors.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace limb_ring::process {

// open() gives the lowest free number, so each gets its own.
void open_standard_descriptors() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", O_RDWR);
}

void outlive_file_limit() { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace limb_ring::process
