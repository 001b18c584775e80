#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstring>
#include <optional>

#include "core/counters.h"
#include "core/membership/membership.h"
#include "core/packet_manager/packet_manager.h"
#include "core/receive/receive.h"
#include "core/settings.h"
#include "core/time.h"
#include "core/transmit/transmit.h"
#include "wire/packet.h"
#include "wire/slice.h"

namespace limb_ring::core {

/// Own packets that have come home. The return is the acknowledgement (paper). Its HOP says how many nodes the ring
/// has. A packet that this node never sent is a sign of a duplicate id. (ours, protocol.md sections 4.2, 4.7 and 8.6)
class Returns {
 public:
  Returns(const Settings& settings, Transmit& transmit, Membership& membership, Receive& receive, Pins& pins,
          Counters& counters)
      : settings_(settings),
        transmit_(transmit),
        membership_(membership),
        receive_(receive),
        pins_(pins),
        counters_(counters) {}

  /// @param good its CRC and trailer are right
  void data(const wire::PacketFields& packet, bool good, Time at);
  void interrupt(const wire::PacketFields& packet, bool good, Time at);
  /// A DATP came home, but not as a whole.
  void broken_off(Time now) { damaged(transmit_.data, now); }

 private:
  void damaged(SendUnit& unit, Time at);
  template <class Block>
  std::uint8_t fbc_of(const wire::PacketFields& packet, const SendUnit& unit, Block& block, Time at);
  bool match(SendUnit& unit, const wire::PacketFields& packet, std::uint8_t fbc, Time at);

  const Settings& settings_;
  Transmit& transmit_;
  Membership& membership_;
  Receive& receive_;
  Pins& pins_;
  Counters& counters_;
};

/// The DATP that is coming in slice by slice. Receive needs it whole, since DID and CRC come last (ours). If Relay
/// passes it on, its bytes lie in its slot of the insertion buffer, so that they are copied only once.
class Incoming {
 public:
  bool open() const { return open_; }
  Time last_slice() const { return last_slice_; }
  /// Its bytes, with the HOP that it came with: in place, HOP may have been counted up already for the next node.
  wire::ByteView bytes() {
    place_[wire::field::kHop] = hop_;
    return {place_, size_};
  }

  /// @param place room for the largest DATP, valid until close(); null: use a buffer of its own
  void begin(wire::ByteView bytes, Time now, std::uint8_t* place) {
    open_ = true;
    size_ = 0;
    hop_ = bytes[wire::field::kHop];
    place_ = place ? place : own_.data();
    append(bytes, now, wire::kMaxDataPacketSize);
  }
  /// @param most bytes that it may have with these
  /// @return false if it would have more; nothing is added then
  bool append(wire::ByteView bytes, Time now, std::size_t most) {
    if (size_ + bytes.size > most) return false;
    std::memcpy(place_ + size_, bytes.data, bytes.size);
    size_ += bytes.size;
    last_slice_ = now;
    return true;
  }
  void close() { open_ = false; }
  /// Where its bytes lie; the largest DATP has room there.
  std::uint8_t* place() { return place_; }

  /// archive.h
  /// @param place where its bytes lie if it is passed on (PacketManager::receiving_place()); or null
  template <class Archive>
  void archive(Archive& a, std::uint8_t* place) {
    bool is_own = !open_ || place_ == own_.data() || place == nullptr;
    a("open", open_)("hop", hop_)("last_slice", last_slice_)("size", size_)("is_own", is_own);
    move_to(is_own || place == nullptr ? own_.data() : place);
    Bytes bytes{place_, open_ ? size_ : 0};
    a("bytes", bytes);
  }

 private:
  /// If the output was lost, the packet is not passed on any more, but its bytes still lie in its slot: moves them.
  void move_to(std::uint8_t* place) {
    if (open_ && place != place_) std::memcpy(place, place_, std::min(size_, wire::kMaxDataPacketSize));
    place_ = place;
  }
  /// The bytes that have come in, wherever they lie.
  struct Bytes {
    std::uint8_t* at;
    std::size_t size;
    template <class Archive>
    void archive(Archive& a) {
      for (std::size_t i = 0; i < std::min(size, wire::kMaxDataPacketSize); ++i) a("", at[i]);
    }
  };
  bool open_ = false;
  std::uint8_t hop_ = 0;
  Time last_slice_{};
  std::size_t size_ = 0;
  std::uint8_t* place_ = own_.data();
  std::array<std::uint8_t, wire::kMaxDataPacketSize> own_{};
};

/// Relay: passes every incoming packet on with HOP + 1, and discards a packet whose SID is its own. (paper) It puts
/// the slices of a packet together, judges it as soon as its header is in, and sets HOP, FBC and CRC of what it passes
/// on. Receive and the pins work on the same input (paper) and determine the FBC. How it treats orphans, whose source
/// can no longer discard them, is ours (protocol.md sections 2.2 and 4.9).
class Relay {
 public:
  Relay(const Settings& settings, PacketManager& packet_manager, Receive& receive, Pins& pins, Returns& returns,
        Counters& counters)
      : settings_(settings),
        packet_manager_(packet_manager),
        receive_(receive),
        pins_(pins),
        returns_(returns),
        counters_(counters),
        stall_(settings.stall + 2 * settings.byte_time_in * 1024) {}

  /// What a slice has changed in the node.
  struct Effect {
    bool own = true;       ///< perhaps also something of Transmit, Receive, pins or membership
    bool on_line = false;  ///< what came went straight on to the line
  };
  /// One slice from upstream.
  Effect receive(const wire::Slice& slice, Time now);
  /// Something was lost on the input: a DATP that is coming in will never be whole.
  void input_gap(Time now) { break_off(counters_.broken_off_packets, now); }

  /// The output now leads to `successor`: nodes between it and this one are bypassed.
  void set_successor(NodeId successor) {
    if (successor_ == successor) return;  // asked with every slice if the ring folds back
    successor_ = successor;
    bypassed_ = between(settings_.id, successor);
  }
  /// What comes in was turned back at `node`; nothing: the input is the first line. Nodes between `node` and this one
  /// are beyond the break: packets of theirs that still come have passed here already, before the line broke. (ours,
  /// protocol.md section 4.9)
  void set_turned_back_at(std::optional<NodeId> node) {
    if (turned_back_at_ == node) return;
    turned_back_at_ = node;
    cut_off_ = node ? between(*node, settings_.id) : std::bitset<256>{};
  }

  void handle_timeout(Time now) {
    if (deadline() <= now) break_off(counters_.stalled_packets, now);
  }
  /// The DATP that is coming in is given up then.
  Time deadline() const { return incoming_.open() ? incoming_.last_slice() + stall_ : kNever; }
  /// archive.h; the Packet Manager comes before it
  template <class Archive>
  void archive(Archive& a) {
    incoming_.archive(a, packet_manager_.receiving_place());
    a("fate", fate_)("successor", successor_)("turned_back_at", turned_back_at_)("bypassed", bypassed_)("cut_off",
                                                                                                        cut_off_);
  }

 private:
  enum class Fate : std::uint8_t {
    pass_on,
    strip,         ///< own: it has come home
    receive_only,  ///< its source is bypassed by this node's output: taken, then discarded
    discard        ///< an orphan by its HOP or beyond a break, or no packet at all
  };

  Fate judge(wire::ByteView header, bool interrupt);
  Fate judge_data(wire::ByteView header);
  bool check(const wire::PacketFields& packet, bool crc_good);

  void on_interrupt(wire::ByteView bytes, Time now);
  Effect on_whole(const wire::Slice& slice, Time now);
  Effect on_start(wire::ByteView bytes, Time now);
  Effect on_more(wire::ByteView bytes, Time now);
  Effect on_end(wire::ByteView bytes, Time now);
  bool append(wire::ByteView bytes, Time now, std::size_t most);
  /// @return true if that was an own packet
  bool break_off(std::uint64_t& counter, Time now);
  std::bitset<256> between(NodeId before, NodeId behind) const;

  const Settings& settings_;
  PacketManager& packet_manager_;
  Receive& receive_;
  Pins& pins_;
  Returns& returns_;
  Counters& counters_;
  const Duration stall_;       ///< the longest pause between two slices of a DATP
  Fate fate_ = Fate::discard;  ///< of what is coming in
  std::optional<NodeId> successor_, turned_back_at_;
  std::bitset<256> bypassed_;  ///< by the output, up to successor_
  std::bitset<256> cut_off_;   ///< by the fold, from turned_back_at_
  Incoming incoming_;
};

}  // namespace limb_ring::core
