#pragma once

#include <array>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "core/network_controller.h"
#include "judge/promise.h"
#include "wire/packet.h"

namespace limb_ring::sim {

class Ledger;
struct Sent;

/// Sends that waited while another send of their node, which should go after them, went onto the line. They are judged
/// when that instant is over, since results of the same instant are told at its end. (protocol.md section 4.5)
class PassedOver {
 public:
  PassedOver(Ledger& ledger, const Complain& complain) : ledger_(ledger), complain_(complain) {}

  /// @param since when the other one began to leave
  void note(const Sent& waiting, const Sent& leaving, core::Time since);
  /// Judges what was noted in instants before `now`.
  void judge(core::Time now) {
    if (!noted_.empty()) judge_noted(now);
  }
  template <class Archive>
  void archive(Archive& a) {
    a("noted", noted_);
  }

 private:
  struct Noted {
    wire::NodeId source;
    std::uint32_t token;
    core::Time since;
    Promise promise;
    Words what;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("token", token)("since", since)("promise", promise)("what", what);
    }
  };
  void judge_noted(core::Time now);

  Ledger& ledger_;
  const Complain& complain_;
  std::vector<Noted> noted_;
};

/// Who owns what was asked for through a virtual ring.
constexpr core::Owner kAskedByRing = 0xFFFFFF04;

using core::Time;
using wire::NodeId;

/// One send as its CPU asked for it, and what became of it.
struct Sent {
  /// What a node it was sent to has decided.
  struct Decision {
    NodeId node;
    bool taken;  ///< or refused
    Time at;

    template <class Archive>
    void archive(Archive& a) {
      a("node", node)("taken", taken)("at", at);
    }
  };
  std::uint32_t token = 0;
  NodeId source{0}, destination{0};
  std::uint8_t queue = 0;    ///< priority 0..3; 4: an INTP
  std::uint8_t channel = 0;  ///< of an INTP its factor
  std::uint16_t size = 0;
  std::uint32_t checksum = 0;  ///< of the data
  std::uint32_t source_incarnation = 0;
  Time asked{};
  bool asked_in_ring = false;        ///< its node showed that users may send
  std::size_t ahead = 0;             ///< sends in its queue when it was asked for
  bool queue_shared = false;         ///< other owners may have sends in its queue, too
  bool left = false;                 ///< it was on the line
  unsigned tries = 0;                ///< tries of it that were seen on the line
  bool repeated = false;             ///< one of them was a retry
  unsigned attempts = 0;             ///< tries of its last packet
  bool may_have_failed = false;      ///< its last try may have come home damaged
  Time first_try{};                  ///< when the first byte of its last packet left; if that was not seen, asked
  Time last_try{};                   ///< when the first byte of its last try left
  Time home_at = core::kNever;       ///< when the last bit of that try was back
  int home_fbc = 0;                  ///< with this FBC
  bool final = false;                ///< a return that decides its outcome is in; the end may not be told yet
  Time cancelled_at = core::kNever;  ///< from then on it does not leave any more
  Time cancel_due = core::kNever;    ///< when it was cancelled while out or waiting
  Time first_refused = core::kNever;
  Time refused_at = core::kNever;    ///< when a refusal was in: it waits a while and goes again
  Time forgotten_at = core::kNever;  ///< when its source last heard that a receiver may have forgotten what it took
  bool ended = false;
  Time ended_at{};
  core::SendEnded end;
  bool in_doubt = false;            ///< whether it has come home cannot be told
  bool clock_stood = false;         ///< of its source, meanwhile: when it ended cannot be told, nor how long it took
  unsigned unread = 0;              ///< receive buffers in which it lies
  std::vector<Decision> decisions;  ///< in the order in which they were made
  std::size_t decided_from = 0;     ///< those before are on earlier packets of it, which were refused

  bool interrupt() const { return queue == 4; }
  /// As a new packet, not as a retry.
  bool may_leave(Time now) const { return now < cancelled_at && (!left || refused_at < now); }
  bool has_twin = false;      ///< another packet alike was under way with it: which came first cannot be told
  bool may_be_taken = false;  ///< somebody may have taken it; that cannot be told from outside

  bool taken() const;
  /// That node has taken or refused its last packet.
  bool decided_by(NodeId node) const;
  /// `packet`, which a CPU has got, is this send.
  bool is(const core::ReceivedPacket& packet) const;
  Words name() const;

  template <class Archive>
  void archive(Archive& a) {
    a("token", token)("source", source)("destination", destination)("queue", queue)("channel", channel)("size", size);
    a("checksum", checksum)("source_incarnation", source_incarnation)("asked", asked)("asked_in_ring", asked_in_ring);
    a("ahead", ahead)("queue_shared", queue_shared)("left", left)("tries", tries)("repeated", repeated);
    a("attempts", attempts)("may_have_failed", may_have_failed)("first_try", first_try)("last_try", last_try);
    a("home_at", home_at)("home_fbc", home_fbc)("final", final)("cancelled_at", cancelled_at)("cancel_due", cancel_due);
    a("first_refused", first_refused)("refused_at", refused_at)("forgotten_at", forgotten_at)("ended", ended)(
        "ended_at", ended_at)("end", end);
    a("in_doubt", in_doubt)("clock_stood", clock_stood)("unread", unread)("decisions", decisions)(
        "decided_from", decided_from)("has_twin", has_twin)("may_be_taken", may_be_taken);
  }
};

/// All sends of a ring, from the CPU's request to the CPU that reads them. Checks that their results, order
/// and contents are as promised. Packets are known on the line by (SID, kind, DID, sequence).
class Ledger {
 public:
  Ledger(unsigned nodes, bool fold_back, Complain complain);

  /// What can be seen of a packet that has left its source; the names are those of Sent.
  struct LeavingPacket {
    NodeId destination;
    std::uint8_t queue, channel;
    std::size_t size;
    std::uint32_t crc;       ///< as it was when it left its source
    std::uint32_t checksum;  ///< of its data
    bool matches(const Sent& sent) const {
      return sent.destination == destination && sent.queue == queue && sent.channel == channel && sent.size == size &&
             sent.checksum == checksum;
    }
  };

  /// @param in_ring its node shows that users may send
  void ask(NodeId source, const core::SendRequest& request, bool in_ring, Time now);
  void ask(NodeId source, const core::InterruptRequest& request, bool in_ring, Time now);
  /// The first byte of a try of `source` leaves it.
  void try_begins(NodeId source, wire::Code code, Time now);
  /// The DATP that has just left `source` is a hello or beacon, not a user's.
  void try_is_control(NodeId source) {
    sources_[source].outstanding[0].counted = sources_[source].outstanding[0].tries;
  }
  /// A packet of `source` has left it. @param since when its first byte did
  /// @return null if it was not asked for through the ring (another owner)
  Sent* depart(NodeId source, wire::Code code, const LeavingPacket& packet, Time since);
  /// What has come home to its source.
  struct Return {
    Sent* sent = nullptr;  ///< the send whose last try is home now, and was not before; null: none
    bool sure = true;      ///< false: its source may have given that try up
  };
  Return returned(NodeId source, wire::Code code, NodeId destination, std::uint32_t crc);
  /// A try of that kind is out, and has not come home.
  bool awaits(NodeId source, bool interrupt) const { return sources_[source].outstanding[interrupt ? 1 : 0].awaited; }
  /// A packet of `source` has come home damaged: its try has failed, and the next one may be under way already, or the
  /// send may have ended.
  void returned_damaged(NodeId source, bool interrupt);
  bool was_damaged(NodeId source, bool interrupt) const {
    return sources_[source].outstanding[interrupt ? 1 : 0].damaged;
  }
  /// `source` waits for none of its packets any more.
  void waits_for_nothing(NodeId source);
  /// Packets of that node are under way that were not asked for through the ring.
  bool others_send(NodeId source) const { return sources_[source].others_send; }
  /// The send of a packet that is somewhere on the ring; null if it is not known: of another owner, of
  /// before a restart, or no packet of that source at all. @param node at which it is
  Sent* on_line(NodeId source, wire::Code code, NodeId destination, std::uint32_t crc, NodeId node);
  /// It has come home and matched; its source knows at `at`. @param fbc below 0: nobody can tell
  void come_home(Sent* sent, int fbc, Time at);
  /// null if it is not known, or not needed any more.
  Sent* find(NodeId source, std::uint32_t token);
  /// Node `node` has refused it; take(): has taken it as this packet, or pulled its pin.
  void refuse(Sent* sent, NodeId node, Time at) {
    if (sent) sent->decisions.push_back({node, false, at});
  }
  void take(Sent* sent, const wire::PacketFields& packet, NodeId node, Time at);
  /// `node` starts over, and forgets what it decided before: what a line has doubled it may take again.
  void forgets(NodeId node, Time before) { forgotten_before_[node] = before; }
  /// `source` has heard that `receiver` may have forgotten what it took. (protocol.md section 4.10)
  void receiver_forgot(NodeId source, NodeId receiver, Time at);
  /// `node` has taken a packet that looks like this one.
  bool has_taken(const core::ReceivedPacket& packet, NodeId node) const;
  /// What `source` was asked for until now and has not begun to send is cancelled.
  void cancel(NodeId source, Time now);
  /// @return null if that is not judged further: of another owner, not known any more, or told twice
  const Sent* end(NodeId source, const core::SendEnded& end, Time at);
  /// `node` has restarted, with an empty memory: a copy that a line has held back it may take again.
  void start(NodeId node, Time now);
  /// The clock of `source` stood: its host was suspended.
  void clock_stood(NodeId source);
  /// A line has released what it held back: of earlier sends a second copy may be under way.
  void line_released(Time now) { released_ = now; }
  /// Judges what could not be judged in its own instant.
  void settle(Time now) { passed_over_.judge(now); }
  /// All sends that a node was asked for since it started and that have not ended.
  template <class Visit>
  void each_open(NodeId source, Visit visit) const {
    for (const Sent& sent : sources_[source].sent)
      if (!sent.ended && sent.source_incarnation == sources_[source].incarnation) visit(sent);
  }

  /// All that later events are judged by, for study/exploration.h; the same in the classes below.
  template <class Archive>
  void archive(Archive& a) {
    a("sources", sources_)("forgotten_before", forgotten_before_)("started", started_)("passed_over", passed_over_);
    a("newest", newest_)("released", released_);
  }

 private:
  /// The packet of one kind that a source has sent last, as far as its header tells.
  struct Outstanding {
    int packet = -1;          ///< its Code without the try; -1: nothing yet
    unsigned tries = 0;       ///< tries of it that were seen
    unsigned counted = 0;     ///< how many of those are counted for its send
    std::uint32_t token = 0;  ///< of that send; 0: not known, as before the packet's end is out
    Time since{};             ///< when its last try began
    std::uint8_t attempt = 0;
    unsigned before = 0;   ///< tries of the packet before it, if that was never known
    bool awaited = false;  ///< outstanding: it is not home yet
    bool damaged = false;  ///< a packet of this kind came home damaged since its last try

    /// Tries of a packet of which it is not known which send it is.
    unsigned unknown() const { return token == 0 ? tries - counted : 0; }
    template <class Archive>
    void archive(Archive& a) {
      a("packet", packet)("tries", tries)("counted", counted)("token", token)("since", since)("attempt", attempt);
      a("before", before)("awaited", awaited)("damaged", damaged);
    }
  };
  /// A packet with that kind, DID and sequence number.
  struct OnLine {
    std::uint32_t token = 0;
    std::array<std::uint32_t, 4> crcs{};  ///< by try

    template <class Archive>
    void archive(Archive& a) {
      a("token", token)("crcs", crcs);
    }
  };
  /// The last packets with one kind, DID and sequence number: a line may release one that it held back so long that
  /// its number has been used again.
  struct Slot {
    OnLine last;
    std::vector<OnLine> former;
    bool begun = false;  ///< some packet has had this number
    void begin(std::uint32_t token);

    template <class Archive>
    void archive(Archive& a) {
      a("last", last)("former", former);
    }
  };
  struct Source {
    std::deque<Sent> sent;
    std::uint32_t first_token = 1;
    std::array<std::deque<std::uint32_t>, 5> waiting;  ///< by queue, in the order of asking
    std::map<unsigned, Slot> on_line;                  ///< by kind, DID, sequence
    std::array<Outstanding, 2> outstanding;            ///< DATP, INTP
    bool others_send = false;                          ///< packets left that were not asked for through the ring
    std::uint32_t incarnation = 0;

    template <class Archive>
    void archive(Archive& a) {
      a("sent", sent)("first_token", first_token)("waiting", waiting)("outstanding", outstanding);
      a("others_send", others_send)("incarnation", incarnation);
      for (auto& [place, slot] : on_line) {
        unsigned key = place;
        if (slot.begun) a("place", key)("slot", slot);
      }
    }
  };

  Sent& add(NodeId source, std::uint32_t token, std::uint8_t queue, bool in_ring, Time now);
  Slot& on_line_slot(NodeId source, wire::Code code, NodeId destination);
  void count_tries(Sent& sent, wire::Code code);
  void note_passed_over(const Sent& leaving, Time since);
  /// A line has held something back since, so a second copy of it may have been under way.
  bool may_have_copy(const Sent& sent) const { return sent.asked <= released_; }
  void check_result(const Sent& sent);
  void check_measures(const Sent& sent);
  void check_order(const Sent& sent, NodeId node);
  void forget_settled(Source& source);

  Complain complain_;
  bool fold_back_;
  std::vector<Source> sources_;
  std::vector<Time> forgotten_before_;  ///< by node
  std::vector<Time> started_;           ///< by node
  PassedOver passed_over_;
  std::vector<std::uint32_t> newest_;  ///< token, by node, source, queue
  Time released_{core::Duration{-1}};  ///< when a line last did
};

}  // namespace limb_ring::sim
