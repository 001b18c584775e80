#pragma once

#include <optional>
#include <string>

namespace limb_ring::config {

/// The files of a ring as `ringctl up` has read them, kept in the ring's folder: its daemons and their CPUs read these,
/// also those that start again after a file was edited. (ours)
///
/// The environment variable that names the folder, for a daemon and what it starts.
constexpr const char* kAsRead = "LIMB_RING_AS_READ";

/// Keeps a text in a folder, in place of one of that path. @throw std::runtime_error
void keep_as_read(const std::string& folder, const std::string& path, const std::string& text);
/// What is kept of that path; nothing if nothing is, or the environment names no folder.
std::optional<std::string> as_read(const std::string& path);

}  // namespace limb_ring::config
