#include "wire/slice.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/view.h"

namespace limb_ring::wire {
namespace {

using Status = SliceParse::Status;
using Bytes = std::vector<std::uint8_t>;
using test::view;

TEST(Slice, ComesBackAsItWasPut) {
  SliceWriter writer;
  const Bytes payload(24, 0x5A);
  writer.put(SliceKind::end, view(payload));
  writer.put(SliceKind::idle, {});
  const SliceParse first = parse_slice(writer.view());
  ASSERT_EQ(first.status, Status::slice);
  EXPECT_EQ(first.slice.kind, SliceKind::end);
  EXPECT_EQ(Bytes(first.slice.bytes.begin(), first.slice.bytes.end()), payload);
  const SliceParse second = parse_slice(writer.view().from(first.consumed));
  ASSERT_EQ(second.status, Status::slice);
  EXPECT_EQ(second.slice.kind, SliceKind::idle);
  EXPECT_EQ(first.consumed + second.consumed, writer.view().size);
}

TEST(Slice, GoldenBytes) {
  SliceWriter writer;
  writer.put(SliceKind::more, view({1, 2, 3, 4}));
  EXPECT_EQ(Bytes(writer.view().begin(), writer.view().end()), (Bytes{0xA7, 2, 0, 4, 1, 2, 3, 4}));
}

TEST(Slice, IsIncompleteUntilItsLastByte) {
  SliceWriter writer;
  writer.put(SliceKind::interrupt, view(Bytes(12, 7)));
  for (std::size_t size = 0; size < writer.view().size; ++size) {
    const SliceParse parse = parse_slice(writer.view().first(size));
    EXPECT_EQ(parse.status, Status::incomplete) << size;
    EXPECT_EQ(parse.consumed, 0u) << "it is looked at once more when more has come: " << size;
  }
}

TEST(Slice, GarbageIsMalformedAtOnce) {
  EXPECT_EQ(parse_slice(view({0x00})).status, Status::malformed);
  EXPECT_EQ(parse_slice(view({0xA7, 0, 0, 0})).status, Status::malformed) << "kind 0";
  EXPECT_EQ(parse_slice(view({0xA7, 8, 0, 0})).status, Status::malformed) << "kind 8";
  EXPECT_EQ(parse_slice(view({0xA7, 8, 0, 0})).consumed, 0u);
}

TEST(Slice, SizesTheirKindCannotHaveAreMalformed) {
  const auto status = [](SliceKind kind, std::uint16_t size) {
    Bytes bytes(kSliceHeaderSize + size, 0);
    bytes[0] = kSliceMagic;
    bytes[1] = static_cast<std::uint8_t>(kind);
    store_u16(bytes.data() + 2, size);
    return parse_slice(view(bytes)).status;
  };
  for (const auto& [kind, size] : std::vector<std::pair<SliceKind, std::uint16_t>>{{SliceKind::start, 3},
                                                                                   {SliceKind::start, 5},
                                                                                   {SliceKind::start, 520},
                                                                                   {SliceKind::more, 0},
                                                                                   {SliceKind::more, 6},
                                                                                   {SliceKind::end, 7},
                                                                                   {SliceKind::end, 521},
                                                                                   {SliceKind::whole, 12},
                                                                                   {SliceKind::whole, 525},
                                                                                   {SliceKind::interrupt, 11},
                                                                                   {SliceKind::abort, 1},
                                                                                   {SliceKind::idle, 1}})
    EXPECT_EQ(status(kind, size), Status::malformed) << static_cast<int>(kind) << " " << size;
  EXPECT_EQ(status(SliceKind::whole, 13), Status::slice);
  EXPECT_EQ(status(SliceKind::whole, 524), Status::slice);
}

}  // namespace
}  // namespace limb_ring::wire
