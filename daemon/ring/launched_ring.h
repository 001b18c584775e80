#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/program.h"
#include "io/regular_file.h"
#include "wire/packet.h"

namespace limb_ring::live {

/// The daemons of a ring that is to be started.
struct LaunchRequest {
  struct Node {
    wire::NodeId id{0};
    std::string name;
    std::vector<std::string> arguments;  ///< of its ringd, without the program
    bool all = false;                    ///< it holds all nodes, on a virtual clock; `id` is the first one's
  };
  std::string ring;
  std::vector<Node> nodes;
  process::Lifetime lifetime = process::Lifetime::asked_to_end;
  bool logged = true;              ///< each has a log file in the ring's folder; false: they write to our output
  std::optional<cpu_set_t> cores;  ///< they may use; empty: as this process
};

/// A ringd that this process has started.
struct LaunchedDaemon {
  wire::NodeId id{0};
  std::string name;  ///< of its node
  process::Program program;
  bool all = false;  ///< it holds all nodes

  const std::optional<process::ExitStatus>& ended() const { return program.ended(); }
  /// "node 3 (left_knee) ended: exit 2", or "the virtual ring ended: ...", with the last lines of its log
  std::string exit_reason() const;
  std::string last_lines() const { return program.last_lines(); }
};

/// The daemons of a ring that this process has started: for ringctl up, scenarios on live daemons, and benchmarks.
/// They go on when this object is gone.
class LaunchedRing {
 public:
  /// Waits for up to the given time. @return true: kill what still runs, without further grace
  using Wait = std::function<bool(std::chrono::milliseconds)>;

  /// Starts one ringd per node. @throw std::runtime_error if one cannot be started, or its log not be written; those
  /// that were have ended then
  explicit LaunchedRing(LaunchRequest request);

  /// Notes which have ended. @return the ones that have since the last call
  std::vector<const LaunchedDaemon*> reap();
  /// Starts the daemon again that has ended, as it was started before. @pre all()[index].ended()
  void start_again(std::size_t index);
  bool any_running() const;
  const std::string& ring() const { return request_.ring; }
  const std::vector<LaunchedDaemon>& all() const { return daemons_; }
  const LaunchedDaemon* first_ended() const;
  void signal(int number) const;
  /// Ends all: SIGTERM, after `grace`, or if `wait` says so, SIGKILL.
  void end(const Wait& wait, std::chrono::milliseconds grace);

 private:
  LaunchedDaemon started(const LaunchRequest::Node& node) const;

  LaunchRequest request_;
  std::string folder_;
  std::vector<LaunchedDaemon> daemons_;
};

/// A fresh XDG_RUNTIME_DIR of this process and those it starts, so that nothing of the user's is
/// touched. Removed with everything in it; the environment is then as before.
class PrivateFolder {
 public:
  /// @throw std::system_error if none can be made
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::string& path() const { return folder_.path(); }

 private:
  void replace(const std::string& name, const char* value);

  process::TemporaryFolder folder_{"private"};
  std::map<std::string, std::optional<std::string>> before_;
};

/// What a virtual ring says of its clock (docs/reference/requests.md), with "now_s" for "now_ns". Null if the ring
/// goes by the machine's clock, or its process does not answer.
nlohmann::json ring_clock(const std::string& ring);

/// Why nothing goes on if the virtual clock of the ring stands, and what lets it go on; empty if it goes.
std::string standing_clock(const std::string& ring);
/// `problem`, of something that has not happened in time, and standing_clock() if it stands.
std::string with_standing_clock(const std::string& problem, const std::string& ring);

}  // namespace limb_ring::live
