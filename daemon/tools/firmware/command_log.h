#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

#include "limb_ring/host_port.h"
#include "tools/firmware/command_for.h"
#include "tools/firmware/timestamps.h"

namespace limb_ring::firmware {

/// For measurements: a line for each joint command that was obeyed, "CAME STAMP", both in ns of the clock of stamps.
class CommandLog {
 public:
  /// Appends, so that a process that takes over after a reset goes on with it.
  /// @throw std::runtime_error where the file cannot be written
  explicit CommandLog(const std::string& path) : file_(path, std::ios::app) {
    if (!file_) throw std::runtime_error("--command-log: " + path + " cannot be written");
  }

  /// @param node that the packet has come to
  void note(std::uint8_t node, const Packet& packet, const Timestamps& now) {
    const auto command = command_for(node, packet.data);
    if (command && *command)
      file_ << now.wall_ns << ' ' << (*command)->stamp_ns << std::endl;  // at once: a reset kills
  }

 private:
  std::ofstream file_;
};

}  // namespace limb_ring::firmware
