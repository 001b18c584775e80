#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wire/packet.h"

/// Files of a folder that is not this user's alone are taken for not there (limb_ring/ring_directory.h,
/// why_not_private).
namespace limb_ring::live {

/// What the lock file of a node says of the daemon that holds it, or held it last (node/node_lock.h).
struct Holder {
  pid_t pid = -1;                      ///< -1 where the file does not tell
  std::string program;                 ///< path
  std::string folder;                  ///< it works in
  std::vector<std::string> arguments;  ///< without the program's name
  bool held = false;                   ///< it lives, perhaps stopped; on a virtual ring: and the node is not killed
  bool frozen = false;                 ///< held, and stopped: answers nobody
  std::string problem;                 ///< why nothing is known of it; empty where its lock file tells, or is not there
  bool on_virtual_ring = false;        ///< one process lives that has all nodes of the ring, this one perhaps killed
};

/// Reads the lock file of one node in a ring's folder, and on a virtual ring its note (node_notes.h). All fields are
/// empty where there never was a daemon.
Holder holder_of(const std::string& folder, std::uint8_t node);
/// Its daemon is stopped: who asks it something waits.
inline bool is_frozen(const std::string& folder, std::uint8_t node) { return holder_of(folder, node).frozen; }

/// Boot number of the node's last daemon (protocol.md section 4.8), which lives or is dead; nothing where none is kept.
std::optional<std::uint64_t> last_boot(const std::string& folder, std::uint8_t node);

/// A node held by a daemon that lives, as its lock file says.
struct HeldNode {
  std::uint8_t node = 0;
  std::string lock;  ///< path of the lock file
  pid_t pid = -1;    ///< of the daemon; -1 where the file does not tell
};

/// Nodes of a ring's folder that are held right now. No daemon: an empty list.
/// @throw std::system_error where that cannot be known, as where this process has no descriptors left
std::vector<HeldNode> held_nodes(const std::string& folder);

/// Rings of this user of which a node is held right now, by name, sorted; also where no daemon answers.
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

/// What is wrong with those of a ring's folder that are read and are no regular files, such as a FIFO by the name of a
/// lock file: they count as not there. Sorted.
std::vector<std::string> unreadable_files(const std::string& folder);
/// The folders of this user's rings, sorted; of some perhaps no daemon lives.
std::vector<std::string> ring_folders();

/// Path of the lock of a `ringctl up` that is starting the ring, or a host's part of it; empty: none is.
std::string held_up_lock(const std::string& folder);

}  // namespace limb_ring::live
