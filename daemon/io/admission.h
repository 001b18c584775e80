#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/link_header.h"
#include "io/unix_line.h"
#include "io/unix_listener.h"

namespace limb_ring::link {

/// Why a node that asked to connect was refused, other than for being farther away; for people. "It" is that node.
std::string why_unfit(const LinkHeader& connect, const LinkHeader& refuse);

/// Who may be our upstream neighbour (ours, protocol.md section 6.8): the nearest living node in ring order. So a node
/// that is at least as near as the present neighbour takes its place; the same id again is a restart.
class Admission {
 public:
  /// @param order all node ids in ring order, `self.id` among them
  /// @param names of the nodes, in the same order; for messages, may be empty
  Admission(Identity self, std::vector<std::uint8_t> order, std::vector<std::string> names = {});

  /// @param present the upstream neighbour we have and still hear, if any
  /// @return Refusal::none if the sender of `connect` may come in
  Refusal judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const;
  /// The same for a node that has also told what it expects of our ring file (`theirs`).
  /// @return the `refuse` header to be answered; nothing if it may come in
  std::optional<LinkHeader> judge(const LinkHeader& connect, const Agreement& theirs,
                                  std::optional<std::uint8_t> present) const;

  /// A header of ours.
  LinkHeader header(LinkHeaderType type, Refusal refusal = Refusal::none) const;
  /// For people: "node 3 (neck)".
  std::string label(std::uint8_t node) const;

 private:
  /// Nodes between `from` and us, going upstream: 1 is our neighbour, we ourselves are the
  /// farthest. 0: no node of the ring.
  std::size_t distance(std::uint8_t from) const;

  Identity self_;
  std::vector<std::uint8_t> order_;
  std::vector<std::string> names_;
};

/// A pending connection: it has not yet said who it is. It has a buffer of one `connect` and a deadline, and becomes
/// the input only when it is admitted.
class PendingConnection : public std::enable_shared_from_this<PendingConnection> {
 public:
  struct Owner {
    virtual void on_greeted(const std::shared_ptr<PendingConnection>& connection, const LinkHeader& connect,
                            const Agreement& theirs) = 0;
    virtual void on_unknown_peer(const std::shared_ptr<PendingConnection>& connection, std::string_view why) = 0;

   protected:
    ~Owner() = default;
  };

  PendingConnection(event_loop::UnixSocket socket, Owner& owner, Time now)
      : socket_(std::move(socket)), owner_(&owner), since_(now) {}

  void start() { wait(); }
  void read();
  void close();
  bool open() const { return owner_ != nullptr; }
  Time since() const { return since_; }
  /// True if the other end has closed meanwhile: a node that was frozen finds attempts that others gave up long ago.
  bool hung_up();
  void answer(const LinkHeader& header);
  /// What came with its header: for a line through shared memory, the memory and the pipe.
  std::vector<process::UniqueFd>& descriptors() { return descriptors_; }
  /// Hands the socket over; the connection is closed then.
  process::UniqueFd release();

 private:
  void wait();
  /// A whole header is there. @return false: nothing more is wanted of this connection
  bool take_header();

  event_loop::UnixSocket socket_;
  Owner* owner_;
  Time since_;
  std::array<std::uint8_t, kConnectSize> bytes_{};
  std::size_t wanted_ = kLinkHeaderSize;
  std::size_t size_ = 0;
  LinkHeader header_;
  std::vector<process::UniqueFd> descriptors_;
};

}  // namespace limb_ring::link
