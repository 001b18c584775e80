#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wire/packet.h"

/// What lies in a ring's folder. A daemon that ends removes what others could take for its presence, and no more; of
/// one that was killed all stays, until the node's next daemon replaces it. What is left when the ring has ended, by
/// whomever it was made, remove_leftovers() removes: for `ringctl down`, and for an `up` that ends. (ours)
///
/// | file | made by | removed when its maker ends |
/// |---|---|---|
/// | ID.host, NAME.host | host/listener | yes |
/// | ID.link, ID.link2 | link/unix_input | yes |
/// | ID.watch | promises/observation_file | yes, or when nobody observes |
/// | ID.lock | host/node_lock | no: it tells who held the node last |
/// | up.lock, up-HOST.lock | `ringctl up`, `down` | yes |
/// | ID.boot | node/boot_record | no: the next daemon goes on from it |
/// | ID.record, .record.former, .record.new | recorder/recorder_file | no: it tells why a daemon died |
/// | ID.log, ring.log, keep.log | who starts daemons, `ringctl up --detach` | no |
/// | ID.fault, ID.killed, each also with .PID while it is written | live/node_notes | no |
/// | ID.taken | scenario_cpu | no: it outlives the CPU |

namespace limb_ring::live {

/// Paths of all files in a folder; none if that is not this user's alone: what others could have put there is
/// nothing to go by. It would choose which processes we signal, which files we remove, and which programs we start.
/// @throw std::system_error if this process or the system has no descriptors left
std::vector<std::string> files_in(const std::string& folder);

/// The id of the node whose file this is: of "12.lock", with any folder before it, 12 as its kind is ".lock". Nothing
/// for a file of another kind, or by another name, such as a node's.
std::optional<std::uint8_t> node_of(const std::string& file, const std::string& kind);

/// Removes what is listed above from a ring's folder, and the folder if nothing else is in it.
/// @pre no node of it is held, and nobody is starting it
void remove_leftovers(const std::string& folder);

/// Where remove_leftovers() keeps the log files of a ring's folder, which say why it ended: `.logs/RING` beside it,
/// until forget_logs(), when the ring is started again.
std::string kept_logs(const std::string& folder);
/// The log of a virtual ring, whose nodes are one process; each node of a live one has ID.log.
constexpr const char* kRingLog = "ring.log";
/// The one that a node of a running ring writes: ID.log or kRingLog; empty if it prints elsewhere.
std::string log_of(const std::string& folder, std::uint8_t node);
void forget_logs(const std::string& folder);

}  // namespace limb_ring::live

/// Files of a folder that is not this user's alone are taken for not there (limb_ring/ring_directory.h,
/// why_not_private).

namespace limb_ring::live {

/// What the lock file of a node says of the daemon that holds it, or held it last (node/host_server.h).
struct Holder {
  pid_t pid = -1;                      ///< -1 if the file does not tell
  std::string program;                 ///< path
  std::string folder;                  ///< it works in
  std::vector<std::string> arguments;  ///< without the program's name
  bool held = false;                   ///< it lives, perhaps stopped; on a virtual ring: and the node is not killed
  bool frozen = false;                 ///< held, and stopped: answers nobody
  std::string problem;                 ///< why nothing is known of it; empty if its lock file tells, or is not there
  bool on_virtual_ring = false;        ///< one process lives that has all nodes of the ring, this one perhaps killed
};

/// Reads the lock file of one node in a ring's folder, and on a virtual ring its note (node_notes.h). If the file
/// was removed, whoever listens at the node's host port is its daemon, which makes the file again within a second. All
/// fields are empty if there never was a daemon.
Holder holder_of(const std::string& folder, std::uint8_t node);
/// Writes that file if it was removed, so that the daemon can be started again when it is dead.
void keep_holder(const std::string& folder, std::uint8_t node, const Holder& holder);
/// Its daemon is stopped: who asks it something waits.
inline bool is_frozen(const std::string& folder, std::uint8_t node) { return holder_of(folder, node).frozen; }

/// Boot number of the node's last daemon (protocol.md section 4.8), which lives or is dead; nothing if none is kept.
std::optional<std::uint64_t> last_boot(const std::string& folder, std::uint8_t node);

/// A node held by a daemon that lives, as its lock file says.
struct HeldNode {
  std::uint8_t node = 0;
  std::string lock;  ///< path of the lock file
  pid_t pid = -1;    ///< of the daemon; -1 if the file does not tell
};

/// Nodes of a ring's folder that are held right now. No daemon: an empty list.
/// @throw std::system_error if that cannot be known, such as if this process has no descriptors left
std::vector<HeldNode> held_nodes(const std::string& folder);

/// Rings of this user of which a node is held right now, by name, sorted; also if no daemon answers.
std::vector<std::string> held_rings();

/// Whether the last daemon of a node was killed on purpose, and none has begun since. If so, only `fault start` may
/// start it again.
bool is_killed(const std::string& folder, wire::NodeId node);

/// Rings of this user that are dead because daemons were killed on purpose, by name, sorted.
std::vector<std::string> killed_rings();

/// Rings of this user that are dead although nobody has ended them or killed their daemons on purpose, by name, sorted:
/// their folders are there, and no daemon.
std::vector<std::string> left_rings();

/// A node as the files of its ring's folder know it.
struct KnownNode {
  wire::NodeId id;
  std::string name;  ///< as a fault's note calls it, or a daemon that has not ended by itself (NAME.host); else its id
};

/// Those that have a lock file, by id: what can be told of a ring of which no daemon answers.
std::vector<KnownNode> known_nodes(const std::string& folder);

/// What is wrong with those of a ring's folder that are read and are not regular files, such as a FIFO by the name of a
/// lock file: they count as not there. Sorted.
std::vector<std::string> unreadable_files(const std::string& folder);
/// The folders of this user's rings, sorted; of some perhaps no daemon lives.
std::vector<std::string> ring_folders();

/// Path of the lock of a `ringctl up` that is starting the ring, or a host's part of it; empty: none is.
std::string held_up_lock(const std::string& folder);

}  // namespace limb_ring::live
