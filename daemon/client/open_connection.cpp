#include "client/open_connection.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "client/meanwhile.h"
#include "io/unix_socket.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::client {

namespace {

constexpr std::chrono::milliseconds kBetweenTries{10};
/// For the answer of a daemon that is there, where one try is all.
constexpr std::chrono::milliseconds kWelcomeDeadline{2000};

struct Target {
  std::string ring;
  std::string rings;  // the folder of all rings
  std::string directory;
  std::string path;
};

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr ? value : "";
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string only_running_ring(const std::string& runtime, Clock::time_point deadline, Meanwhile& meanwhile) {
  std::vector<std::string> rings = running_rings(runtime);
  while (rings.empty() && Clock::now() < deadline) {
    meanwhile.look();
    std::this_thread::sleep_for(kBetweenTries);
    rings = running_rings(runtime);
  }
  if (rings.size() == 1) return rings.front();
  if (rings.empty()) {
    throw HostPortTimeout("no ring is running (looked in " + rings_directory(runtime) + ")");
  }
  throw HostPortError("several rings are running: " + joined(rings) + "; name one (option ring, or LIMB_RING_RING)");
}

std::string ring_of(const ConnectOptions& options, Clock::time_point deadline, Meanwhile& meanwhile) {
  if (!options.ring.empty()) return options.ring;
  const std::string given = environment("LIMB_RING_RING");
  return given.empty() ? only_running_ring(options.runtime, deadline, meanwhile) : given;
}

std::string node_of(const ConnectOptions& options) {
  const std::string node = options.node.empty() ? environment("LIMB_RING_NODE") : options.node;
  if (!node.empty()) return node;
  throw HostPortError("no node given: name one (option node, or LIMB_RING_NODE), by id or name");
}

Target find_target(const ConnectOptions& options, Clock::time_point deadline, Meanwhile& meanwhile) {
  const std::string node = node_of(options);
  const std::string ring = ring_of(options, deadline, meanwhile);
  try {
    const std::string directory = ring_directory(ring, options.runtime);
    return {ring, rings_directory(options.runtime), directory, socket_path(directory, node, "host")};
  } catch (const std::invalid_argument& problem) {
    throw HostPortError(problem.what());
  }
}

/// Another user could have made the folder below the system's temporary one before us.
void refuse_foreign_folder(const std::string& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0) return;  // not there yet
  if (S_ISDIR(status.st_mode) && status.st_uid == geteuid()) return;
  throw HostPortError(folder + " is not a folder of this user's (" + std::to_string(geteuid()) +
                      "): not connecting to what may be another user's socket");
}

void refuse_foreign_daemon(const UnixSocket& socket, const std::string& path) {
  if (process::is_of_our_user(socket.fd())) return;
  throw HostPortError(path + " is served by another user's process");
}

/// Connects. @return nothing if nobody listens yet; `problem` then says so. @throw HostPortError for other errors
std::optional<UnixSocket> open_socket(const Target& target, std::string& problem) {
  refuse_foreign_folder(target.rings);
  refuse_foreign_folder(target.directory);
  std::optional<UnixSocket> socket = UnixSocket::connect(target.path);
  if (socket) {
    refuse_foreign_daemon(*socket, target.path);
    return socket;
  }
  const int why = errno;
  problem = "cannot connect to " + target.path + ": " + std::strerror(why);
  const bool may_come = why == ENOENT || why == ECONNREFUSED || why == EAGAIN;
  if (!may_come) throw HostPortError(problem);
  problem += " (is ringd running for this node of ring " + target.ring + "?)";
  return std::nullopt;
}

/// Where no daemon has ever been: it may be another node that was meant.
std::string who_is_there(const Target& target, const ConnectOptions& options) {
  struct stat status {};
  if (lstat(target.path.c_str(), &status) == 0) return "";
  const std::vector<std::string> nodes = nodes_here(target.ring, options.runtime);
  return nodes.empty() ? "" : "; nodes of this ring here: " + joined(nodes);
}

/// A daemon that comes late has as long to answer as one that was there from the start.
Clock::time_point answers_by(const ConnectOptions& options, Clock::time_point deadline) {
  const bool one_try = options.timeout.count() <= 0;
  return std::max(deadline, Clock::now() + (one_try ? kWelcomeDeadline : std::min(options.timeout, kWelcomeDeadline)));
}

/// One attempt to connect and greet. @return nothing if a later one may succeed
std::optional<Connection> try_once(const Target& target, const ConnectOptions& options, Clock::time_point deadline,
                                   std::string& problem) {
  std::optional<UnixSocket> socket = open_socket(target, problem);
  if (!socket) return std::nullopt;
  Connection connection(std::move(*socket), options);
  switch (connection.greet(options, target.ring, answers_by(options, deadline))) {
    case Connection::Handshake::welcome:
      return connection;
    case Connection::Handshake::refused:
      throw HostPortError(target.path + ": " + connection.reason());
    case Connection::Handshake::timed_out:
      throw HostPortTimeout(target.path + ": the daemon does not answer (is it stopped?)");
    case Connection::Handshake::closed:
      break;
  }
  problem = target.path + ": the daemon closed the connection without a word";
  return std::nullopt;
}

}  // namespace

Connection open_connection(const ConnectOptions& options, Clock::time_point deadline) {
  Meanwhile meanwhile(options.meanwhile);
  const Target target = find_target(options, deadline, meanwhile);
  for (;;) {
    std::string problem;
    std::optional<Connection> connection = try_once(target, options, deadline, problem);
    if (connection) return std::move(*connection);
    if (Clock::now() >= deadline) throw HostPortTimeout(problem + who_is_there(target, options));
    meanwhile.look();
    std::this_thread::sleep_for(kBetweenTries);
  }
}

}  // namespace limb_ring::client
