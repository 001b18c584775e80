// Keyed datagrams without a socket.
#include "io/seal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/view.h"

namespace limb_ring::link {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Verdict = Opener::Verdict;
using test::view;

Key key_of(std::uint8_t value) {
  Key key;
  key.fill(value);
  return key;
}

struct Session : testing::Test {
  Sealer sealer{key_of(1)};
  Opener opener{key_of(1)};

  Bytes sealed(const Bytes& content) {
    Bytes bytes = content;
    bytes.resize(content.size() + kSealSize);
    sealer.seal(bytes.data(), content.size());
    return bytes;
  }
};

TEST_F(Session, OpensWhatItsSealerHasSealedOnce) {
  const Bytes datagram = sealed({1, 2, 3});
  EXPECT_EQ(datagram.size(), 3 + 24u);
  EXPECT_EQ(opener.open(view(datagram)), Verdict::good);
  EXPECT_EQ(opener.open(view(datagram)), Verdict::replayed);
}

TEST_F(Session, TakesNoDatagramWithAnyBitFlipped) {
  const Bytes datagram = sealed({1, 2, 3});
  for (std::size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
    Bytes bad = datagram;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ 1u << bit % 8);
    EXPECT_EQ(opener.open(view(bad)), Verdict::forged) << "bit " << bit;
  }
  EXPECT_EQ(opener.open(view(datagram)), Verdict::good) << "a forged number has not used it up";
}

TEST_F(Session, TakesNoDatagramCutShortOrMadeLonger) {
  Bytes datagram = sealed({1, 2, 3});
  for (std::size_t size = 0; size < datagram.size(); ++size)
    EXPECT_EQ(opener.open({datagram.data(), size}), size < kSealSize ? Verdict::truncated : Verdict::forged);
  datagram.push_back(0);
  EXPECT_EQ(opener.open(view(datagram)), Verdict::forged);
}

TEST_F(Session, TakesNothingOfAnotherKey) {
  EXPECT_EQ(Opener(key_of(2)).open(view(sealed({1, 2, 3}))), Verdict::forged);
}

TEST_F(Session, TakesReorderedDatagramsOnceEach) {
  std::vector<Bytes> all;
  for (std::uint8_t i = 0; i < 100; ++i) all.push_back(sealed({i}));
  for (std::size_t i = all.size(); i-- > 0;) EXPECT_EQ(opener.open(view(all[i])), Verdict::good);
  for (const Bytes& again : all) EXPECT_EQ(opener.open(view(again)), Verdict::replayed);
}

TEST(ReplayWindow, LetsEachNumberThroughOnce) {
  ReplayWindow window;
  EXPECT_FALSE(window.take(0)) << "no datagram has it";
  EXPECT_TRUE(window.take(2));
  EXPECT_TRUE(window.take(1));
  EXPECT_FALSE(window.take(1));
  EXPECT_FALSE(window.take(2));
}

TEST(ReplayWindow, ForgetsNothingWithinItsSizeAndLetsNothingOlderThrough) {
  constexpr std::uint64_t kHigh = 1'000'000;
  ReplayWindow window;
  EXPECT_TRUE(window.take(kHigh - ReplayWindow::kSize + 1));
  EXPECT_TRUE(window.take(kHigh));
  EXPECT_FALSE(window.take(kHigh - ReplayWindow::kSize + 1)) << "still known";
  EXPECT_TRUE(window.take(kHigh - ReplayWindow::kSize + 2));
  EXPECT_FALSE(window.take(kHigh - ReplayWindow::kSize)) << "too old to tell";
}

TEST(ReplayWindow, AgreesWithAListOfAllNumbersWhateverTheJumps) {
  ReplayWindow window;
  std::vector<bool> seen(200'000);
  std::uint64_t highest = 0, state = 1;
  for (int i = 0; i < 100'000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t wild = state >> 60 == 0 ? state >> 20 & 4095 : state >> 20 & 63;
    const std::uint64_t number = std::min<std::uint64_t>(seen.size() - 1, (highest > 40 ? highest - 40 : 1) + wild);
    const bool fresh = !seen[number] && highest < number + ReplayWindow::kSize;
    EXPECT_EQ(window.take(number), fresh) << number << " after " << highest;
    if (fresh) seen[number] = true;
    highest = std::max(highest, number);
  }
}

struct Keys : testing::Test {
  LineKey line{key_of(7), 42, false};
  Handshake handshake{{1}, {2}, 3, 4, 5};

  static bool same(const SessionKeys& a, const SessionKeys& b) {
    return a.forward == b.forward || a.backward == b.backward;
  }
};

TEST_F(Keys, OfASessionComeFromBothNonces) {
  const SessionKeys keys = line.session(handshake);
  EXPECT_NE(keys.forward, keys.backward);
  EXPECT_EQ(line.session(handshake).forward, keys.forward);
  for (Handshake other : {Handshake{{9}, {2}, 3, 4, 5}, Handshake{{1}, {9}, 3, 4, 5}, Handshake{{1}, {2}, 9, 4, 5},
                          Handshake{{1}, {2}, 3, 9, 5}, Handshake{{1}, {2}, 3, 4, 9}})
    EXPECT_FALSE(same(line.session(other), keys));
}

TEST_F(Keys, AreOfOneRingAndOneLine) {
  for (const LineKey& other :
       {LineKey(key_of(8), 42, false), LineKey(key_of(7), 43, false), LineKey(key_of(7), 42, true)}) {
    EXPECT_FALSE(same(other.session(handshake), line.session(handshake)));
    EXPECT_NE(other.tag({}, {}, 1), line.tag({}, {}, 1));
  }
}

TEST_F(Keys, TagIsBoundToTheMessageTheQuestionAndTheNode) {
  const Bytes message{1, 2, 3}, other{1, 2, 4};
  const Tag tag = line.tag(view(message), {1}, 5);
  EXPECT_TRUE(line.check(view(message), {1}, 5, tag.data()));
  EXPECT_FALSE(line.check(view(other), {1}, 5, tag.data()));
  EXPECT_FALSE(line.check(view(message), {2}, 5, tag.data()));
  EXPECT_FALSE(line.check(view(message), {1}, 6, tag.data()));
}

TEST(Nonces, AreFresh) { EXPECT_NE(fresh_long_nonce(), fresh_long_nonce()); }

}  // namespace
}  // namespace limb_ring::link
