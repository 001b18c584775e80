#include "ring/ring_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

#include "config/fault.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "io/node_notes.h"
#include "io/process_state.h"
#include "io/regular_file.h"
#include "io/unique_fd.h"
#include "io/unix_socket.h"
#include "limb_ring/ring_directory.h"
#include "wire/bytes.h"

namespace limb_ring::live {

namespace fs = std::filesystem;

namespace {

/// A note whose writer was killed (node_notes.cpp): 3.fault.4711
bool is_unfinished_note(const fs::path& file) {
  const std::string pid = file.extension(), kind = file.stem().extension();
  return !pid.empty() && config::are_digits(pid.substr(1)) && (kind == ".fault" || kind == ".killed");
}

bool is_leftover(const fs::path& file) {
  constexpr std::array ours{".boot", ".fault", ".former", ".host", ".killed", ".link",  ".link2",
                            ".lock", ".log",   ".new",    ".read", ".record", ".taken", ".watch"};
  return is_unfinished_note(file) ||
         std::any_of(ours.begin(), ours.end(), [&](const char* extension) { return file.extension() == extension; });
}

}  // namespace

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  if (!why_not_private(folder).empty()) return files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    files.push_back(it->path());
  if (process::is_shortage(error.value())) throw std::system_error(error, "cannot look into " + folder);
  return files;
}

std::optional<std::uint8_t> node_of(const std::string& file, const std::string& kind) {
  const std::string digits = fs::path(file).stem();
  if (fs::path(file).extension() != kind || !config::are_digits(digits, 3) || std::stoi(digits) > 254)
    return std::nullopt;
  return static_cast<std::uint8_t>(std::stoi(digits));
}

std::string kept_logs(const std::string& folder) {
  const fs::path path(folder);
  return path.parent_path() / ".logs" / path.filename();
}

std::string log_of(const std::string& folder, std::uint8_t node) {
  for (const std::string& name : {std::to_string(node) + ".log", std::string(kRingLog)})
    if (fs::exists(fs::path(folder) / name)) return fs::path(folder) / name;
  return {};
}

void forget_logs(const std::string& folder) {
  std::error_code ignored;
  fs::remove_all(kept_logs(folder), ignored);
}

namespace {

/// Of a file system that is full or read-only they go the way of the others.
void keep_logs(const std::vector<std::string>& logs, const std::string& folder) {
  std::error_code ignored;
  if (logs.empty()) return;
  forget_logs(folder);
  const fs::path kept = kept_logs(folder);
  fs::create_directories(kept, ignored);
  for (const fs::path& ours : {kept.parent_path(), kept})
    fs::permissions(ours, fs::perms::owner_all, ignored);  // else nobody reads it: files_in()
  for (const fs::path log : logs) fs::rename(log, kept / log.filename(), ignored);
}

}  // namespace

void remove_leftovers(const std::string& folder) {
  std::error_code ignored;
  std::vector<std::string> logs;
  const std::vector<std::string> files = files_in(folder);
  std::copy_if(files.begin(), files.end(), std::back_inserter(logs),
               [](const fs::path file) { return file.extension() == ".log"; });
  keep_logs(logs, folder);
  for (const std::string& file : files)
    if (is_leftover(file)) fs::remove(file, ignored);
  fs::remove(folder, ignored);
}

namespace fs = std::filesystem;

namespace {

/// The kernel frees a lock when its holder ends, so a lock that cannot be had has a living holder. This asks for the
/// lock and does not take it: a daemon that starts at this moment gets it (node/host_server.cpp).
bool is_held(const process::UniqueFd& file) {
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  return ::fcntl(file.get(), F_OFD_GETLK, &whole_file) == 0 && whole_file.l_type != F_UNLCK;
}

/// @throw std::system_error if that cannot be known
bool is_held(const fs::path& lock) {
  const process::UniqueFd file = process::open_regular(lock);
  if (!file.valid() && process::is_shortage(errno)) process::throw_errno("cannot look at " + lock.string());
  return file.valid() && is_held(file);
}

/// The daemon that listens at a node's host port. If its lock file was removed, as by a cleaner of temporary files,
/// it lives all the same, and makes the file again within a second: for a moment that is there and not locked. @return
/// -1 if none listens
pid_t listening_at(const std::string& socket) {
  const process::UniqueFd connection = process::connect_unix(socket);
  return connection.valid() && process::is_of_our_user(connection.get()) ? process::peer_of(connection.get()).pid : -1;
}

/// Why a lock file that could not be opened does not tell who holds it; empty if there is none.
std::string why_untold(const fs::path& lock, int error) {
  const std::string other = process::why_not_regular(lock);
  if (!other.empty() || error == ENOENT) return other;
  return "cannot look at " + lock.string() + ": " + std::strerror(error);
}

/// The number that is the whole of this line; -1 if something else has been written into the file ("10:16:33 ...").
pid_t pid_in(const std::string& line) {
  const pid_t pid = config::are_digits(line, 9) ? std::stoi(line) : -1;
  return pid > 1 ? pid : -1;
}

/// What is left of the file: words that end by a null; by a line end where a daemon of limb_ring 0.1.0 wrote it.
std::vector<std::string> rest_of(std::istream& file) {
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const char end = text.find('\0') == std::string::npos ? '\n' : '\0';
  std::istringstream words(text);
  std::vector<std::string> rest;
  for (std::string word; std::getline(words, word, end);) rest.push_back(word);
  return rest;
}

/// Whether that process may be this daemon: the kernel adds " (deleted)" where its program was replaced. If the
/// daemon is in another pid namespace, as in a container, its number here may be that of another ring's daemon.
bool may_be(pid_t pid, const Holder& daemon) {
  const std::string folder = "/proc/" + std::to_string(pid);
  std::error_code unknown;
  const std::string runs = fs::read_symlink(folder + "/exe", unknown).string();
  if (daemon.program.empty()) return true;
  if (!unknown && runs != daemon.program && runs != daemon.program + " (deleted)") return false;
  std::ifstream command(folder + "/cmdline");
  std::string called;
  std::getline(command, called, '\0');  // empty if the process is ending
  return called.empty() || rest_of(command) == daemon.arguments;
}

bool are_of_virtual_ring(const std::vector<std::string>& arguments) {
  const auto has = [&arguments](const std::string& word) {
    return std::find(arguments.begin(), arguments.end(), word) != arguments.end();
  };
  const auto clock = std::find(arguments.begin(), arguments.end(), "--clock");
  const bool as_two = clock != arguments.end() && clock + 1 != arguments.end() && *(clock + 1) != "machine";
  return as_two || has("--clock=virtual") || has("--clock=follow");
}

/// The fault that a virtual ring has noted for one of its nodes; empty: the node runs.
std::string noted_fault(const std::string& folder, std::uint8_t node) {
  const auto note = note_of(folder, wire::NodeId{node});
  return note ? note->name() : "";
}

/// A file that says something of a node, or of who starts the ring.
bool is_read(const fs::path& file) {
  const std::string kind = file.extension();
  return kind == ".lock" || kind == ".fault" || kind == ".killed";
}

std::string lock_file(const std::string& folder, std::uint8_t node) {
  return folder + "/" + std::to_string(node) + ".lock";
}

std::string socket_of(const std::string& folder, std::uint8_t node) {
  return folder + "/" + std::to_string(node) + ".host";
}

/// What the lock file told of a daemon that lives, though that was removed.
Holder listener_of(const std::string& folder, std::uint8_t node) {
  Holder holder;
  holder.pid = listening_at(socket_of(folder, node));
  if (holder.pid <= 0) return {};
  const std::string process = "/proc/" + std::to_string(holder.pid);
  std::error_code unknown;
  holder.program = fs::read_symlink(process + "/exe", unknown).string();
  holder.folder = fs::read_symlink(process + "/cwd", unknown).string();
  std::ifstream command(process + "/cmdline");
  std::string called;
  std::getline(command, called, '\0');
  holder.arguments = rest_of(command);
  return holder;
}

/// What the file tells; all but whether its holder lives.
Holder told_by(const process::UniqueFd& file) {
  Holder holder;
  std::istringstream text(process::text_of(file));
  std::string pid;
  std::getline(text, pid);
  holder.arguments = rest_of(text);
  for (std::string* first : {&holder.program, &holder.folder}) {
    if (holder.arguments.empty()) break;
    *first = holder.arguments.front();
    holder.arguments.erase(holder.arguments.begin());
  }
  holder.pid = pid_in(pid);
  return holder;
}

}  // namespace

Holder holder_of(const std::string& folder, std::uint8_t node) {
  if (!why_not_private(folder).empty()) return {};
  const std::string lock = lock_file(folder, node);
  const process::UniqueFd file = process::open_regular(lock);
  Holder holder = file.valid() ? told_by(file) : Holder{};
  if (!file.valid()) holder.problem = why_untold(lock, errno);
  bool lives = file.valid() && is_held(file);
  if (!lives && holder.problem.empty()) {
    const Holder listener = listener_of(folder, node);
    lives = listener.pid > 0;
    if (lives) holder = listener;
  }
  // Another process has that pid: it must not be signalled.
  if (lives && !may_be(holder.pid, holder)) holder.pid = -1;
  holder.on_virtual_ring = lives && are_of_virtual_ring(holder.arguments);
  const std::string fault = holder.on_virtual_ring ? noted_fault(folder, node) : "";
  holder.held = lives && fault != fault::word_of(fault::Name::kill).word;
  const fault::Word* word = fault::find_word(fault);
  holder.frozen = holder.held && ((word != nullptr && fault::freezes(word->name)) || process::is_stopped(holder.pid));
  return holder;
}

void keep_holder(const std::string& folder, std::uint8_t node, const Holder& holder) {
  const process::UniqueFd file = process::open_regular(lock_file(folder, node), O_WRONLY | O_CREAT | O_EXCL);
  if (!file.valid()) return;
  std::string text = std::to_string(holder.pid) + '\n';
  for (const std::string* word : {&holder.program, &holder.folder}) text += *word + '\0';
  for (const std::string& argument : holder.arguments) text += argument + '\0';
  (void)!::write(file.get(), text.data(), text.size());
}

std::optional<std::uint64_t> last_boot(const std::string& folder, std::uint8_t node) {
  const std::string bytes = process::text_of_regular(folder + "/" + std::to_string(node) + ".boot");
  if (bytes.size() != sizeof(std::uint64_t)) return std::nullopt;
  return wire::load_u64(reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

// The lock is looked at before the socket: a daemon that makes its file again listens all the time.
std::vector<HeldNode> held_nodes(const std::string& folder) {
  std::set<std::uint8_t> nodes;
  for (const std::string& file : files_in(folder))
    for (const char* kind : {".lock", ".host"})
      if (const auto node = node_of(file, kind)) nodes.insert(*node);
  std::vector<HeldNode> held;
  for (const std::uint8_t node : nodes) {
    const std::string lock = lock_file(folder, node);
    if (is_held(fs::path(lock)))
      held.push_back({node, lock, holder_of(folder, node).pid});
    else if (const pid_t pid = listening_at(socket_of(folder, node)); pid > 0)
      held.push_back({node, lock, pid});
  }
  return held;
}

std::vector<std::string> ring_folders() {
  std::vector<std::string> folders = files_in(rings_directory());
  std::sort(folders.begin(), folders.end());
  return folders;
}

std::vector<std::string> held_rings() {
  std::vector<std::string> rings;
  for (const fs::path folder : ring_folders())
    if (!held_nodes(folder).empty()) rings.push_back(folder.filename());
  return rings;
}

// A note stays where something else than `fault start` has started the node; its lock file then has another pid.
bool is_killed(const std::string& folder, wire::NodeId node) {
  const auto note = note_of(folder, node);
  if (!note || note->name() != fault::word_of(fault::Name::kill).word) return false;
  const Holder last = holder_of(folder, node);
  return !last.held && (last.on_virtual_ring || was_killed(folder, node, last.pid));
}

std::vector<KnownNode> known_nodes(const std::string& folder) {
  const auto names = node_names(folder);
  std::vector<KnownNode> nodes;
  for (const fs::path file : files_in(folder)) {
    const auto id = node_of(file, ".lock");
    if (!id) continue;
    const auto note = note_of(folder, wire::NodeId{*id});
    std::istringstream words(note ? note->words : "");
    std::string fault, name;
    const auto linked = names.find(std::to_string(*id));
    const bool is_named = linked != names.end() && config::is_node_name(linked->second);
    if (!(words >> fault >> name)) name = is_named ? linked->second : std::to_string(*id);
    nodes.push_back({wire::NodeId{*id}, name});
  }
  std::sort(nodes.begin(), nodes.end(), [](const KnownNode& a, const KnownNode& b) { return a.id < b.id; });
  return nodes;
}

namespace {

std::vector<std::string> dead_rings(bool killed) {
  std::vector<std::string> rings;
  for (const fs::path folder : ring_folders()) {
    const auto nodes = known_nodes(folder);
    const auto is_killed_one = [&](const KnownNode& node) { return is_killed(folder, node.id); };
    if (nodes.empty() || !held_nodes(folder).empty()) continue;
    if (std::any_of(nodes.begin(), nodes.end(), is_killed_one) == killed) rings.push_back(folder.filename());
  }
  return rings;
}

}  // namespace

std::vector<std::string> killed_rings() { return dead_rings(true); }

std::vector<std::string> left_rings() { return dead_rings(false); }

std::vector<std::string> unreadable_files(const std::string& folder) {
  std::vector<std::string> problems;
  for (const fs::path file : files_in(folder)) {
    if (!is_read(file)) continue;
    const std::string problem = process::why_not_regular(file);
    if (!problem.empty()) problems.push_back(problem + ": it tells nothing; remove it");
  }
  std::sort(problems.begin(), problems.end());
  return problems;
}

std::string held_up_lock(const std::string& folder) {
  for (const fs::path file : files_in(folder)) {
    const std::string stem = file.stem();
    const bool of_up = file.extension() == ".lock" && (stem == "up" || stem.rfind("up-", 0) == 0);
    if (of_up && is_held(file)) return file;
  }
  return "";
}

}  // namespace limb_ring::live
