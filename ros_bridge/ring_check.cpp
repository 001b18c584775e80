// ring_check: refuses a launch whose arguments do not fit the ring's file.
//
// Every other process of a launch is started again when it ends, so a wrong number of nodes
// would be said for ever. This one is `required`: when it ends, so does the launch. Where all is
// well it sleeps.
#include <unistd.h>

#include <cstring>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>

#include "config/load_ring.h"
#include "config/plain_ring.h"

namespace {

using Options = std::map<std::string, std::string>;

// roslaunch adds __name:= and __log:=, which are not for this program.
Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    if (std::strstr(argv[i], ":=")) continue;
    if (std::strncmp(argv[i], "--", 2) != 0 || i + 1 == argc)
      throw std::invalid_argument(std::string("'") + argv[i] +
                                  "'; usage: ring_check --nodes N [--config FILE] [--ring NAME] "
                                  "[--transport unix|udp]");
    const std::string name = argv[i] + 2;
    options[name] = argv[++i];
  }
  return options;
}

unsigned node_count(const std::string& text) {
  std::size_t used = 0;
  unsigned long count = 0;
  try {
    count = std::stoul(text, &used);
  } catch (const std::logic_error&) {
  }
  if (used == 0 || used != text.size() || count > 255)
    throw std::invalid_argument("nodes:=" + text + "; it must be a number, 2 to 255");
  return static_cast<unsigned>(count);
}

void check(Options options) {
  const unsigned nodes = node_count(options["nodes"]);
  auto ring = options["config"].empty()
                  ? limb_ring::config::plain_ring(options["ring"], nodes)
                  : limb_ring::config::load_ring(options["config"]);
  if (!options["transport"].empty())
    limb_ring::config::apply_transport(ring, options["transport"]);
  if (ring.nodes.size() != nodes)
    throw std::invalid_argument("nodes:=" + std::to_string(nodes) + ", but " + ring.path + " has " +
                                std::to_string(ring.nodes.size()) + " nodes; give nodes:=" +
                                std::to_string(ring.nodes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    check(read_options(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "ring_check: " << error.what() << std::endl;
    return 2;
  }
  for (;;) pause();
}
