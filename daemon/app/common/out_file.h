#pragma once

#include <fstream>
#include <string>

namespace limb_ring::app {

/// @return what is wrong: the file and the system's reason; empty where it can be written now
std::string open_for_writing(std::ofstream& file, const std::string& path);

/// Writes what is held back.
/// @return what is wrong: the file and the system's reason, as far as it is known; empty where all has been written
std::string finish_writing(std::ostream& out, const std::string& path);

}  // namespace limb_ring::app
