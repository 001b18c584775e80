#include "client/host_message.h"

namespace limb_ring::client {

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
