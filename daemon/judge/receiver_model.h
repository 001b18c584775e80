#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/settings.h"
#include "judge/ledger.h"
#include "wire/control_message.h"

namespace limb_ring::sim {

using core::Time;
using wire::NodeId;

/// Yes, no, or not to be told from outside.
enum class Tristate : std::uint8_t { no, yes, unknown };

/// What a receiver has to answer to each packet that comes in: the rules of protocol.md sections 2.3, 4.8 and 4.10
/// written a second time, small and slow, for judging the core. It knows what has come in on the node's line, and
/// nothing that the core says of itself but its state.
class ReceiverModel {
 public:
  enum class Answer : std::uint8_t {
    none,             ///< FBC stays as it is
    control,          ///< a hello or beacon: taken
    takes,            ///< into a receive buffer; pulls the pin
    refuses,          ///< also if the packet is of an earlier incarnation
    repeats_taken,    ///< decided before
    repeats_refused,  ///< decided before
    unknown           ///< nobody can tell from outside
  };

  explicit ReceiverModel(const core::Settings& settings);

  /// A packet with a good CRC has come in. @param has_buffer one of its priority is free
  /// @param received it reached Receive; unknown: neither what becomes of it nor what depends on that is judged
  Answer data(const wire::PacketFields& packet, Tristate received, Tristate has_buffer, Time at);
  Answer interrupt(const wire::PacketFields& packet, Tristate received, Time at);

  /// False for sure if a hello or beacon that has come in now does not say that its source has forgotten what it took.
  /// Before data(). @param received as there
  bool may_tell_of_forgetting(const wire::PacketFields& packet, Tristate received) const;
  /// The node says hello with that boot number, and begins a new page for packets to itself.
  void says_hello(std::uint64_t boot);
  /// Its hello is home, or has left into an open chain: users' DATPs are taken.
  void join() { joined_ = Tristate::yes; }
  void set_joined(Tristate joined) { joined_ = joined; }
  Tristate joined() const { return joined_; }
  /// Its hello, or a beacon with its boot number, has come home since it started. @param sure or perhaps
  void announce(bool sure, Time at);
  /// The node's input is lost, or another one.
  void input_changes(Time now);
  /// It starts over, since it was bypassed. @param crossed perhaps before its input changed in this instant, not by
  /// that
  void start_over(bool crossed, Time now);
  /// Perhaps it starts over: it was bypassed, or only its hello was lost and a line is down.
  void may_start_over();
  /// Another node has its id: it begins a new incarnation.
  void begin_incarnation();
  void set_cpu_present(bool present) { cpu_present_ = present; }
  bool cpu_present() const { return cpu_present_; }
  template <class Archive>
  void archive(Archive& a) {
    a("pages", pages_)("joined", joined_)("announced", announced_)("perhaps_announced", perhaps_announced_)(
        "cpu_present", cpu_present_);
  }

 private:
  enum class Decision : std::uint8_t { none, taken, refused, unknown };
  struct Entry {
    Time decided{};
    std::uint8_t sequence = 0;
    Decision decision = Decision::none;
    bool aged = false;                ///< a first try is new
    bool any_sequence = false;        ///< nobody knows which number was decided last
    Time left_behind = core::kNever;  ///< when the input changed on which it was decided
    bool in_doubt = false;            ///< decided before the node started over

    template <class Archive>
    void archive(Archive& a) {
      a("decided", decided)("sequence", sequence)("decision", decision)("aged", aged)("any_sequence", any_sequence);
      a("left_behind", left_behind)("in_doubt", in_doubt);
    }
  };
  struct Page {
    std::array<Entry, 4> entries{};
    std::uint64_t boot = 0;  ///< of the last hello or beacon
    std::uint8_t incarnation = 0;
    bool known = false;
    bool from_packet = false;            ///< begun by a packet, not by a hello or beacon
    Tristate peer_known = Tristate::no;  ///< a hello or beacon was heard
    bool any_incarnation = false;        ///< nobody knows which one it has met last

    template <class Archive>
    void archive(Archive& a) {
      a("entries", entries)("boot", boot)("incarnation", incarnation)("known", known)("from_packet", from_packet);
      a("peer_known", peer_known)("any_incarnation", any_incarnation);
    }
  };

  Entry& entry(const wire::PacketFields& packet);
  bool addressed(const wire::PacketFields& packet) const;
  Tristate is_unknown_peers_retry(const wire::PacketFields& packet) const;
  std::optional<Answer> of_unaware_peers_retry(const wire::PacketFields& packet, Time at);
  bool hear(const wire::PacketFields& packet, Time at);
  template <class Forget>
  bool hear_boot(NodeId source, std::uint64_t boot, Forget forget);
  bool meet(const wire::PacketFields& packet);
  std::optional<Answer> of_known(const Entry& entry, const wire::PacketFields& packet, Time at) const;
  void decide(Entry& entry, const wire::PacketFields& packet, Answer answer, Time at);
  void doubt(const wire::PacketFields& packet);
  bool is_old(const Entry& entry, Time now) const;
  void age(Page& page, Time now) const;
  template <class Change>
  void each_entry(Change change);

  NodeId id_;
  bool falls_into_parts_;
  std::array<bool, 8> wired_;
  core::Duration horizon_;  ///< a number decided longer ago is new
  std::vector<Page> pages_;
  Tristate joined_ = Tristate::no;
  Time announced_ = core::kNever, perhaps_announced_ = core::kNever;  ///< since when
  bool cpu_present_ = true;
};

/// What lies in the receive buffers of one node, as far as can be told from outside. Checks that its CPU gets that, the
/// highest priority first and in order within one. (protocol.md section 2.3)
class ReceiveBuffers {
 public:
  ReceiveBuffers(NodeId node, Ledger& ledger, const Complain& complain)
      : node_(node), ledger_(ledger), complain_(complain) {}

  /// A packet was taken. @param sent null: not asked for through the ring. @param at its last bit was in
  /// @param sure false: perhaps it was not taken
  void put(Sent* sent, NodeId source, std::uint8_t priority, Time at, bool sure);
  /// Packets of that priority in it, at least and at most.
  std::size_t least(std::uint8_t priority) const { return unread_[priority].size() - doubtful_[priority]; }
  std::size_t most(std::uint8_t priority) const { return unread_[priority].size(); }
  /// The CPU reads one.
  void read(const core::ReceivedPacket& packet, Time now);
  /// The CPU was reset, or the node restarted: all of it is gone.
  void flush();
  /// What is in later than `from` is in so much later.
  void put_off(Time from, core::Duration by) {
    for (auto& unread : unread_)
      for (Unread& one : unread)
        if (one.at > from) one.at += by;
  }
  template <class Archive>
  void archive(Archive& a) {
    a("unread", unread_)("doubtful", doubtful_);
  }

 private:
  struct Unread {
    NodeId source;
    std::uint32_t token;  ///< 0: not asked for through the ring
    Time at;
    bool sure;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("token", token)("at", at)("sure", sure);
    }
  };
  void check_priority(const core::ReceivedPacket& packet, Time now) const;
  void drop_front(std::uint8_t priority);
  bool may_be(const Unread& unread, const core::ReceivedPacket& packet) const;
  void never_took(const core::ReceivedPacket& packet) const;

  NodeId node_;
  Ledger& ledger_;
  const Complain& complain_;
  std::array<std::deque<Unread>, 4> unread_;  ///< by priority
  std::array<std::size_t, 4> doubtful_{};     ///< of them
};

}  // namespace limb_ring::sim
