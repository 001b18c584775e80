#pragma once

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace limb_ring {

/// Where the sockets of the rings of this user live (ours):
/// `$XDG_RUNTIME_DIR/limb_ring`; if that is not set, or not an absolute path, `limb_ring-UID` below the system's
/// temporary folder. Only the name is made here, not the folder.
/// @param runtime folder in the place of $XDG_RUNTIME_DIR; empty: the environment says it
std::string rings_directory(const std::string& runtime = {});

/// A ring may have that name: 1 to 32 letters (of ASCII, whatever the locale), digits, '-', '_' and '.', not beginning
/// with '.', as a hidden file, or '-', as an option.
inline bool is_ring_name(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  };
  return !name.empty() && name.size() <= 32 && name.front() != '.' && name.front() != '-' &&
         std::all_of(name.begin(), name.end(), fits);
}

/// The folder of one ring: `rings_directory()/RING`.
/// @throw std::invalid_argument if that is not a name of a ring
std::string ring_directory(const std::string& ring, const std::string& runtime = {});

/// Why a folder could hold sockets or lock files of other users: "belongs to user 1001, not to this one (1000)". Empty
/// if only this user can write there, or if there is no such folder.
std::string why_not_private(const std::string& folder);

/// Creates the folder of a ring (and those above it) with mode 0700.
/// @throw std::runtime_error naming the folder if it belongs to another user, is a link, is
///        open to others, or cannot be made.
std::string make_ring_directory(const std::string& ring);

/// Rings with at least one daemon that answers, by name, sorted.
std::vector<std::string> running_rings(const std::string& runtime = {});

/// Names of nodes by their ids, both as text, from the links NAME.host to ID.host in a ring's folder. The names are not
/// checked.
std::map<std::string, std::string> node_names(const std::string& directory);

/// Nodes of a ring that have run here: by name, or by id if a node has no name; in the order of their ids. No daemon is
/// asked whether it still runs: a frozen one would keep all others waiting.
/// @throw std::invalid_argument if that is not a name of a ring
std::vector<std::string> nodes_here(const std::string& ring, const std::string& runtime = {});

/// Path of a node's socket: `DIRECTORY/NODE.host` and the like; NODE is an id or a name (ringd
/// links the name to the id).
/// @throw std::invalid_argument if the path is too long for a UNIX socket (107 bytes), or
///        NODE is not a name (as a ring's).
std::string socket_path(const std::string& directory, const std::string& node, const char* kind);

}  // namespace limb_ring
