#include "io/unix_listener.h"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace limb_ring::event_loop {
namespace {

/// Connections that may wait to be accepted.
constexpr int kMostWaiting = 128;

std::runtime_error failure(const std::string& path, const std::string& what, int error) {
  return std::runtime_error("cannot listen at " + path + ": " + what + " (" + std::generic_category().message(error) +
                            ")");
}

bool fits(const std::string& path) { return !path.empty() && path.size() < sizeof(sockaddr_un::sun_path); }

UnixAcceptor listening(boost::asio::io_context& io, const std::string& path) {
  if (!fits(path)) {
    throw std::runtime_error("cannot listen at '" + path +
                             "': a socket's path has 1 to 107 bytes; choose a shorter folder");
  }
  remove_leftover(path);
  UnixAcceptor acceptor(io);
  boost::system::error_code error;
  acceptor.open({}, error);
  if (!error) acceptor.bind(path, error);
  if (!error && ::chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0) {
    throw failure(path, "cannot set its mode to 0600", errno);
  }
  if (!error) acceptor.listen(kMostWaiting, error);
  if (error) throw failure(path, "does the folder exist, and is it ours?", error.value());
  return acceptor;
}

}  // namespace

UnixListener::UnixListener(boost::asio::io_context& io, std::string path)
    : io_(io), path_(std::move(path)), acceptor_(listening(io, path_)) {}

UnixListener::~UnixListener() { close(); }

bool UnixListener::is_in_place() const {
  struct stat found {};
  return ::lstat(path_.c_str(), &found) == 0 && S_ISSOCK(found.st_mode);
}

void UnixListener::listen_again() { acceptor_ = listening(io_, path_); }

void UnixListener::close() {
  if (!acceptor_.is_open()) return;
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  ::unlink(path_.c_str());
}

void remove_leftover(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) return;
  if (!S_ISSOCK(found.st_mode) && !S_ISLNK(found.st_mode)) {
    throw std::runtime_error("cannot listen at " + path + ": a file that is not a socket is in the way; remove it");
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) throw failure(path, "cannot remove the old socket", errno);
}

}  // namespace limb_ring::event_loop
