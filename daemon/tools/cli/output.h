#pragma once

#include <iosfwd>
#include <string>

namespace limb_ring::cli {

/// Writes what is held back.
/// @return what is wrong: the file and the system's reason, as far as it is known; empty where all has been written
std::string finish_writing(std::ostream& out, const std::string& path);

/// Exit code of a program that would end with `code`: 1 instead of 0, and a line on standard error, where standard
/// output could not take all that was written.
int code_with_output(const std::string& program, int code);

}  // namespace limb_ring::cli
