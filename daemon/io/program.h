#pragma once

#include <sched.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/child.h"

namespace limb_ring::process {

/// What happens to a program when this process ends, however it ends.
enum class Lifetime {
  asked_to_end,  ///< it gets SIGTERM
  killed,        ///< it gets SIGKILL, which ends also one that is stopped
  its_own        ///< nothing: it has a session of its own
};

struct ProgramRequest {
  std::string name;                                              ///< as find_program() wants it
  std::vector<std::string> arguments;                            ///< without the program's name
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to, or replacing, ours
  std::string log;  ///< file of its output and errors; empty: it writes to ours
  Lifetime lifetime = Lifetime::asked_to_end;
  std::optional<cpu_set_t> cores;  ///< it may use; empty: as this process
};

/// The last five lines of a log, each behind a line break and two blanks, or that the log is empty.
std::string last_lines_of(const std::string& log);

/// A program that this process has started and waits for. It goes on when this object is gone.
class Program : public Child {
 public:
  /// @throw std::runtime_error if there is no such program, or its log cannot be written (disk full)
  explicit Program(const ProgramRequest& request);

  /// All that it has written into its log.
  std::string output() const;
  /// last_lines_of() its log; nothing if it has none.
  std::string last_lines() const;

 private:
  std::string log_;
};

/// Turns this process into the program at `path`, with the same environment, pid and descriptors.
/// @param arguments including the program's name as the first
/// @return errno: it comes back only if the program cannot be executed
int execute(const std::string& path, std::vector<std::string> arguments);

/// Folder of the running executable; empty if it cannot be known.
std::string own_folder();

/// Path of a program: `name` itself if it holds a '/', else `folder`/name, else the first on
/// PATH that can be executed. So the programs of one build find each other first.
/// @return empty if there is none.
std::string find_program(const std::string& name, const std::string& folder = own_folder());

/// What is to be said where find_program() finds none: the name, and where it was looked for.
std::string no_program(const std::string& name, const std::string& folder = own_folder());

}  // namespace limb_ring::process
