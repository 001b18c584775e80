#include "client/host_message.h"

#include <algorithm>

#include "client/arguments.h"
#include "wire/interrupt_packet.h"
#include "wire/pseudo_header.h"

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

}  // namespace limb_ring::client
