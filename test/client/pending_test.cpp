#include "client/inbox.h"

#include <gtest/gtest.h>

namespace limb_ring::client {
namespace {

TEST(Pending, EndsEachCallOnce) {
  Pending pending;
  const std::uint32_t token = pending.add(Pending::Ends::with_result);
  EXPECT_TRUE(pending.contains(token, Pending::Ends::with_result));
  EXPECT_FALSE(pending.contains(token, Pending::Ends::with_reply));
  EXPECT_TRUE(pending.remove(token));
  EXPECT_FALSE(pending.remove(token));
}

TEST(Pending, CancelsAllInTheOrderOfTheirCalls) {
  Pending pending;
  Inbox inbox;
  const std::uint32_t first = pending.add(Pending::Ends::with_result);
  const std::uint32_t second = pending.add(Pending::Ends::with_reply);
  pending.cancel_all("gone", inbox);
  const auto result = std::get<Result>(*inbox.take());
  EXPECT_EQ(result.token, first);
  EXPECT_EQ(result.outcome, Outcome::cancelled);
  EXPECT_EQ(result.reason, "gone");
  const auto reply = std::get<Reply>(*inbox.take());
  EXPECT_EQ(reply.token, second);
  EXPECT_EQ(reply.json, "{\"error\": \"gone\"}");
  EXPECT_FALSE(pending.contains(second, Pending::Ends::with_reply));
}

TEST(ErrorReply, IsKnownByItsFirstMember) {
  EXPECT_EQ(error_of("{\"error\": \"no node 99\"}"), "no node 99");
  EXPECT_EQ(error_of(" {\n \"error\" : \"x\", \"more\": 1}"), "x");
  EXPECT_EQ(error_of("{\"error\": 7}"), " 7}");
  EXPECT_EQ(error_of("{\"ring\": \"error\"}"), "");
  EXPECT_EQ(error_of("{}"), "");
  EXPECT_EQ(error_of(""), "");
}

TEST(ErrorReply, CarriesAnyTextThereAndBack) {
  const std::string text = "a \"quoted\" \\ back, a line\nand a bell \a";
  EXPECT_EQ(error_of(error_json(text)), text);
  EXPECT_EQ(error_json("line\nend"), "{\"error\": \"line\\u000aend\"}");
  EXPECT_EQ(error_of("{\"error\": \"a\\nb\\tc\\/d\\u0041\"}"), "a\nb\tc/dA");
  EXPECT_EQ(error_of("{\"error\": \"cut off\\u00"), std::string("cut off") + '\0');
}

}  // namespace
}  // namespace limb_ring::client
