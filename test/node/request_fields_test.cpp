// The fields of a request in JSON are checked before the request is carried out.
#include "node/requests.h"

#include <gmock/gmock.h>

#include "node/observers.h"

namespace limb_ring::runtime {
namespace {

using testing::HasSubstr;

std::string nested(std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

template <class Call>
std::string refusal_of(Call call) {
  try {
    call();
    return {};
  } catch (const RequestError& error) {
    return error.what();
  }
}

// 64 kB of brackets would need more stack than a process has.
TEST(RequestFields, JsonNestedTooDeepIsRefused) {
  for (const std::string& text : {nested(32600), "{\"do\":\"ping\",\"to\":" + nested(32600) + "}"})
    EXPECT_THAT(refusal_of([&] { object_in(text, "an object"); }), HasSubstr("nested too deep; allowed: 32 levels"));
}

TEST(RequestFields, WhatIsNotAnObjectIsRefused) {
  for (const char* text : {"", "[]", "7", "{", "{}}", "{\"a\":}"})
    EXPECT_EQ(refusal_of([&] { object_in(text, "an object is expected"); }), "an object is expected") << text;
  EXPECT_EQ(object_in("{\"a\": [1]}", "")["a"][0], 1);
}

TEST(ObserveFilter, NestedTooDeepIsRefused) {
  const config::RingConfig ring;
  for (const char* field : {"kinds", "packets"})
    EXPECT_THAT(
        refusal_of([&] { read_observe_filter(ring, "{\"" + std::string(field) + "\":" + nested(32600) + "}"); }),
        HasSubstr("nested too deep"));
}

}  // namespace
}  // namespace limb_ring::runtime
