#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "config/ring_config.h"

namespace limb_ring::ringd {

/// What one ringd is to be, from its command line.
struct Options {
  std::string config;             ///< YAML file; empty: a plain ring of `nodes`
  std::string as_read;            ///< folder with the configuration as `ringctl up` has read it; empty: as it is now
  std::string node;               ///< id or name
  std::optional<unsigned> index;  ///< or its place in ring order, from 0
  std::optional<unsigned> nodes;  ///< must be the configuration's number
  std::string ring;               ///< another name for the ring
  bool record = false;
  std::string transport;          ///< unix, shm or udp for every link
  bool one_host = false;          ///< all nodes are on this machine, whatever hosts the file gives
  std::string clock = "machine";  ///< or virtual: the whole ring is in this process
  std::optional<double> pace;     ///< of the virtual clock: its time per real time; infinite: as fast as the machine is
  double lasts_s = 0;             ///< of the virtual clock: the ring ends by itself then; 0: it does not
  std::string capture;            ///< of the virtual clock: file for all packets on the lines; empty: none
  bool list_options = false;      ///< print config/OPTIONS.md and end
};

/// The command line is wrong; what() says what would be right.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads the command line.
/// @return nothing where help or version was asked for, and printed
/// @throw UsageError
std::optional<Options> parse_options(int argc, const char* const* argv);

/// The ring these options mean. @throw UsageError, config::ConfigError
config::RingConfig ring_of(const Options& options);

/// Checks that no option is given that cannot be used with a virtual clock. @throw UsageError
void check_virtual(const Options& options);

/// Checks that no option is given that goes with a virtual clock alone. @throw UsageError
void check_machine(const Options& options);

/// This daemon's node in it. @throw UsageError
const config::NodeConfig& node_of(const Options& options, const config::RingConfig& ring);

}  // namespace limb_ring::ringd
