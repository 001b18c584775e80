#pragma once

#include <sched.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "process/spawn.h"

namespace limb_ring::bench {

struct ProgramRequest {
  std::string name;                    ///< as process::find_program wants it
  std::vector<std::string> arguments;  ///< without the program's name
  std::vector<std::pair<std::string, std::string>> environment;
  std::string log;                     ///< file of its output and errors
  std::optional<cpu_set_t> cores;
};

/// Another program, running. Ends with this object: SIGTERM, and after two seconds SIGKILL.
class ChildProgram {
 public:
  /// @throw std::runtime_error where it cannot be found or started
  explicit ChildProgram(const ProgramRequest& request);
  ~ChildProgram() { end(); }
  ChildProgram(ChildProgram&& other) noexcept;
  ChildProgram& operator=(ChildProgram&&) = delete;

  pid_t pid() const { return process_.pid; }
  bool running();
  /// SIGTERM, without waiting: for many at once.
  void ask_to_end();
  void end();
  /// The last lines of what it said.
  std::string last_words() const;
  std::string output() const;  ///< all of it

 private:
  std::string name_, log_;
  process::Spawned process_;
};

}  // namespace limb_ring::bench
