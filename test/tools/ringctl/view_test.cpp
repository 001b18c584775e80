// What the server of `ringctl view` takes from a page, and for whom it answers.
#include <gmock/gmock.h>

#include "tools/ringctl/view.h"

namespace limb_ring::ringctl {
namespace {

using ::testing::ElementsAre;

TEST(View, AnOrderIsTheWordsOfACommandLine) {
  EXPECT_THAT(ordered_words(R"(["fault", "cut", "left_hip:left_knee"])"),
              ElementsAre("fault", "cut", "left_hip:left_knee"));
  EXPECT_THAT(ordered_words(R"(["clock", "pace", "0.01"])"), ElementsAre("clock", "pace", "0.01"));
  EXPECT_THAT(ordered_words(R"(["stop"])"), ElementsAre("stop"));
}

TEST(View, ACommandWithoutAButtonOnThePageIsRefused) {
  for (const char* order : {R"(["down"])", R"(["fault"])", R"(["fault", "babble", "a"])", R"(["clock", "sync"])", "[]",
                            "{}", R"("stop")", "[1]", "[", "", R"(["stop", "a", "b", "c", "d", "e", "f"])"})
    EXPECT_THROW(ordered_words(order), UsageError) << order;
}

TEST(View, AWordThatIsAnOptionOrNotPlainIsRefused) {
  for (const char* order :
       {R"(["stop", "--from"])", R"(["reset", "-x"])", R"(["reset", "a b"])", R"(["reset", ""])",
        R"(["reset", "a\u0000"])", R"x(["reset", "$(id)"])x", R"(["reset", "../a"])", R"(["reset", "ä"])"})
    EXPECT_THROW(ordered_words(order), UsageError) << order;
}

TEST(View, ItAnswersOnlyForNumericAddressesAndLocalhostAtItsPort) {
  for (const char* host : {"127.0.0.1:80", "localhost:80", "[::1]:80", "192.168.1.4:80"})
    EXPECT_TRUE(is_own_host(host, 80)) << host;
  for (const char* host : {"127.0.0.1", "127.0.0.1:81", "robot:80", "127.0.0.1.nip.io:80", "", ":80", "[]:80",
                           "[::1:80", "localhost", "localhost:080"})
    EXPECT_FALSE(is_own_host(host, 80)) << host;
}

TEST(View, ASecretIsTheSameOnlyIfAllOfItIs) {
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "bbc"}) EXPECT_FALSE(is_same_secret("abc", other)) << other;
}

}  // namespace
}  // namespace limb_ring::ringctl
