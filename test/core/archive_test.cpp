// Which members a state has, as a number: it says whether a state that was written down can be gone on from.
#include "core/archive.h"

#include <gtest/gtest.h>

namespace limb_ring::core {
namespace {

template <class Value = std::uint8_t>
struct Member {
  const char* name;
  Value value;
  template <class Archive>
  void archive(Archive& a) {
    a(name, value);
  }
};

template <class Value>
std::uint64_t layout_of(Member<Value> member) {
  StateLayout layout;
  member.archive(layout);
  return layout.value();
}

TEST(StateLayout, DiffersWithANameNotWithAValueOrWithWhereTheNameStands) {
  const char here[] = "hop\0here", there[] = "hop\0there";
  EXPECT_EQ(layout_of(Member<>{here, 1}), layout_of(Member<>{there, 2}));
  EXPECT_NE(layout_of(Member<>{"hop", 1}), layout_of(Member<>{"hob", 1}));
}

TEST(StateLayout, DiffersWithASize) {
  EXPECT_NE(layout_of(Member<>{"hop", 1}), layout_of(Member<std::uint16_t>{"hop", 1}));
}

}  // namespace
}  // namespace limb_ring::core
