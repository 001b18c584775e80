#include "wire/control_message.h"
#include "support/node_literal.h"

#include <gtest/gtest.h>

#include <array>

namespace limb_ring::wire {
namespace {

TEST(ControlMessage, HelloComesBack) {
  std::array<std::uint8_t, kHelloSize> bytes;
  encode(Hello{0x0102030405060708, true}, bytes.data());
  EXPECT_EQ(bytes, (std::array<std::uint8_t, kHelloSize>{1, 1, 2, 3, 4, 5, 6, 7, 8, 1}));
  EXPECT_EQ(decode_hello({bytes.data(), bytes.size()})->boot, 0x0102030405060708u);
}

TEST(ControlMessage, BeaconComesBack) {
  Beacon beacon{42,    3, CpuState::silent, 250, LinkState::up, 4_id, LinkState::silent, 6_id, true, 4_id, 5_id, false,
                false, {}};
  std::array<std::uint8_t, kBeaconSize> bytes;
  ASSERT_EQ(encode(beacon, bytes.data()), kBeaconSize);
  const auto back = decode_beacon({bytes.data(), bytes.size()});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->boot, 42u);
  EXPECT_EQ(back->cpu_boots, 3u);
  EXPECT_EQ(back->cpu_state, CpuState::silent);
  EXPECT_EQ(back->cpu_silent_ms, 250u);
  EXPECT_EQ(back->output, LinkState::silent);
  EXPECT_EQ(back->output_to, 6);
  EXPECT_TRUE(back->break_known);
  EXPECT_EQ(back->break_behind, 5);
  EXPECT_FALSE(back->cpu_comes_back);
}

// The table of protocol.md section 3.9.
TEST(ControlMessage, ABeaconsFieldsStandInTheOrderOfTheProtocol) {
  Beacon beacon{0x0102030405060708,
                0x11121314,
                CpuState::silent,
                0x21222324,
                LinkState::up,
                4_id,
                LinkState::silent,
                6_id,
                true,
                7_id,
                8_id,
                true,
                true,
                {0x31323334, 9_id, 0x4142434445464748}};
  std::array<std::uint8_t, kLongBeaconSize> bytes;
  ASSERT_EQ(encode(beacon, bytes.data()), kLongBeaconSize);
  EXPECT_EQ(bytes,
            (std::array<std::uint8_t, kLongBeaconSize>{
                2, 1, 2, 3, 4, 5, 6, 7,    8,    0x11, 0x12, 0x13, 0x14, 4,    0x21, 0x22, 0x23, 0x24, 1,    4,
                2, 6, 1, 7, 8, 1, 1, 0x31, 0x32, 0x33, 0x34, 9,    0x41, 0x42, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48}));
}

TEST(ControlMessage, ABeaconWithTheLastOfAllStatesIsRead) {
  Beacon beacon;
  beacon.cpu_state = CpuState::failed;
  beacon.input = beacon.output = LinkState::folded;
  std::array<std::uint8_t, kBeaconSize> bytes;
  encode(beacon, bytes.data());
  const auto back = decode_beacon({bytes.data(), bytes.size()});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->cpu_state, CpuState::failed);
  EXPECT_EQ(back->input, LinkState::folded);
  EXPECT_EQ(back->output, LinkState::folded);
}

void change(bool& is) { is = !is; }
void change(NodeId& node) { node = NodeId{static_cast<std::uint8_t>(node + 1)}; }
void change(ClockLatch& latch) { latch = {1, 2_id, 3}; }
template <class T>
void change(T& number) {
  number = static_cast<T>(static_cast<std::uint64_t>(number) + 1);
}

TEST(ControlMessage, AFieldOfABeaconThatIsAnotherComesBackAndIsNewsIfItsRowSaysSo) {
  int fields = 0;
  Beacon::fields([&](auto member, const Field& field) {
    Beacon beacon;
    change(beacon.*member);
    std::array<std::uint8_t, kLongBeaconSize> bytes;
    const auto back = decode_beacon({bytes.data(), encode(beacon, bytes.data())});
    ASSERT_TRUE(back) << field.name;
    EXPECT_TRUE((*back).*member == beacon.*member) << field.name;
    EXPECT_FALSE((*back).*member == Beacon{}.*member) << field.name;
    EXPECT_EQ(is_news({}, beacon), field.news) << field.name;
    ++fields;
  });
  EXPECT_GT(fields, 12);
}

TEST(ControlMessage, ABeaconThatIsToldNothingIsAllZeroButThatTheCpuComesBack) {
  std::array<std::uint8_t, kBeaconSize> bytes, expected{2};
  ASSERT_EQ(encode(Beacon{}, bytes.data()), kBeaconSize);
  expected[25] = 1;
  EXPECT_EQ(bytes, expected);
}

TEST(ControlMessage, BeaconWithAStopOrALatchIsLongerAndComesBack) {
  Beacon beacon;
  beacon.stop_latched = true;
  beacon.latch = {7, 3_id, 0x0102030405060708};
  std::array<std::uint8_t, kLongBeaconSize> bytes;
  ASSERT_EQ(encode(beacon, bytes.data()), kLongBeaconSize);
  const auto back = decode_beacon({bytes.data(), bytes.size()});
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->stop_latched);
  EXPECT_EQ(back->latch.count, 7u);
  EXPECT_EQ(back->latch.source, 3);
  EXPECT_EQ(back->latch.clock_ns, 0x0102030405060708u);
  bytes[26] = 2;
  EXPECT_FALSE(decode_beacon({bytes.data(), bytes.size()}));
  beacon.stop_latched = false;
  encode(beacon, bytes.data());
  const auto latched = decode_beacon({bytes.data(), bytes.size()});
  ASSERT_TRUE(latched);
  EXPECT_FALSE(latched->stop_latched);
}

TEST(ControlMessage, ALongBeaconWithoutMoreContentIsNotRead) {
  std::array<std::uint8_t, kLongBeaconSize> bytes{};
  encode(Beacon{}, bytes.data());
  EXPECT_FALSE(decode_beacon({bytes.data(), bytes.size()}));
  bytes[26] = 1;
  EXPECT_TRUE(decode_beacon({bytes.data(), bytes.size()}));
  bytes[39] = 1;  // a clock that was latched at no latch
  EXPECT_FALSE(decode_beacon({bytes.data(), bytes.size()}));
}

TEST(ControlMessage, WrongSizesTypesAndValuesAreNotRead) {
  std::array<std::uint8_t, kBeaconSize> bytes;
  encode(Beacon{}, bytes.data());
  EXPECT_FALSE(decode_beacon({bytes.data(), bytes.size() - 1}));
  EXPECT_FALSE(decode_hello({bytes.data(), bytes.size()}));
  EXPECT_FALSE(decode_hello({}));
}

TEST(ControlMessage, AHelloThatBothRemembersAndDoesNotIsNotRead) {
  std::array<std::uint8_t, kHelloSize> bytes;
  encode(Hello{7, true}, bytes.data());
  ASSERT_TRUE(decode_hello({bytes.data(), bytes.size()}));
  bytes[9] = 2;
  EXPECT_FALSE(decode_hello({bytes.data(), bytes.size()}));
}

TEST(ControlMessage, ABeaconWithAValueBeyondTheLastIsNotRead) {
  std::array<std::uint8_t, kBeaconSize> good;
  encode(Beacon{}, good.data());
  ASSERT_TRUE(decode_beacon({good.data(), good.size()}));
  const auto after_last = [](auto last) { return static_cast<std::uint8_t>(static_cast<unsigned>(last) + 1); };
  const std::pair<std::size_t, std::uint8_t> wrong[] = {{13, after_last(CpuState::failed)},  // offsets as above
                                                        {18, after_last(LinkState::folded)},
                                                        {20, after_last(LinkState::folded)},
                                                        {22, after_last(true)},
                                                        {25, after_last(true)}};
  for (const auto& [at, value] : wrong) {
    auto bytes = good;
    bytes[at] = value;
    EXPECT_FALSE(decode_beacon({bytes.data(), bytes.size()})) << at;
  }
}

}  // namespace
}  // namespace limb_ring::wire
