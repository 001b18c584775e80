#pragma once

#include <fstream>
#include <string>

namespace limb_ring::app {

/// The ring's YAML file that a command is given: a path, or a ring's name, whose file is NAME.yaml in the user's
/// configuration ($XDG_CONFIG_HOME/limb_ring, ~/.config/limb_ring), in /etc/limb_ring, or among those that came with
/// limb_ring; the first that is there.
/// @return its path; `given` if it holds a '/' or a '.', or is a file
/// @throw config::ConfigError naming the folders, if there is none
std::string ring_file(const std::string& given);

/// For `-`, standard output if that is free for it.
inline constexpr const char* kStandardOutput = "-";

/// For those that write their report to standard output. @return what is wrong if `path` is kStandardOutput, else
/// empty
std::string why_no_file(const std::string& path);

/// @return what is wrong: the file and the system's reason; empty if it can be written now. kStandardOutput is
/// refused: callers whose report goes elsewhere then take it before.
std::string open_for_writing(std::ofstream& file, const std::string& path);

/// Writes a whole file. @return what is wrong; empty if all of it is written
std::string write_file(const std::string& path, const std::string& text);

/// What open_for_writing() would return, without touching the file: for what is written only at the end, and perhaps
/// not at all.
std::string why_not_writable(const std::string& path);

/// Makes the folder, with those above it, if it is not there.
/// @return what is wrong: the folder and the system's reason; empty if files can be made in it now
std::string make_output_folder(const std::string& folder);

/// Whether both are there and are one file: what is to be read from the one would be lost if the other is written.
bool is_same_file(const std::string& one, const std::string& other);

/// Whether both name one file that is to be written, be it there already or not. Devices (/dev/null) may be shared.
bool is_same_output(const std::string& one, const std::string& other);

/// False if standard output is a pipe that nobody reads any more (`| head -1`). For callers that wait
/// until there is something to write.
bool is_output_read();

}  // namespace limb_ring::app
