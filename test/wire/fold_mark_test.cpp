#include "wire/fold_mark.h"

#include <gtest/gtest.h>

#include <vector>

namespace limb_ring::wire {
namespace {

std::vector<std::uint8_t> bytes_of(FoldWord word) {
  SliceWriter line;
  put(line, word);
  const Slice slice = parse_slice(line.view()).slice;
  return {slice.bytes.begin(), slice.bytes.end()};
}

std::optional<FoldWord> read(const std::vector<std::uint8_t>& bytes) {
  return fold_word({SliceKind::fold, {bytes.data(), bytes.size()}});
}

TEST(FoldWord, ComesBackAsItWasSaid) {
  for (const FoldMark mark : {FoldMark::begin, FoldMark::last, FoldMark::lost, FoldMark::deaf, FoldMark::hears}) {
    const auto word = read(bytes_of({mark, 200}));
    ASSERT_TRUE(word);
    EXPECT_EQ(word->mark, mark);
    EXPECT_EQ(word->node, 200);
  }
}

TEST(FoldWord, WithAnyByteWrongIsNone) {
  const auto good = bytes_of({FoldMark::hears, 7});
  for (std::size_t at = 0; at < good.size(); ++at)
    for (unsigned wrong = 1; wrong < 256; ++wrong) {
      auto bytes = good;
      bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ wrong);
      EXPECT_FALSE(read(bytes)) << at << ' ' << wrong;
    }
}

TEST(FoldWord, ThatNobodyKnowsIsNone) {
  for (const std::uint8_t mark : {0, 6, 255}) EXPECT_FALSE(read({mark, 7, fold_check(mark, 7)})) << int{mark};
  EXPECT_FALSE(read({1, 7}));
}

}  // namespace
}  // namespace limb_ring::wire
