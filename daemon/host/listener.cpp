#include "host/listener.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

#include "limb_ring/ring_directory.h"
#include "process/is_socket.h"
#include "process/throw_errno.h"

namespace limb_ring::host {

namespace {

using process::throw_errno;

constexpr int kBacklog = 64;
constexpr mode_t kOwnerOnly = 0600;

/// Removes what a dead daemon left behind, and nothing else.
void remove_leftover(const std::string& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) return;
  if (!S_ISSOCK(status.st_mode) && !S_ISLNK(status.st_mode)) {
    throw std::runtime_error(path + " is in the way: it is no socket; remove it");
  }
  if (unlink(path.c_str()) != 0 && errno != ENOENT) throw_errno("cannot remove " + path);
}

}  // namespace

Listener::Listener(boost::asio::io_context& io, const std::string& directory, std::uint8_t id, const std::string& name)
    : path_(socket_path(directory, std::to_string(id), "host")),
      link_(name.empty() ? "" : socket_path(directory, name, "host")),
      acceptor_(io) {
  if (link_ == path_) link_.clear();
  listen();
}

void Listener::listen() {
  remove_leftover(path_);
  const boost::asio::local::stream_protocol::endpoint endpoint(path_);
  try {
    acceptor_.open(endpoint.protocol());
    acceptor_.bind(endpoint);
    if (chmod(path_.c_str(), kOwnerOnly) != 0) throw_errno("cannot restrict " + path_);
    acceptor_.listen(kBacklog);
    acceptor_.non_blocking(true);
  } catch (const boost::system::system_error& problem) {
    throw std::runtime_error("cannot listen at " + path_ + ": " + problem.code().message());
  }
  if (!link_.empty()) link_name();
}

bool Listener::is_in_place() const {
  if (!process::is_socket(path_)) return false;
  struct stat status {};
  return link_.empty() || (lstat(link_.c_str(), &status) == 0 && S_ISLNK(status.st_mode));
}

void Listener::listen_again() {
  boost::system::error_code error;
  acceptor_.close(error);
  listen();
}

void Listener::link_name() const {
  remove_leftover(link_);
  const std::string target = path_.substr(path_.rfind('/') + 1);
  if (symlink(target.c_str(), link_.c_str()) != 0) throw_errno("cannot make the link " + link_);
}

void Listener::close() {
  if (!acceptor_.is_open()) return;
  boost::system::error_code error;
  acceptor_.close(error);
  unlink(path_.c_str());
  if (!link_.empty()) unlink(link_.c_str());
}

Listener::~Listener() { close(); }

}  // namespace limb_ring::host
