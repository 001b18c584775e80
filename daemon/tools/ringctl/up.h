#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "io/regular_file.h"
#include "ring/launched_ring.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// A virtual ring's.
struct VirtualClock {
  double pace = 1;       ///< its time per real time; infinite: as fast as can be
  double lasts_s = 0;    ///< the ring ends then; 0: it does not
  std::string capture;   ///< file for all packets on its lines; empty: none
  bool follows = false;  ///< it goes on as far as a client allows
};

/// What `ringctl up` was asked for.
struct UpRequest {
  std::string config;     ///< path of a YAML file, or a name for ring_file(); empty: a plain ring of `nodes`
  unsigned nodes = 0;     ///< with `config` 0, or the file's number
  std::string ring;       ///< name instead of the file's; a plain ring's default is "plain"
  std::string transport;  ///< unix, shm or udp instead of the file's; empty: as the file says
  std::string host;       ///< whose nodes, or kAllHosts; empty: see chosen_host()
  bool record = false;    ///< flight recorders are on, whatever the file says
  std::optional<VirtualClock> clock;  ///< none: the machine's
};

/// A ring, or one host's part of it, that is to be started. Its configuration has been checked. It has one daemon per
/// node, or on a virtual clock one for all.
struct RingPlan {
  std::string ring;
  std::vector<NodeName> nodes;          ///< those started here: none with a foreign controller
  std::size_t ring_size = 0;            ///< how many the whole ring has
  std::string host;                     ///< whose nodes these are; empty: all of the ring
  std::vector<std::string> arguments;   ///< of every ringd, without --node
  std::vector<config::ReadFile> files;  ///< that it was read from; the daemons read them from the ring's folder
  bool is_virtual = false;              ///< one daemon for all nodes
  std::string missing_program;          ///< of a CPU, in words: each start of it would fail; empty: all are there
  /// Arguments of the `ringctl` that saves recordings when something goes wrong; empty: none does.
  std::vector<std::string> keeper;
  std::string saves;  ///< the folder it saves them in

  bool is_part() const { return nodes.size() < ring_size; }
  /// Command line of the daemon of one node, without the program.
  std::vector<std::string> arguments_of(const NodeName& node) const;
};

/// One ringd for each node of the plan, or one for all. Those that are asked to end with this process write to its
/// output, others into log files.
live::LaunchRequest launch_request(const RingPlan& plan, process::Lifetime lifetime);

/// @throw config::ConfigError, UsageError
RingPlan plan_ring(const UpRequest& given);

/// Path of the lock in a ring's folder. @param host whose part is started; empty: all of the ring
std::string up_lock(const std::string& folder, const std::string& host = {});

/// Of two `ringctl up` of one ring, or of one host's part of it, one starts it: a lock in the ring's folder from before
/// it looks whether the ring runs until the ring is closed.
class UpLock {
 public:
  /// @param host whose part is started; empty: all of the ring
  /// If 'ringctl down' has just this lock, to tidy the folder, it comes after that. @throw NotDone with the pid of
  /// the other one
  UpLock(const std::string& ring, const std::string& host);
  /// If the ring has not come up, and its folder was made for it, that goes, too: a failed start leaves nothing. It
  /// stays if a daemon lives, or has recorded what may tell why.
  ~UpLock();
  UpLock(const UpLock&) = delete;
  UpLock& operator=(const UpLock&) = delete;

  /// The ring is closed, or was taken down. Leaves nothing of its own behind.
  void release();

 private:
  std::string ring_;
  bool folder_is_new_;
  std::string folder_;
  std::optional<process::LockFile> file_;
};

}  // namespace limb_ring::ringctl
