#include "client/arguments.h"

#include <gmock/gmock.h>

#include <set>

namespace limb_ring::client {
namespace {

using testing::HasSubstr;

TEST(Arguments, WithinTheirRangesAreAccepted) {
  EXPECT_FALSE(send_problem(1, 0, 0));
  EXPECT_FALSE(send_problem(512, 3, 63));
  EXPECT_FALSE(interrupt_problem(7));
  EXPECT_FALSE(pull_problem(7));
}

TEST(Arguments, OutsideTheirRangesSayWhatIsAllowed) {
  EXPECT_EQ(send_problem(0, 0, 0)->text, "size 0: a packet carries 1 to 512 bytes");
  EXPECT_EQ(send_problem(513, 0, 0)->text, "size 513: a packet carries 1 to 512 bytes");
  EXPECT_EQ(send_problem(1, 4, 0)->text, "priority 4: priorities are 0 (highest) to 3");
  EXPECT_EQ(send_problem(1, 0, 64)->text, "channel 64: channels are 0 to 63, and 1 is the network controllers' own");
  EXPECT_THAT(send_problem(1, 0, 1)->text, HasSubstr("network controllers"));
  EXPECT_EQ(interrupt_problem(8)->text, "factor 8: interrupt factors are 0 to 7");
  EXPECT_EQ(pull_problem(8)->text, "input 8: this interrupt input is wired to nothing");
}

TEST(Arguments, OutsideTheirRangesHaveAReasonForPrograms) {
  EXPECT_EQ(send_problem(0, 0, 0)->why, Reason::bad_size);
  EXPECT_EQ(send_problem(1, 4, 0)->why, Reason::bad_priority);
  EXPECT_EQ(send_problem(1, 0, 1)->why, Reason::bad_channel);
  EXPECT_EQ(interrupt_problem(8)->why, Reason::bad_factor);
}

TEST(Reasons, EveryOneHasAWordOfItsOwnAndASentence) {
  std::set<std::string> words;
  for (unsigned i = 1; i <= static_cast<unsigned>(kLastReason); ++i) {
    const auto reason = static_cast<Reason>(i);
    EXPECT_STRNE(sentence(reason), "") << to_string(reason);
    EXPECT_TRUE(words.insert(to_string(reason)).second) << to_string(reason);
  }
  EXPECT_STREQ(to_string(Reason::none), "");
  EXPECT_STREQ(to_string(kLastReason), "given_up");
}

std::string nested(std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

TEST(Arguments, JsonMayBeNestedUpToALimit) {
  EXPECT_FALSE(json_problem(nested(kMostJsonLevels)));
  EXPECT_EQ(json_problem(nested(kMostJsonLevels + 1)),
            "JSON: lists and objects are nested too deep; allowed: 32 levels");
  EXPECT_TRUE(json_problem(std::string(60000, '{')));
}

TEST(Arguments, BracketsSideBySideOrInStringsAreNotLevels) {
  std::string beside, within = "\"";
  for (int i = 0; i < 100; ++i) beside += "[],", within += "[{";
  EXPECT_FALSE(json_problem(beside));
  EXPECT_FALSE(json_problem(within + "\""));
  EXPECT_FALSE(json_problem("\"\\\"" + within.substr(1) + "\"")) << "the text goes on behind an escaped quote";
  EXPECT_TRUE(json_problem("\"\\\\\"" + std::string(33, '['))) << "it ends behind an escaped backslash";
}

}  // namespace
}  // namespace limb_ring::client
