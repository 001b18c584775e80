#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/arguments.h"
#include "io/regular_file.h"
#include "io/unix_listener.h"
#include "node/session.h"

namespace limb_ring::host {

/// The listening socket DIRECTORY/ID.host, with NAME.host linked to it; both are removed in the
/// end. What a dead daemon left there is replaced: the caller holds the node's lock.
class Listener {
 public:
  /// @throw std::runtime_error naming the path and what is wrong with it
  Listener(boost::asio::io_context& io, const std::string& directory, std::uint8_t id, const std::string& name);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  event_loop::UnixAcceptor& acceptor() { return socket_.acceptor(); }
  /// The socket is where it was made, and the name with it.
  bool is_in_place() const;
  /// Makes it again, in a folder that is there. @throw std::runtime_error
  void listen_again();
  void close();

 private:
  void link_name() const;

  event_loop::UnixListener socket_;
  std::string link_;  ///< empty: there is none
};

/// What happened at a host port; every loss has its counter.
struct HostCounters {
  std::uint64_t refused = 0;            ///< by the handler, a wrong ring or version, a second CPU
  std::uint64_t refused_foreign = 0;    ///< another user's process
  std::uint64_t refused_full = 0;       ///< more clients than limits.clients
  std::uint64_t refused_unwatched = 0;  ///< the kernel watches no more descriptors for us
  std::uint64_t garbage = 0;            ///< closed for bytes that are not a message
  std::uint64_t never_greeted = 0;      ///< closed for not greeting in time, or before others that want the place
  std::uint64_t displaced = 0;          ///< closed as others want the place
  std::uint64_t slow_clients = 0;       ///< closed for not reading what was for them
  std::uint64_t observed_lost = 0;      ///< Observed left out for observers that read too slowly
  std::uint64_t captured_lost = 0;      ///< captured packets left out for observers that read too slowly
  std::uint64_t rejected = 0;           ///< calls with bad arguments
  std::uint64_t interrupts_lost = 0;    ///< interrupts for a CPU that was not attached
};

/// Where a host port listens, and for which node.
struct HostOptions {
  std::string directory;  ///< make_ring_directory()'s
  std::string ring;
  std::uint8_t id = 0;
  std::string name;             ///< empty: this is not a node, but a whole ring
  unsigned max_clients = 32;    ///< limits.clients
  TurnKeeper* turns = nullptr;  ///< of a virtual clock; null: the machine's
};

/// The daemon's side of the host port: clients come and go, one of them may be the node's CPU.
/// Knows nothing of the ring; a HostHandler does.
class HostServer final : private SessionOwner {
 public:
  /// Beside limits.clients, for those who ask and go and for the CPU: programs that fill all places must not keep a
  /// stop from the node, nor its CPU.
  static constexpr unsigned kKeptPlaces = 8;
  /// If all places are taken, a client that observes nothing, has asked for nothing for so long, and waits for no
  /// answer makes room for the next one; and one of a process that holds more than half of them, for another process.
  static constexpr std::chrono::seconds kIdleFor{2};
  /// What clients say may take this time in one turn of the event loop, and at least one message of each is handled: a
  /// status takes 55 us, and packets wait meanwhile.
  static constexpr std::chrono::microseconds kTimePerTurn{200};

  /// Listens from here on; the caller holds the node's lock.
  /// @throw std::exception naming the path and what is wrong with it
  HostServer(boost::asio::io_context& io, HostOptions options, HostHandler& handler);
  ~HostServer() override;

  /// The attached CPU; nothing if there is none.
  const ClientInfo* cpu() const;
  /// The CPU is attached and has room for a packet.
  bool cpu_can_take() const;
  /// Hands a packet to the CPU, using one credit. @pre cpu_can_take()
  void give(const client::PacketView& packet);
  /// Tells the CPU. @return false, and counted, if there is none
  bool interrupt(const limb_ring::Interrupt& interrupt);

  /// The end of a call. Nothing happens if the client is gone.
  void result(ClientId client, const Result& result);
  void reply(ClientId client, std::uint32_t token, const std::string& json);
  /// Left out, counted and told to the client if it reads too slowly.
  void observed(ClientId client, const std::string& json);
  /// @return false if it was left out, and counted, since the client reads too slowly
  bool captured(ClientId client, const client::CapturedView& packet);
  void capture_counts(ClientId client, const CaptureCounts& counts);

  /// @name A runtime folder that was removed: see Listener. Clients stay connected.
  ///@{
  bool is_in_place() const { return listener_.is_in_place(); }
  void listen_again();
  ///@}

  /// Ends a client's connection; on_detach() follows from the event loop.
  void disconnect(ClientId client, const std::string& reason);
  /// The same for a CPU in lockstep that has greeted, and is not attached yet.
  void disconnect_booting_cpu(const std::string& reason);
  /// @name As if the process stood still: nobody is heard or answered, and nobody learns of it
  ///@{
  void freeze();
  /// What came meanwhile is taken.
  void thaw();
  ///@}
  /// Ends all, the handler is called no more.
  void close(const std::string& reason = "ringd has ended");

  const HostCounters& counters() const { return counters_; }

 private:
  using SessionPtr = std::shared_ptr<Session>;

  void accept();
  void accept_again_later(const boost::system::error_code& why);
  void admit(process::UniqueFd socket);
  bool make_room(pid_t comer, bool greeted);
  std::size_t attached_for_long() const;
  std::string full() const;
  SessionPtr make_session(process::UniqueFd socket, const ClientInfo& info);
  void on_message(Session& session, const client::ToDaemon& message) override;
  bool has_asked_enough() const override;
  /// Counts the time since `since` towards what clients may take in this turn.
  void count_time(std::chrono::steady_clock::time_point since);
  void on_end(Session& session, End end) override;
  void count(End end);
  void retire(Session& session);
  void tell_detached();
  void free_cpu_slots_of_the_dead();
  std::string whose() const;
  std::optional<std::string> objection(const client::Greeting& greeting, const ClientInfo& info);

  void on(Session& session, const client::Greeting& greeting);
  void attach_later(Session& session, const client::Greeting& greeting);
  void attach_now(const SessionPtr& session, const client::Greeting& greeting);
  /// @return false if it was refused
  bool attach(Session& session, const client::Greeting& greeting);
  bool is_in_lockstep(const client::Greeting& greeting) const;
  client::Welcome welcome(client::ClockKind clock) const;
  void on(Session& session, const client::SendRequest& request);
  void on(Session& session, const client::InterruptRequest& request);
  void on(Session& session, const client::PullRequest& request);
  void on(Session& session, const client::JsonRequest& request);
  void on(Session& session, const client::ObserveRequest& request);
  void on(Session& session, const client::Alive& alive);
  void on(Session& session, const client::Credit& credit);
  void on(Session& session, const client::Waiting& waiting);
  bool rejected(Session& session, std::uint32_t token, const std::optional<client::Problem>& problem);
  Session* find(ClientId client);

  boost::asio::io_context& io_;
  event_loop::PacketLoop& loop_;
  HostOptions options_;
  HostHandler& handler_;
  Listener listener_;
  boost::asio::steady_timer accept_timer_;
  std::map<ClientId, SessionPtr> sessions_;
  std::vector<SessionPtr> ended_;  ///< on_detach() still to be called, if they were attached
  SessionPtr cpu_;
  SessionPtr booting_cpu_;  ///< has greeted in lockstep, and is attached when its boot is over
  SessionPtr left_cpu_;     ///< was that one, and on_left() is still to be called
  ClientId last_id_ = 0;
  HostCounters counters_;
  std::uint64_t turn_ = 0;             ///< of the event loop, the last in which a client has said something
  std::chrono::nanoseconds taken_{0};  ///< by what clients have said in that turn
  bool short_ = false;                 ///< the last client that came could not be let in
  bool frozen_ = false;
  process::UniqueFd came_while_frozen_;  ///< the next ones wait in the kernel
  /// False once closed: what was posted before must not call the handler then.
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

/// Another daemon holds the node; what() says which.
struct NodeHeld : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Holds a node for one daemon: the lock file DIRECTORY/ID.lock. Its text says who the holder is, and how to
/// start it again once it is dead: its pid in a line, then, each ended by a null since paths may have line ends,
/// program, working folder and the arguments. Also has a shared BSD lock of the folder, as tmpfiles.d(5) asks for: then
/// systemd-tmpfiles leaves what is in there, however old it is.
class NodeLock {
 public:
  /// Waits for 200 ms if somebody holds it, who may be ending.
  /// @throw NodeHeld "node 3 (left_knee) of ring r is held by pid 4711 (ringd)"; std::system_error naming
  ///        the file and what is wrong with it
  NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name);

  /// False if its file was removed, so that another daemon can have one of its own.
  bool is_in_place() const { return file_.is_in_place(); }

 private:
  std::shared_ptr<process::UniqueFd> folder_;  ///< one for all nodes of this process
  process::LockFile file_;                     ///< stays when this daemon ends: it says how to start it again
};

}  // namespace limb_ring::host
