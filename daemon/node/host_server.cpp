#include "node/host_server.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/post.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include "io/unique_fd.h"
#include "io/unix_socket.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::host {
namespace {

constexpr std::chrono::milliseconds kAcceptPause{100};

}  // namespace

HostServer::HostServer(boost::asio::io_context& io, HostOptions options, HostHandler& handler)
    : io_(io),
      loop_(event_loop::PacketLoop::of(io)),
      options_(std::move(options)),
      handler_(handler),
      listener_(io, options_.directory, options_.id, options_.name),
      accept_timer_(io) {
  accept();
}

HostServer::~HostServer() { close(); }

void HostServer::accept() {
  listener_.acceptor().async_accept(
      [this, alive = alive_](boost::system::error_code error, event_loop::UnixSocket socket) {
        if (error == boost::asio::error::operation_aborted || !*alive) return;
        if (error) return accept_again_later(error);
        short_ = false;
        process::UniqueFd client(socket.release(error));
        if (frozen_) {
          came_while_frozen_ = std::move(client);
          return;
        }
        admit(std::move(client));
        accept();
      });
}

/// Too many open files, most likely: trying at once would only burn the processor.
void HostServer::accept_again_later(const boost::system::error_code& why) {
  if (!std::exchange(short_, true)) handler_.on_shortage(why.message());
  accept_timer_.expires_after(kAcceptPause);
  accept_timer_.async_wait([this, alive = alive_](boost::system::error_code error) {
    if (!error && *alive) accept();
  });
}

void HostServer::listen_again() {
  accept_timer_.cancel();
  listener_.listen_again();
  if (!came_while_frozen_.valid()) accept();  // else the next one is taken when we go on
}

void HostServer::admit(process::UniqueFd socket) {
  const ucred peer = process::peer_of(socket.get());
  ClientInfo info;
  info.id = ++last_id_;
  info.pid = peer.pid;
  const SessionPtr session = make_session(std::move(socket), info);
  if (!session) {
    ++counters_.refused_unwatched;
    return;
  }
  if (peer.uid != geteuid()) {
    ++counters_.refused_foreign;
    return session->end("this ring belongs to user " + std::to_string(geteuid()) + ", not to " +
                        std::to_string(peer.uid));
  }
  if (sessions_.size() >= options_.max_clients + kKeptPlaces && !make_room(info.pid, /*greeted=*/false)) {
    ++counters_.refused_full;
    return session->end(full());
  }
  sessions_.emplace(info.id, session);
  session->start();
}

/// Somebody has to go, so that a place gets free for a client of process `comer`: who has not greeted, else who is
/// idle, or of another process that holds more than half of the places. Of those one of the process that holds the
/// most, and of that one's who is idle for the longest.
/// @param greeted only those who have, and need a place for long @return false if nobody is
bool HostServer::make_room(pid_t comer, bool greeted) {
  std::map<pid_t, unsigned> places;
  for (const auto& [id, session] : sessions_) ++places[session->info().pid];
  const auto rank = [&](const Session& one) {
    return std::make_tuple(!one.attached(), places[one.info().pid], one.idle_for());
  };
  const auto may_go = [&](const SessionPtr& one) {
    if (!one->attached()) return !greeted && one != booting_cpu_;
    if (one == cpu_ || (greeted && one->info().asks_only)) return false;
    const pid_t holder = one->info().pid;
    return one->idle_for() >= kIdleFor ||
           (holder != comer && places[holder] > (options_.max_clients + kKeptPlaces) / 2);
  };
  const Session* goes = nullptr;
  for (const auto& [id, session] : sessions_)
    if (may_go(session) && (goes == nullptr || rank(*goes) < rank(*session))) goes = session.get();
  if (goes == nullptr) return false;
  ++(goes->attached() ? counters_.displaced : counters_.never_greeted);
  disconnect(goes->info().id, std::string(goes->attached() ? "all places are taken" : "no greeting came") +
                                  ", and others want this one (limits.clients)");
  return true;
}

/// @return null if the kernel watches no more descriptors for us; the client finds its connection closed
HostServer::SessionPtr HostServer::make_session(process::UniqueFd socket, const ClientInfo& info) try {
  SessionOwner& owner = *this;
  return std::make_shared<Session>(io_, std::move(socket), info, owner);
} catch (const std::system_error&) {
  return nullptr;
}

std::string HostServer::full() const {
  return whose() + " has " + std::to_string(options_.max_clients) + " clients already (limits.clients)";
}

/// "node 3 (left_knee)"
std::string HostServer::whose() const {
  if (options_.name.empty()) return "ring " + options_.ring;
  return "node " + std::to_string(options_.id) + " (" + options_.name + ")";
}

Session* HostServer::find(ClientId client) {
  const auto found = sessions_.find(client);
  return found == sessions_.end() ? nullptr : found->second.get();
}

void HostServer::on_end(Session& session, End end) {
  count(end);
  retire(session);
}

void HostServer::count(End end) {
  switch (end) {
    case End::closed:
      return;
    case End::garbage:
      ++counters_.garbage;
      return;
    case End::never_greeted:
      ++counters_.never_greeted;
      return;
    case End::too_slow:
      ++counters_.slow_clients;
      return;
  }
}

/// The handler is told later, from the event loop: it may be the one that is calling us.
void HostServer::retire(Session& session) {
  const auto found = sessions_.find(session.info().id);
  if (found == sessions_.end()) return;
  if (cpu_ == found->second) cpu_.reset();
  if (booting_cpu_ == found->second) left_cpu_ = std::move(booting_cpu_);
  ended_.push_back(std::move(found->second));
  sessions_.erase(found);
  boost::asio::post(io_, [this, alive = alive_] {
    if (*alive) tell_detached();
  });
}

void HostServer::tell_detached() {
  if (const SessionPtr left = std::move(left_cpu_)) {
    options_.turns->left(options_.id);
    handler_.on_left(left->info().pid);
  }
  for (const SessionPtr& session : std::exchange(ended_, {})) {
    if (session->attached()) handler_.on_detach(session->info());
  }
}

const ClientInfo* HostServer::cpu() const { return cpu_ ? &cpu_->info() : nullptr; }

bool HostServer::cpu_can_take() const { return cpu_ && cpu_->credit > 0; }

void HostServer::give(const client::PacketView& packet) {
  if (!cpu_can_take()) return;
  --cpu_->credit;
  cpu_->put(packet);
}

bool HostServer::interrupt(const limb_ring::Interrupt& interrupt) {
  if (!cpu_) {
    ++counters_.interrupts_lost;
    return false;
  }
  cpu_->put(interrupt);
  return true;
}

void HostServer::result(ClientId client, const Result& result) {
  Session* session = find(client);
  if (session == nullptr) return;
  session->is_told();
  session->put_result(result);
}

void HostServer::reply(ClientId client, std::uint32_t token, const std::string& json) {
  Session* session = find(client);
  if (session == nullptr) return;
  session->is_told();
  if (json.size() <= client::kMaxReply) return session->put(Reply{token, json});
  session->put(Reply{token, "{\"error\": \"the answer has " + std::to_string(json.size()) +
                                " bytes, more than a host port carries\"}"});
}

void HostServer::observed(ClientId client, const std::string& json) {
  Session* session = find(client);
  if (session != nullptr && !session->put_observed({json})) ++counters_.observed_lost;
}

bool HostServer::captured(ClientId client, const client::CapturedView& packet) {
  Session* session = find(client);
  if (session == nullptr || session->put_captured(packet)) return true;
  ++counters_.captured_lost;
  return false;
}

void HostServer::capture_counts(ClientId client, const CaptureCounts& counts) {
  if (Session* session = find(client)) session->put(counts);
}

void HostServer::disconnect(ClientId client, const std::string& reason) {
  Session* session = find(client);
  if (session == nullptr) return;
  session->end(reason);
  retire(*session);
}

void HostServer::disconnect_booting_cpu(const std::string& reason) {
  if (booting_cpu_) disconnect(booting_cpu_->info().id, reason);
}

void HostServer::freeze() {
  frozen_ = true;
  for (const auto& [id, session] : sessions_) session->freeze();
}

void HostServer::thaw() {
  frozen_ = false;
  for (const auto& [id, session] : std::map(sessions_)) session->thaw();  // one may end
  if (!came_while_frozen_.valid()) return;
  admit(std::move(came_while_frozen_));
  accept();
}

void HostServer::close(const std::string& reason) {
  *alive_ = false;
  accept_timer_.cancel();
  came_while_frozen_.reset();
  listener_.close();
  for (const auto& [id, session] : sessions_) session->end(reason);
  sessions_.clear();
  ended_.clear();
  for (SessionPtr* cpu : {&cpu_, &booting_cpu_, &left_cpu_}) cpu->reset();
}

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

namespace {

constexpr std::chrono::milliseconds kEnds{200}, kTryAgain{5};

/// Our arguments without the program, each ended by a null, as the kernel has them.
std::string own_arguments() {
  std::ifstream file("/proc/self/cmdline");
  std::string program;
  std::getline(file, program, '\0');
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string own_description() {
  namespace fs = std::filesystem;
  std::error_code unknown;  // leaves it empty
  return std::to_string(getpid()) + '\n' + fs::read_symlink("/proc/self/exe", unknown).string() + '\0' +
         fs::current_path(unknown).string() + '\0' + own_arguments();
}

/// Nothing if it cannot be had: the folder is only less safe then.
std::shared_ptr<process::UniqueFd> lock_against_cleaners(const std::string& directory) {
  static std::weak_ptr<process::UniqueFd> last;
  struct stat there {
  }, ours{};
  const auto is_same = [&](const process::UniqueFd& folder) {
    return ::stat(directory.c_str(), &there) == 0 && ::fstat(folder.get(), &ours) == 0 && there.st_ino == ours.st_ino &&
           there.st_dev == ours.st_dev;
  };
  if (auto folder = last.lock(); folder && is_same(*folder)) return folder;
  auto folder =
      std::make_shared<process::UniqueFd>(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  (void)::flock(folder->get(), LOCK_SH | LOCK_NB);
  last = folder;
  return folder;
}

/// A daemon that was just killed may hold it a moment longer than it is heard.
std::optional<process::LockFile> take(const std::string& path) {
  const auto deadline = std::chrono::steady_clock::now() + kEnds;
  for (;;) {
    std::optional<process::LockFile> lock = process::LockFile::take(path);
    if (lock || std::chrono::steady_clock::now() >= deadline) return lock;
    std::this_thread::sleep_for(kTryAgain);
  }
}

process::LockFile taken(const std::string& path, const std::string& whose) {
  std::optional<process::LockFile> lock = take(path);
  if (!lock) throw NodeHeld(whose + " is held by " + process::lock_holder(path));
  return std::move(*lock);
}

}  // namespace

NodeLock::NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name)
    : folder_(lock_against_cleaners(directory)),
      file_(taken(directory + "/" + std::to_string(id) + ".lock",
                  "node " + std::to_string(id) + " (" + name + ") of ring " + ring)) {
  file_.write(own_description());
}

}  // namespace limb_ring::host
