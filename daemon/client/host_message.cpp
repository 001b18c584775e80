#include "client/host_message.h"

#include <algorithm>

#include "client/arguments.h"
#include "wire/packet.h"
#include "wire/pcapng.h"

namespace limb_ring::client {
namespace {

enum ToClientType : std::uint8_t {
  kWelcome = 0x81,
  kRefused,
  kPacket,
  kInterrupt,
  kResult,
  kReply,
  kObserved,
  kObservedLost,
  kCaptured,
  kCaptureCounts,
  kTurn
};

/// In the order of the message.
constexpr std::uint64_t limb_ring::CaptureCounts::*kCounts[] = {
    &limb_ring::CaptureCounts::seen,    &limb_ring::CaptureCounts::filtered, &limb_ring::CaptureCounts::sampled_out,
    &limb_ring::CaptureCounts::limited, &limb_ring::CaptureCounts::lost,     &limb_ring::CaptureCounts::given};

std::optional<ToClient> read_welcome(FieldReader reader) {
  Welcome message;
  message.id = reader.u8();
  message.name = reader.text();
  message.ring = reader.text();
  const std::uint8_t clock = reader.u8();
  message.clock = static_cast<ClockKind>(clock);
  if (!reader.complete() || clock > static_cast<std::uint8_t>(ClockKind::lockstep)) return std::nullopt;
  return message;
}

std::optional<ToClient> read_packet(FieldReader reader) {
  PacketView message;
  message.source = reader.u8();
  message.destination = reader.u8();
  message.priority = reader.u8();
  message.channel = reader.u8();
  message.data = reader.rest();
  const bool size_fits = !message.data.empty() && message.data.size <= kMaxPayload;
  if (!reader.complete() || !size_fits || message.priority >= wire::kPriorities) return std::nullopt;
  return message;
}

std::optional<ToClient> read_interrupt(FieldReader reader) {
  limb_ring::Interrupt message;
  const std::uint8_t action = reader.u8();
  message.action = static_cast<limb_ring::Interrupt::Action>(action);
  message.source = reader.u8();
  message.factor = reader.u8();
  const bool known = action <= static_cast<std::uint8_t>(limb_ring::Interrupt::Action::stop);
  if (!reader.complete() || !known || message.factor >= wire::kFactors) return std::nullopt;
  return message;
}

std::optional<ToClient> read_result(FieldReader reader) {
  limb_ring::Result message;
  message.token = reader.u32();
  const std::uint8_t outcome = reader.u8();
  message.outcome = static_cast<Outcome>(outcome);
  message.tries = reader.u16();
  message.round_trip = std::chrono::nanoseconds{static_cast<std::int64_t>(reader.u64())};
  const std::uint8_t why = reader.u8();
  message.why = static_cast<Reason>(why);
  message.reason = std::string(reader.rest_text());
  const bool known =
      outcome <= static_cast<std::uint8_t>(Outcome::cancelled) && why <= static_cast<std::uint8_t>(kLastReason);
  if (!reader.complete() || !known) return std::nullopt;
  return message;
}

std::optional<ToClient> read_reply(FieldReader reader) {
  limb_ring::Reply message;
  message.token = reader.u32();
  message.json = std::string(reader.rest_text());
  if (!reader.complete() || json_problem(message.json)) return std::nullopt;
  return message;
}

std::optional<ToClient> read_observed(FieldReader reader) {
  limb_ring::Observed message{std::string(reader.rest_text())};
  if (json_problem(message.json)) return std::nullopt;
  return message;
}

std::optional<ToClient> read_observed_lost(FieldReader reader) {
  const limb_ring::ObservedLost message{reader.u64()};
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToClient> read_captured(FieldReader reader) {
  limb_ring::CapturedPacket message;
  message.time_ns = static_cast<std::int64_t>(reader.u64());
  message.steady_ns = static_cast<std::int64_t>(reader.u64());
  message.lost_before = reader.u32();
  const wire::ByteView rest = reader.rest();
  if (rest.size < capture::kPseudoHeaderSize + wire::kHeaderSize) return std::nullopt;
  if (!capture::decode(rest, message.info)) return std::nullopt;
  const wire::ByteView bytes = rest.from(capture::kPseudoHeaderSize);
  message.bytes.assign(bytes.begin(), bytes.end());
  return message;
}

std::optional<ToClient> read_capture_counts(FieldReader reader) {
  limb_ring::CaptureCounts message;
  for (const auto count : kCounts) message.*count = reader.u64();
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToClient> read_turn(FieldReader reader) {
  const Turn message{std::chrono::nanoseconds{static_cast<std::int64_t>(reader.u64())}};
  if (!reader.complete()) return std::nullopt;
  return message;
}

}  // namespace

void append(Bytes& out, const Welcome& message) {
  FrameWriter(out, kWelcome)
      .u8(message.id)
      .text(message.name)
      .text(message.ring)
      .u8(static_cast<std::uint8_t>(message.clock));
}

void append(Bytes& out, const Refused& message) { FrameWriter(out, kRefused).rest(message.reason); }

void append(Bytes& out, const PacketView& message) {
  FrameWriter(out, kPacket)
      .u8(message.source)
      .u8(message.destination)
      .u8(message.priority)
      .u8(message.channel)
      .rest(message.data);
}

void append(Bytes& out, const limb_ring::Interrupt& message) {
  FrameWriter(out, kInterrupt).u8(static_cast<std::uint8_t>(message.action)).u8(message.source).u8(message.factor);
}

void append(Bytes& out, const limb_ring::Result& message) {
  FrameWriter(out, kResult)
      .u32(message.token)
      .u8(static_cast<std::uint8_t>(message.outcome))
      .u16(static_cast<std::uint16_t>(std::min(message.tries, 0xFFFFu)))
      .u64(static_cast<std::uint64_t>(message.round_trip.count()))
      .u8(static_cast<std::uint8_t>(message.why))
      .rest(message.reason);
}

void append(Bytes& out, const limb_ring::Reply& message) {
  FrameWriter(out, kReply).u32(message.token).rest(message.json);
}

void append(Bytes& out, const limb_ring::Observed& message) { FrameWriter(out, kObserved).rest(message.json); }

void append(Bytes& out, const limb_ring::ObservedLost& message) { FrameWriter(out, kObservedLost).u64(message.count); }

void append(Bytes& out, const CapturedView& message) {
  const capture::PseudoHeader header = capture::encode(message.packet.info);
  FrameWriter(out, kCaptured)
      .u64(static_cast<std::uint64_t>(message.time_ns))
      .u64(static_cast<std::uint64_t>(message.packet.at.count()))
      .u32(message.lost_before)
      .rest({header.data(), header.size()})
      .rest(message.packet.bytes);
}

void append(Bytes& out, const limb_ring::CaptureCounts& message) {
  FrameWriter frame(out, kCaptureCounts);
  for (const auto count : kCounts) frame.u64(message.*count);
}

void append(Bytes& out, const Turn& message) {
  FrameWriter(out, kTurn).u64(static_cast<std::uint64_t>(message.now.count()));
}

std::optional<ToClient> decode_to_client(const Frame& frame) {
  FieldReader reader(frame.body);
  switch (frame.type) {
    case kWelcome:
      return read_welcome(reader);
    case kRefused:
      return Refused{reader.rest_text()};
    case kPacket:
      return read_packet(reader);
    case kInterrupt:
      return read_interrupt(reader);
    case kResult:
      return read_result(reader);
    case kReply:
      return read_reply(reader);
    case kObserved:
      return read_observed(reader);
    case kObservedLost:
      return read_observed_lost(reader);
    case kCaptured:
      return read_captured(reader);
    case kCaptureCounts:
      return read_capture_counts(reader);
    case kTurn:
      return read_turn(reader);
    default:
      return std::nullopt;
  }
}

namespace {

enum ToDaemonType : std::uint8_t {
  kGreeting = 1,
  kSend,
  kInterruptRequest,
  kPull,
  kRequest,
  kObserve,
  kAlive,
  kCredit,
  kWaiting
};

constexpr std::uint8_t kRestartedByOwner = 1, kResultsMayWait = 2, kLockstep = 4, kAsksOnly = 8;

std::optional<ToDaemon> read_greeting(FieldReader reader) {
  Greeting message;
  const bool magic = reader.u32() == kGreetingMagic;
  message.version = reader.u16();  // 0: none was there
  const std::uint8_t role = reader.u8();
  message.role = static_cast<Role>(role);
  const std::uint8_t flags = reader.u8();
  message.restarted_by_owner = (flags & kRestartedByOwner) != 0;
  message.results_may_wait = (flags & kResultsMayWait) != 0;
  message.lockstep = (flags & kLockstep) != 0;
  message.asks_only = (flags & kAsksOnly) != 0;
  message.pid = reader.u32();
  message.alive_period = std::chrono::milliseconds{reader.u32()};
  message.ring = reader.text();
  if (!magic || message.version == 0) return std::nullopt;
  // A later version may have more fields. Its greeting is passed on all the same, so that the daemon can refuse it.
  const bool sound = reader.complete() && role <= static_cast<std::uint8_t>(Role::cpu);
  if (!sound && message.version == kHostPortVersion) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_send(FieldReader reader) {
  SendRequest message;
  message.token = reader.u32();
  message.destination = reader.u8();
  message.priority = reader.u8();
  message.channel = reader.u8();
  message.data = reader.rest();
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_interrupt_request(FieldReader reader) {
  InterruptRequest message;
  message.token = reader.u32();
  message.destination = reader.u8();
  message.factor = reader.u8();
  message.force = reader.u8() != 0;
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_pull(FieldReader reader) {
  PullRequest message;
  message.token = reader.u32();
  message.input = reader.u8();
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_request(FieldReader reader) {
  JsonRequest message;
  message.token = reader.u32();
  message.json = reader.rest_text();
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_credit(FieldReader reader) {
  const Credit message{reader.u16()};
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_waiting(FieldReader reader) {
  const Waiting message{std::chrono::nanoseconds{static_cast<std::int64_t>(reader.u64())}};
  if (!reader.complete()) return std::nullopt;
  return message;
}

std::optional<ToDaemon> read_alive(FieldReader reader) {
  if (!reader.complete()) return std::nullopt;
  return Alive{};
}

}  // namespace

void append(Bytes& out, const Greeting& message) {
  const int flags = (message.restarted_by_owner ? kRestartedByOwner : 0) |
                    (message.results_may_wait ? kResultsMayWait : 0) | (message.lockstep ? kLockstep : 0) |
                    (message.asks_only ? kAsksOnly : 0);
  FrameWriter(out, kGreeting)
      .u32(kGreetingMagic)
      .u16(message.version)
      .u8(static_cast<std::uint8_t>(message.role))
      .u8(static_cast<std::uint8_t>(flags))
      .u32(message.pid)
      .u32(static_cast<std::uint32_t>(message.alive_period.count()))
      .text(message.ring);
}

void append(Bytes& out, const SendRequest& message) {
  FrameWriter(out, kSend)
      .u32(message.token)
      .u8(message.destination)
      .u8(message.priority)
      .u8(message.channel)
      .rest(message.data);
}

void append(Bytes& out, const InterruptRequest& message) {
  FrameWriter(out, kInterruptRequest)
      .u32(message.token)
      .u8(message.destination)
      .u8(message.factor)
      .u8(message.force ? 1 : 0);
}

void append(Bytes& out, const PullRequest& message) { FrameWriter(out, kPull).u32(message.token).u8(message.input); }

void append(Bytes& out, const JsonRequest& message) {
  FrameWriter(out, kRequest).u32(message.token).rest(message.json);
}

void append(Bytes& out, const ObserveRequest& message) { FrameWriter(out, kObserve).rest(message.json); }

void append(Bytes& out, const Alive&) { FrameWriter(out, kAlive); }

void append(Bytes& out, const Credit& message) { FrameWriter(out, kCredit).u16(message.count); }

void append(Bytes& out, const Waiting& message) {
  FrameWriter(out, kWaiting).u64(static_cast<std::uint64_t>(message.until.count()));
}

std::optional<ToDaemon> decode_to_daemon(const Frame& frame) {
  FieldReader reader(frame.body);
  switch (frame.type) {
    case kGreeting:
      return read_greeting(reader);
    case kSend:
      return read_send(reader);
    case kInterruptRequest:
      return read_interrupt_request(reader);
    case kPull:
      return read_pull(reader);
    case kRequest:
      return read_request(reader);
    case kObserve:
      return ObserveRequest{reader.rest_text()};
    case kAlive:
      return read_alive(reader);
    case kCredit:
      return read_credit(reader);
    case kWaiting:
      return read_waiting(reader);
    default:
      return std::nullopt;
  }
}

}  // namespace limb_ring::client
