#include "support/node_literal.h"
#include "wire/control_message.h"

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
  for (const FoldWordKind kind :
       {FoldWordKind::begin, FoldWordKind::last, FoldWordKind::lost, FoldWordKind::deaf, FoldWordKind::hears}) {
    const auto word = read(bytes_of({kind, 200_id}));
    ASSERT_TRUE(word);
    EXPECT_EQ(word->kind, kind);
    EXPECT_EQ(word->node, 200);
  }
}

TEST(FoldWord, IsASliceOfItsKindAndSize) {
  std::vector<std::uint8_t> bytes = bytes_of({FoldWordKind::begin, 7_id});
  EXPECT_FALSE(fold_word({SliceKind::more, {bytes.data(), bytes.size()}}));
  bytes.push_back(0);
  EXPECT_FALSE(read(bytes));
}

TEST(FoldWord, WithAnyByteWrongIsNotRead) {
  const auto good = bytes_of({FoldWordKind::hears, 7_id});
  for (std::size_t at = 0; at < good.size(); ++at)
    for (unsigned wrong = 1; wrong < 256; ++wrong) {
      auto bytes = good;
      bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ wrong);
      EXPECT_FALSE(read(bytes)) << at << ' ' << wrong;
    }
}

TEST(FoldWord, OfAnUnknownKindIsNotRead) {
  for (const std::uint8_t kind : {0, 6, 255}) EXPECT_FALSE(read({kind, 7, fold_check(kind, 7_id)})) << int{kind};
  EXPECT_FALSE(read({1, 7}));
}

}  // namespace
}  // namespace limb_ring::wire
