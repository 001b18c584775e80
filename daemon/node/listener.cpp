#include "node/listener.h"

#include <sys/stat.h>
#include <unistd.h>

#include "io/throw_errno.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::host {

Listener::Listener(boost::asio::io_context& io, const std::string& directory, std::uint8_t id, const std::string& name)
    : socket_(io, socket_path(directory, std::to_string(id), "host")),
      link_(name.empty() ? "" : socket_path(directory, name, "host")) {
  if (link_ == socket_.path()) link_.clear();
  link_name();
}

bool Listener::is_in_place() const {
  struct stat status {};
  return socket_.is_in_place() && (link_.empty() || (lstat(link_.c_str(), &status) == 0 && S_ISLNK(status.st_mode)));
}

void Listener::listen_again() {
  socket_.listen_again();
  link_name();
}

void Listener::link_name() const {
  if (link_.empty()) return;
  event_loop::remove_leftover(link_);
  const std::string target = socket_.path().substr(socket_.path().rfind('/') + 1);
  if (symlink(target.c_str(), link_.c_str()) != 0) process::throw_errno("cannot make the link " + link_);
}

void Listener::close() {
  if (!socket_.acceptor().is_open()) return;
  socket_.close();
  if (!link_.empty()) unlink(link_.c_str());
}

Listener::~Listener() { close(); }

}  // namespace limb_ring::host
