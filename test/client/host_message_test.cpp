#include "client/host_message.h"

#include <gmock/gmock.h>

#include <random>

namespace limb_ring::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

template <typename Kind>
Bytes encoded(const Kind& message) {
  Bytes out;
  append(out, message);
  return out;
}

Frame only_frame(const Bytes& bytes) {
  const FrameParse parse = parse_frame({bytes.data(), bytes.size()}, kMaxSizeToClient);
  EXPECT_EQ(parse.status, FrameParse::Status::frame);
  EXPECT_EQ(parse.consumed, bytes.size());
  return parse.frame;
}

/// `bytes` must live as long as the message, which may point into them.
template <typename Kind>
Kind to_daemon(const Bytes& bytes) {
  return std::get<Kind>(decode_to_daemon(only_frame(bytes)).value());
}
template <typename Kind>
Kind to_client(const Bytes& bytes) {
  return std::get<Kind>(decode_to_client(only_frame(bytes)).value());
}

const Bytes kData{1, 2, 0xFB, 0xFD, 0xFF};
const wire::ByteView kDataView{kData.data(), kData.size()};

Greeting some_greeting() {
  Greeting greeting;
  greeting.role = Role::cpu;
  greeting.restarted_by_owner = true;
  greeting.results_may_wait = true;
  greeting.pid = 4711;
  greeting.alive_period = milliseconds{70000};
  greeting.ring = "humanoid";
  return greeting;
}

TEST(HostMessage, GreetingBeginsWithMagicAndVersion) {
  const Bytes golden{0,   0,   0,    21,   1,           // size, type
                     'L', 'R', 'H',  'P',  0,    3,     // magic, version
                     1,   3,   0,    0,    0x12, 0x67,  // cpu, restarted by owner and results may wait, pid
                     0,   1,   0x11, 0x70, 0,    2,    'a', 'b'};
  Greeting greeting = some_greeting();
  greeting.ring = "ab";
  EXPECT_EQ(encoded(greeting), golden);
}

TEST(HostMessage, GreetingComesThrough) {
  const Bytes bytes = encoded(some_greeting());
  const auto read = to_daemon<Greeting>(bytes);
  EXPECT_EQ(read.version, kHostPortVersion);
  EXPECT_EQ(read.role, Role::cpu);
  EXPECT_TRUE(read.restarted_by_owner);
  EXPECT_TRUE(read.results_may_wait);
  EXPECT_EQ(read.pid, 4711u);
  EXPECT_EQ(read.alive_period, milliseconds{70000});
  EXPECT_EQ(read.ring, "humanoid");
  EXPECT_FALSE(read.asks_only);
}

TEST(HostMessage, GreetingOfAClientThatOnlyAsksComesThrough) {
  Greeting greeting;
  greeting.asks_only = true;
  EXPECT_TRUE(to_daemon<Greeting>(encoded(greeting)).asks_only);
}

TEST(HostMessage, GreetingOfALaterVersionIsReadAsFarAsItsVersion) {
  Greeting later = some_greeting();
  later.version = kHostPortVersion + 1;
  Bytes bytes = encoded(later);
  bytes.push_back(0);  // something this version does not know
  ++bytes[3];
  EXPECT_EQ(to_daemon<Greeting>(bytes).version, kHostPortVersion + 1);
}

TEST(HostMessage, SendComesThrough) {
  const Bytes bytes = encoded(SendRequest{0xA1B2C3D4, 255, 3, 63, kDataView});
  const auto read = to_daemon<SendRequest>(bytes);
  EXPECT_EQ(read.token, 0xA1B2C3D4u);
  EXPECT_EQ(read.destination, 255);
  EXPECT_EQ(read.priority, 3);
  EXPECT_EQ(read.channel, 63);
  EXPECT_THAT(Bytes(read.data.begin(), read.data.end()), testing::ElementsAreArray(kData));
}

TEST(HostMessage, SendsOfBadSizeAreReadTooSoThatTheyGetAnAnswer) {
  const Bytes empty = encoded(SendRequest{1, 2, 9, 99, {}});
  EXPECT_EQ(to_daemon<SendRequest>(empty).data.size, 0u);
  const Bytes much(513);
  const Bytes large = encoded(SendRequest{1, 2, 3, 4, {much.data(), much.size()}});
  EXPECT_EQ(to_daemon<SendRequest>(large).data.size, 513u);
}

TEST(HostMessage, InterruptAndPullComeThrough) {
  const Bytes interrupt = encoded(InterruptRequest{5, 12, 7, true});
  EXPECT_EQ(to_daemon<InterruptRequest>(interrupt).token, 5u);
  EXPECT_EQ(to_daemon<InterruptRequest>(interrupt).destination, 12);
  EXPECT_EQ(to_daemon<InterruptRequest>(interrupt).factor, 7);
  EXPECT_TRUE(to_daemon<InterruptRequest>(interrupt).force);
  const Bytes pull = encoded(PullRequest{6, 3});
  EXPECT_EQ(to_daemon<PullRequest>(pull).token, 6u);
  EXPECT_EQ(to_daemon<PullRequest>(pull).input, 3);
}

TEST(HostMessage, RequestObserveAliveAndCreditComeThrough) {
  const Bytes request = encoded(JsonRequest{8, "{\"do\":\"status\"}"});
  EXPECT_EQ(to_daemon<JsonRequest>(request).token, 8u);
  EXPECT_EQ(to_daemon<JsonRequest>(request).json, "{\"do\":\"status\"}");
  const Bytes observe = encoded(ObserveRequest{"{}"});
  EXPECT_EQ(to_daemon<ObserveRequest>(observe).json, "{}");
  const Bytes alive = encoded(Alive{});
  to_daemon<Alive>(alive);
  const Bytes credit = encoded(Credit{300});
  EXPECT_EQ(to_daemon<Credit>(credit).count, 300);
}

TEST(HostMessage, TurnsAndTheirEndsComeThrough) {
  EXPECT_EQ(to_client<Turn>(encoded(Turn{std::chrono::hours(1)})).now, std::chrono::hours(1));
  EXPECT_EQ(to_daemon<Waiting>(encoded(Waiting{std::chrono::nanoseconds::max()})).until,
            std::chrono::nanoseconds::max());
}

TEST(HostMessage, WelcomeAndRefusedComeThrough) {
  const Bytes welcome = encoded(Welcome{12, "left_knee", "humanoid"});
  EXPECT_EQ(to_client<Welcome>(welcome).id, 12);
  EXPECT_EQ(to_client<Welcome>(welcome).name, "left_knee");
  EXPECT_EQ(to_client<Welcome>(welcome).ring, "humanoid");
  EXPECT_EQ(to_client<Welcome>(encoded(Welcome{12, "a", "b", ClockKind::lockstep})).clock, ClockKind::lockstep);
  const Bytes refused = encoded(Refused{"no"});
  EXPECT_EQ(to_client<Refused>(refused).reason, "no");
}

TEST(HostMessage, PacketComesThrough) {
  const Bytes bytes = encoded(PacketView{3, 12, 1, 2, kDataView});
  const auto read = to_client<PacketView>(bytes);
  EXPECT_EQ(read.source, 3);
  EXPECT_EQ(read.destination, 12);
  EXPECT_EQ(read.priority, 1);
  EXPECT_EQ(read.channel, 2);
  EXPECT_THAT(Bytes(read.data.begin(), read.data.end()), testing::ElementsAreArray(kData));
}

TEST(HostMessage, ResultComesThrough) {
  const limb_ring::Result result{9, Outcome::refused, nanoseconds{12384}, 4, "why"};
  const auto read = to_client<limb_ring::Result>(encoded(result));
  EXPECT_EQ(read.token, 9u);
  EXPECT_EQ(read.outcome, Outcome::refused);
  EXPECT_EQ(read.round_trip, nanoseconds{12384});
  EXPECT_EQ(read.tries, 4u);
  EXPECT_EQ(read.reason, "why");
}

TEST(HostMessage, TheRestOfWhatClientsGetComesThrough) {
  using limb_ring::Interrupt;
  const auto interrupt = to_client<Interrupt>(encoded(Interrupt{Interrupt::Action::stop, 4, 1}));
  EXPECT_EQ(interrupt.action, Interrupt::Action::stop);
  EXPECT_EQ(interrupt.source, 4);
  EXPECT_EQ(interrupt.factor, 1);
  EXPECT_EQ(to_client<Reply>(encoded(Reply{2, "{}"})).token, 2u);
  EXPECT_EQ(to_client<Reply>(encoded(Reply{2, "{}"})).json, "{}");
  EXPECT_EQ(to_client<Observed>(encoded(Observed{"[1]"})).json, "[1]");
  EXPECT_EQ(to_client<ObservedLost>(encoded(ObservedLost{1ull << 40})).count, 1ull << 40);
}

TEST(HostMessage, AMessageWithInvalidFieldValuesIsNotRead) {
  Bytes role = encoded(some_greeting());
  role[kFrameHeaderSize + 6] = 2;
  EXPECT_FALSE(decode_to_daemon(only_frame(role)));
  Bytes magic = encoded(some_greeting());
  magic[kFrameHeaderSize] = 'X';
  EXPECT_FALSE(decode_to_daemon(only_frame(magic)));
  Bytes outcome = encoded(limb_ring::Result{});
  outcome[kFrameHeaderSize + 4] = 7;
  EXPECT_FALSE(decode_to_client(only_frame(outcome)));
  Bytes why = encoded(limb_ring::Result{});
  why[kFrameHeaderSize + 15] = static_cast<std::uint8_t>(kLastReason) + 1;
  EXPECT_FALSE(decode_to_client(only_frame(why)));
  const Bytes no_data = encoded(PacketView{1, 2, 3, 0, {}});
  EXPECT_FALSE(decode_to_client(only_frame(no_data)));
  const Bytes priority = encoded(PacketView{1, 2, 4, 0, kDataView});
  EXPECT_FALSE(decode_to_client(only_frame(priority)));
}

TEST(HostMessage, MessagesOfTheOtherDirectionAreNotRead) {
  EXPECT_FALSE(decode_to_client(only_frame(encoded(PullRequest{1, 2}))));
  EXPECT_FALSE(decode_to_daemon(only_frame(encoded(Welcome{1, "a", "b"}))));
}

/// All messages of fixed fields: cut anywhere, or with a byte too many, they are none. (Where the
/// last field takes all that is left, a cut within it is a shorter message.)
std::vector<std::pair<Bytes, std::size_t>> messages_and_fixed_sizes() {
  return {{encoded(some_greeting()), 26},
          {encoded(SendRequest{1, 2, 3, 4, kDataView}), 7},
          {encoded(InterruptRequest{1, 2, 3, true}), 7},
          {encoded(PullRequest{1, 2}), 5},
          {encoded(JsonRequest{1, "{}"}), 4},
          {encoded(Credit{1}), 2},
          {encoded(Welcome{1, "knee", "ring"}), 14},
          {encoded(PacketView{1, 2, 3, 4, kDataView}), 5},
          {encoded(limb_ring::Interrupt{}), 3},
          {encoded(limb_ring::Result{1, Outcome::lost, nanoseconds{1}, 1, "why"}), 16},
          {encoded(Reply{1, "{}"}), 4},
          {encoded(ObservedLost{1}), 8}};
}

TEST(HostMessage, AMessageCutWithinItsFixedFieldsIsNotRead) {
  for (const auto& [bytes, fixed] : messages_and_fixed_sizes()) {
    const Frame whole = only_frame(bytes);
    for (std::size_t size = 0; size <= whole.body.size; ++size) {
      const Frame cut{whole.type, whole.body.first(size)};
      const bool read = decode_to_daemon(cut).has_value() || decode_to_client(cut).has_value();
      EXPECT_EQ(read, size >= fixed) << "type " << int{whole.type} << ", cut at " << size;
    }
  }
}

TEST(HostMessage, RandomBytesNeverCrashTheReaders) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  unsigned read = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes body(random() % 40);
    for (auto& byte : body) byte = static_cast<std::uint8_t>(random());
    const Frame frame{static_cast<std::uint8_t>(random()), {body.data(), body.size()}};
    read += decode_to_daemon(frame).has_value();
    read += decode_to_client(frame).has_value();
  }
  EXPECT_GT(read, 0u);
  EXPECT_LT(read, 20000u);
}

TEST(HostMessage, CapturedPacketComesThrough) {
  CapturedView sent;
  sent.time_ns = 1'763'757'352'123'456'789;
  sent.lost_before = 3;
  sent.packet.at = nanoseconds{77};
  sent.packet.info.input = false;
  sent.packet.info.from = 4;
  sent.packet.info.retry = true;
  sent.packet.bytes = kDataView;
  const Bytes bytes = encoded(sent);
  const auto read = to_client<CapturedPacket>(bytes);
  EXPECT_EQ(read.time_ns, sent.time_ns);
  EXPECT_EQ(read.steady_ns, 77);
  EXPECT_EQ(read.lost_before, 3u);
  EXPECT_FALSE(read.info.input);
  EXPECT_EQ(read.info.from, 4);
  EXPECT_TRUE(read.info.retry);
  EXPECT_EQ(read.bytes, kData);
}

TEST(HostMessage, CapturedPacketWithoutAHeaderIsNotRead) {
  CapturedView sent;
  sent.packet.bytes = kDataView.first(3);
  EXPECT_FALSE(decode_to_client(only_frame(encoded(sent))));
}

TEST(HostMessage, CaptureCountsComeThrough) {
  const Bytes bytes = encoded(CaptureCounts{21, 1, 2, 3, 4, 11});
  const auto read = to_client<CaptureCounts>(bytes);
  EXPECT_EQ(read.seen, 21u);
  EXPECT_EQ(read.filtered + 10 * read.sampled_out + 100 * read.limited + 1000 * read.lost, 4321u);
  EXPECT_EQ(read.given, 11u);
}

TEST(HostMessage, JsonOfADaemonThatIsNestedTooDeeplyIsNotRead) {
  const std::string deep(60000, '[');
  EXPECT_FALSE(decode_to_client(only_frame(encoded(Reply{1, deep}))));
  EXPECT_FALSE(decode_to_client(only_frame(encoded(Observed{deep}))));
  EXPECT_TRUE(decode_to_client(only_frame(encoded(Reply{1, "{\"nodes\":[[1]]}"}))));
}

}  // namespace
}  // namespace limb_ring::client
