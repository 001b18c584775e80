#include "io/node_notes.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "io/regular_file.h"
#include "io/unique_fd.h"

namespace limb_ring::live {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

std::string file_of(const std::string& folder, wire::NodeId node, const char* extension) {
  return folder + "/" + std::to_string(node) + extension;
}

std::string fault_file(const std::string& folder, wire::NodeId node) { return file_of(folder, node, ".fault"); }
std::string killed_file(const std::string& folder, wire::NodeId node) { return file_of(folder, node, ".killed"); }

/// Who reads it meanwhile finds the former one, or the new one. @return why it could not be written
std::string write_line(const std::string& path, const std::string& line) {
  const std::string text = line + '\n', made = path + '.' + std::to_string(::getpid());
  const process::UniqueFd file(::open(made.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
  const bool written = file.valid() && ::write(file.get(), text.data(), text.size()) == ssize_t(text.size());
  if (written && ::rename(made.c_str(), path.c_str()) == 0) return "";
  const std::string problem = "cannot write " + path + ": " + std::strerror(errno);
  ::unlink(made.c_str());
  return problem;
}

}  // namespace

std::string NodeNote::name() const { return words.substr(0, words.find(' ')); }

std::string write_note(const std::string& folder, wire::NodeId node, const std::string& words) {
  const auto now = std::chrono::duration_cast<milliseconds>(steady_clock::now().time_since_epoch());
  return write_line(fault_file(folder, node), std::to_string(now.count()) + ' ' + words);
}

void remove_note(const std::string& folder, wire::NodeId node) { std::remove(fault_file(folder, node).c_str()); }

std::optional<NodeNote> note_of(const std::string& folder, wire::NodeId node) {
  std::istringstream file(process::text_of_regular(fault_file(folder, node)));
  std::int64_t since = 0;
  NodeNote note;
  if (!(file >> since) || !std::getline(file >> std::ws, note.words)) return std::nullopt;
  note.since = steady_clock::time_point(milliseconds(since));
  return note;
}

std::string write_killed(const std::string& folder, wire::NodeId node, pid_t daemon) {
  return write_line(killed_file(folder, node), std::to_string(daemon));
}

bool was_killed(const std::string& folder, wire::NodeId node, pid_t daemon) {
  pid_t killed = 0;
  std::istringstream file(process::text_of_regular(killed_file(folder, node)));
  return file >> killed && killed == daemon;
}

}  // namespace limb_ring::live
