#pragma once

#include <fcntl.h>

#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// Opens a file in a folder where anything may lie by its name: a FIFO would let us wait for its other end, a link
/// would let us write into somebody's file, so that nothing but a regular file is opened.
/// @param flags as of open(2), beside those that this takes care of; a new file is the user's alone
/// @return an invalid one where there is none; errno says why
UniqueFd open_regular(const std::string& path, int flags = O_RDONLY);
/// Why that has just failed, in words: "it is a FIFO, not a regular file; remove it".
std::string why_not_opened(const std::string& path);

/// "/run/robot/3.lock is a FIFO, not a regular file"; empty where it is one, or nothing is there.
std::string why_not_regular(const std::string& path);

/// The text of an open file, from its beginning.
std::string text_of(const UniqueFd& file);
/// The same of one by its path; empty where open_regular() opens none.
std::string text_of_regular(const std::string& path);

}  // namespace limb_ring::process
