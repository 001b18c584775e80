#pragma once

#include <sys/types.h>

#include <string>

namespace limb_ring::process {

/// Empties the file to which standard error is appended, where it lies in that folder and is longer than `most` bytes.
/// A file of somebody else is left as it is.
/// @return whether it has emptied it
bool empty_long_log(const std::string& folder, off_t most);

}  // namespace limb_ring::process
