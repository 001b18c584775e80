#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "client/frame.h"
#include "limb_ring/host_port.h"
#include "wire/packet_assembler.h"

namespace limb_ring::client {

/// The messages of a host port, both ways; shared by the client library and the daemon. Texts and
/// data of a decoded message point into the frame it was read from.

/// Changes whenever a message changes: both sides come from one build as a rule.
constexpr std::uint16_t kHostPortVersion = 3;
/// Follows a frame's size and type: no other protocol is likely to begin so.
constexpr std::uint32_t kGreetingMagic = 0x4C524850;  // "LRHP"

/// The first message of a client.  | magic 32 | version 16 | role 8 | flags 8 | pid 32 |
/// alive period 32, ms | ring, text |
struct Greeting {
  std::uint16_t version = kHostPortVersion;
  Role role = Role::tool;
  bool restarted_by_owner = false;
  bool results_may_wait = false;
  bool lockstep = false;   ///< a virtual clock is to wait for it
  bool asks_only = false;  ///< it needs no place for long
  std::uint32_t pid = 0;   ///< informative; the daemon goes by what the kernel says
  std::chrono::milliseconds alive_period{0};
  std::string_view ring;
};

/// | token 32 | destination 8 | priority 8 | channel 8 | data |
struct SendRequest {
  std::uint32_t token = 0;
  std::uint8_t destination = 0;
  std::uint8_t priority = 0;
  std::uint8_t channel = 0;
  wire::ByteView data;
};

/// | token 32 | destination 8 | factor 8 | force 8 |
struct InterruptRequest {
  std::uint32_t token = 0;
  std::uint8_t destination = 0;
  std::uint8_t factor = 0;
  bool force = false;
};

/// | token 32 | input 8 |
struct PullRequest {
  std::uint32_t token = 0;
  std::uint8_t input = 0;
};

/// | token 32 | JSON |
struct JsonRequest {
  std::uint32_t token = 0;
  std::string_view json;
};

/// | JSON |
struct ObserveRequest {
  std::string_view json;
};

/// Empty.
struct Alive {};

/// | count 16 |  The CPU has room for so many packets more.
struct Credit {
  std::uint16_t count = 0;
};

/// | time 64, ns |  A client in lockstep ends its turn: all that it sends in it has been sent, and it does nothing more
/// until that time of the ring's clock, or until something has come for it.
struct Waiting {
  std::chrono::nanoseconds until{0};
};

using ToDaemon = std::variant<Greeting, SendRequest, InterruptRequest, PullRequest, JsonRequest, ObserveRequest, Alive,
                              Credit, Waiting>;

/// Which clock a node goes by.
enum class ClockKind : std::uint8_t {
  machine,
  ring,     ///< a virtual ring's, which does not wait for this client
  lockstep  ///< ... which does: the client acts in its turns alone, and is sent something at their beginning alone
};

/// Answer to a greeting.  | id 8 | name, text | ring, text | clock 8 |
struct Welcome {
  std::uint8_t id = 0;
  std::string_view name;
  std::string_view ring;
  ClockKind clock = ClockKind::machine;
};

/// | time 64, ns |  It is the turn of a client in lockstep, and that time of the ring's clock: all that is for it by
/// now has been sent.
struct Turn {
  std::chrono::nanoseconds now{0};
};

/// The daemon closes the connection.  | reason |
struct Refused {
  std::string_view reason;
};

/// A Packet whose data belongs to someone else.
/// | source 8 | destination 8 | priority 8 | channel 8 | data, 1 to 512 bytes |
struct PacketView {
  std::uint8_t source = 0;
  std::uint8_t destination = 0;
  std::uint8_t priority = 0;
  std::uint8_t channel = 0;
  wire::ByteView data;
};

/// A limb_ring::CapturedPacket whose bytes belong to someone else.
/// | time 64, ns | steady 64, ns | lost before 32 | pseudo-header (wire/pcapng.h) | bytes |
struct CapturedView {
  std::int64_t time_ns = 0;
  std::uint32_t lost_before = 0;
  capture::PacketView packet;  ///< `at` by CLOCK_MONOTONIC
};

/// limb_ring::Interrupt     | action 8 | source 8 | factor 8 |
/// limb_ring::Result        | token 32 | outcome 8 | tries 16 | round trip 64, ns | why 8 | reason |
/// limb_ring::Reply         | token 32 | JSON |
/// limb_ring::Observed      | JSON |
/// limb_ring::ObservedLost  | count 64 |
/// limb_ring::CaptureCounts | seen 64 | filtered 64 | sampled out 64 | limited 64 | lost 64 | given 64 |
using ToClient = std::variant<Welcome, Refused, PacketView, limb_ring::Interrupt, limb_ring::Result, limb_ring::Reply,
                              limb_ring::Observed, limb_ring::ObservedLost, limb_ring::CapturedPacket,
                              limb_ring::CaptureCounts, Turn>;

void append(Bytes& out, const Greeting& message);
void append(Bytes& out, const SendRequest& message);
void append(Bytes& out, const InterruptRequest& message);
void append(Bytes& out, const PullRequest& message);
void append(Bytes& out, const JsonRequest& message);
void append(Bytes& out, const ObserveRequest& message);
void append(Bytes& out, const Alive& message);
void append(Bytes& out, const Credit& message);
void append(Bytes& out, const Waiting& message);

void append(Bytes& out, const Welcome& message);
void append(Bytes& out, const Refused& message);
void append(Bytes& out, const PacketView& message);
void append(Bytes& out, const limb_ring::Interrupt& message);
void append(Bytes& out, const limb_ring::Result& message);
void append(Bytes& out, const limb_ring::Reply& message);
void append(Bytes& out, const limb_ring::Observed& message);
void append(Bytes& out, const limb_ring::ObservedLost& message);
void append(Bytes& out, const CapturedView& message);
void append(Bytes& out, const limb_ring::CaptureCounts& message);
void append(Bytes& out, const Turn& message);

/// Nothing if no message of that direction is such a frame: it is too short, too long, or holds a value that its field
/// may not have; or, for a client, JSON that is nested too deep. JSON for the daemon, destinations, priorities
/// and sizes of a SendRequest are not judged here: they deserve an answer with a reason (arguments.h).
std::optional<ToDaemon> decode_to_daemon(const Frame& frame);
std::optional<ToClient> decode_to_client(const Frame& frame);

}  // namespace limb_ring::client
