#pragma once

#include <string>

#include "process/unique_fd.h"

namespace limb_ring::process {

/// Opens a file to read, out of a folder where anything may lie by its name: a FIFO would let us wait for whoever
/// writes into it, so that nothing but a regular file is opened.
/// @return an invalid one where there is none; errno says why
UniqueFd open_regular(const std::string& path);

/// "/run/robot/3.lock is a FIFO, not a regular file"; empty where it is one, or nothing is there.
std::string why_not_regular(const std::string& path);

/// The text of an open file, from its beginning.
std::string text_of(const UniqueFd& file);
/// The same of one by its path; empty where open_regular() opens none.
std::string text_of_regular(const std::string& path);

}  // namespace limb_ring::process
