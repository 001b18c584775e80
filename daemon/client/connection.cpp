#include "client/connection.h"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "io/unix_socket.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::client {
namespace {

constexpr std::chrono::seconds kWriteDeadline{5};
using Milliseconds = std::chrono::milliseconds;
constexpr Milliseconds kMaxAlivePeriod{24 * 3600 * 1000};
constexpr const char* kUnreceived = "65536 messages were left without receive()";
constexpr const char* kDaemonGone = "the daemon has closed the connection";

}  // namespace

Connection::Connection(UnixSocket socket, const ConnectOptions& options)
    : socket_(std::move(socket)),
      alive_period_(std::clamp(options.alive_period, Milliseconds{0}, kMaxAlivePeriod)),
      meanwhile_(options.meanwhile),
      last_written_(now()) {}

Connection::Handshake Connection::greet(const ConnectOptions& options, const std::string& wanted_ring,
                                        Clock::time_point deadline) {
  Greeting greeting;
  greeting.role = options.role;
  greeting.restarted_by_owner = options.restarted_by_owner;
  greeting.results_may_wait = options.results_may_wait;
  greeting.asks_only = options.asks_only;
  greeting.lockstep = options.lockstep && options.role == Role::cpu;
  greeting.pid = static_cast<std::uint32_t>(::getpid());
  greeting.alive_period = alive_period_;
  greeting.ring = wanted_ring;
  send(greeting);
  for (read(); connected_ && !welcome_ && Clock::now() < deadline; read()) {
    look();
    socket_.wait(POLLIN, meanwhile_.until(deadline));
  }
  if (!connected_) return reason_ == kDaemonGone ? Handshake::closed : Handshake::refused;
  if (!welcome_) return Handshake::timed_out;
  if (options.role == Role::cpu) send(Credit{kPacketWindow});
  if (clock_ == ClockKind::lockstep) await_turn();  // its boot takes the ring's time
  if (!connected_) return Handshake::refused;
  return Handshake::welcome;
}

std::uint32_t Connection::begin(Pending::Ends ends) {
  await_turn();
  if (inbox_.full()) lose(kUnreceived);
  const std::uint32_t token = pending_.add(ends);
  if (!connected_) pending_.cancel_all(reason_, inbox_);
  return token;
}

void Connection::reject(std::uint32_t token, const std::string& reason, Reason why) {
  pending_.end(token, {token, Outcome::rejected, {}, 0, reason, why}, inbox_);
}

void Connection::flush() {
  Clock::time_point deadline{};  // begins when the socket is first found full
  std::size_t done = 0;
  while (connected_ && done < out_.size()) {
    std::size_t written = 0;
    const wire::ByteView left{out_.data() + done, out_.size() - done};
    const auto status = socket_.write(left, written);
    done += written;
    if (status == UnixSocket::Status::done) deadline = {};
    // If the write fails, the daemon may have left a last message: read() takes it and ends the connection.
    if (status == UnixSocket::Status::closed) read();
    if (status == UnixSocket::Status::closed) lose(kDaemonGone);
    if (status != UnixSocket::Status::would_block) continue;
    if (deadline == Clock::time_point{}) deadline = Clock::now() + kWriteDeadline;
    wait_to_write(deadline);
  }
  out_.clear();
  if (alive_period_.count() > 0) last_written_ = now();
}

/// Reads while it waits: otherwise we and a daemon that waits for us to read would block each other.
void Connection::wait_to_write(Clock::time_point deadline) {
  const short events = socket_.wait(POLLIN | POLLOUT, deadline);
  if (events == 0) lose("the daemon has not read for 5 s");
  if ((events & POLLIN) != 0) read();
}

bool Connection::wait_until(std::chrono::nanoseconds until) {
  if (!connected_) return false;
  if (clock_ != ClockKind::lockstep) return socket_.wait(POLLIN, Clock::time_point(until)) != 0;
  send(Waiting{until});
  my_turn_ = false;
  await_turn();
  return true;
}

void Connection::sleep_until(std::chrono::nanoseconds time) {
  for (read(); connected_ && now() < time; read()) wait_until(time);
}

// Without a time-out: another program of the ring may be stopped in a debugger.
void Connection::await_turn() {
  while (connected_ && !my_turn_) {
    look();
    socket_.wait(POLLIN, meanwhile_.until(Clock::time_point::max()));
    read();
  }
}

std::chrono::nanoseconds Connection::now() const {
  return clock_ == ClockKind::lockstep ? turn_at_ : std::chrono::nanoseconds(Clock::now().time_since_epoch());
}

bool Connection::may_take_unread() { return !inbox_.empty() && taken_unread_++ < kMostFromOneRead; }

void Connection::read() {
  taken_unread_ = 0;
  if (!connected_ || (clock_ == ClockKind::lockstep && my_turn_)) return;
  if (inbox_.full()) return lose(kUnreceived);
  const auto status = socket_.read(in_);
  take_frames();
  if (status == UnixSocket::Status::closed) lose(kDaemonGone);
}

void Connection::take_frames() {
  while (connected_) {
    const FrameParse parse = parse_frame(in_.view(), kMaxSizeToClient);
    if (parse.status == FrameParse::Status::incomplete) return;
    const bool frame = parse.status == FrameParse::Status::frame;
    std::optional<ToClient> message = frame ? decode_to_client(parse.frame) : std::nullopt;
    if (!message) return lose("the daemon sent something that is not a message of this library's version");
    std::visit([this](auto& kind) { on(std::move(kind)); }, *message);
    in_.used(parse.consumed);
  }
}

void Connection::on(const Welcome& welcome) {
  welcome_ = true;
  id = welcome.id;
  name = std::string(welcome.name);
  ring = std::string(welcome.ring);
  clock_ = welcome.clock;
  if (clock_ == ClockKind::lockstep) my_turn_ = false;
}

void Connection::on(const Turn& turn) {
  my_turn_ = true;
  turn_at_ = turn.now;
}

void Connection::on(const Refused& refused) { lose(std::string(refused.reason)); }

void Connection::on(const PacketView& packet) {
  inbox_.put(Packet{
      packet.source, packet.destination, packet.priority, packet.channel, {packet.data.begin(), packet.data.end()}});
}

void Connection::on(Result result) {
  if (pending_.remove(result.token)) inbox_.put(std::move(result));
}

void Connection::on(Reply reply) {
  if (pending_.remove(reply.token)) inbox_.put(std::move(reply));
}

void Connection::lose(const std::string& reason) {
  if (!connected_) return;
  connected_ = false;
  reason_ = reason;
  pending_.cancel_all(reason, inbox_);
  inbox_.put(Disconnected{reason});
}

std::optional<Message> Connection::take() {
  std::optional<Message> message = inbox_.take();
  if (!message || !std::holds_alternative<Packet>(*message)) return message;
  if (++credit_owed_ >= kCreditLot) send(Credit{std::exchange(credit_owed_, std::uint16_t{0})});
  return message;
}

void Connection::stay_alive() {
  await_turn();
  if (!connected_ || alive_period_.count() == 0) return;
  if (now() - last_written_ >= alive_period_ / 4) send(Alive{});
}

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

/// Why an attempt has failed, after which a later one may succeed.
struct Failed {
  std::string why;
  bool is_there = false;  ///< the daemon is, and takes no more connections for now
};

/// Connects. @return nothing if nobody listens yet, or too many wait there. @throw HostPortError for other errors
std::optional<UnixSocket> open_socket(const Target& target, Failed& failed) {
  refuse_foreign_folder(target.rings);
  refuse_foreign_folder(target.directory);
  std::optional<UnixSocket> socket = UnixSocket::connect(target.path);
  if (socket) {
    refuse_foreign_daemon(*socket, target.path);
    return socket;
  }
  const int why = errno;
  failed = {"cannot connect to " + target.path + ": " + std::strerror(why), why == EAGAIN};
  if (failed.is_there) {
    failed.why += " (too many programs want to connect)";
    return std::nullopt;
  }
  if (why != ENOENT && why != ECONNREFUSED) throw HostPortError(failed.why);
  failed.why += " (is ringd running for this node of ring " + target.ring + "?)";
  return std::nullopt;
}

/// If no daemon has ever been: it may be another node that was meant.
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
                                   Failed& failed) {
  std::optional<UnixSocket> socket = open_socket(target, failed);
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
  failed = {target.path + ": the daemon closed the connection without a word"};
  return std::nullopt;
}

}  // namespace

Connection open_connection(const ConnectOptions& options, Clock::time_point deadline) {
  Meanwhile meanwhile(options.meanwhile);
  const Target target = find_target(options, deadline, meanwhile);
  const Clock::time_point in_time = answers_by(options, deadline);
  for (;;) {
    Failed failed;
    std::optional<Connection> connection = try_once(target, options, deadline, failed);
    if (connection) return std::move(*connection);
    if (Clock::now() >= (failed.is_there ? in_time : deadline))
      throw HostPortTimeout(failed.why + who_is_there(target, options));
    meanwhile.look();
    std::this_thread::sleep_for(kBetweenTries);
  }
}

}  // namespace limb_ring::client
