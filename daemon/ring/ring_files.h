#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

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

/// Paths of all files in a folder; none where that is not this user's alone: what others could have put there is
/// nothing to go by. It would choose which processes we signal, which files we remove, and which programs we start.
/// @throw std::system_error where this process or the system has no descriptors left
std::vector<std::string> files_in(const std::string& folder);

/// The id of the node whose file this is: of "12.lock", with any folder before it, 12 as its kind is ".lock". Nothing
/// for a file of another kind, or by another name, such as a node's.
std::optional<std::uint8_t> node_of(const std::string& file, const std::string& kind);

/// Removes what is listed above from a ring's folder, and the folder where nothing else is in it.
/// @pre no node of it is held, and nobody is starting it
void remove_leftovers(const std::string& folder);

/// Where remove_leftovers() keeps the log files of a ring's folder, which say why it ended: `.logs/RING` beside it,
/// until forget_logs(), when the ring is started again.
std::string kept_logs(const std::string& folder);
void forget_logs(const std::string& folder);

}  // namespace limb_ring::live
