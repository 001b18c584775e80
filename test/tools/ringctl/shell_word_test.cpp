#include "tools/common/text_table.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace limb_ring::app {
namespace {

/// What a shell makes of the text, as the one argument of a program.
std::string read_back(const std::string& text) {
  std::FILE* shell = ::popen(("printf %s " + text).c_str(), "r");
  std::string read;
  for (int c = std::fgetc(shell); c != EOF; c = std::fgetc(shell)) read += static_cast<char>(c);
  ::pclose(shell);
  return read;
}

TEST(ShellWord, IsReadBackWhateverIsInIt) {
  for (const char* word :
       {"--seed", "my ring.yaml", "it's", "$HOME", "a\\b", "two\nlines", "*", "a;b", "\"", "#1", "~"})
    EXPECT_EQ(read_back(shell_word(word)), word);
  EXPECT_EQ(shell_word(""), "''");
}

TEST(ShellWord, HasNoQuotesIfItNeedsNone) {
  for (const char* word : {"--seed=1", "config/leg8.yaml", "10Mbit/s", "3:lost,5:restart:1"})
    EXPECT_EQ(shell_word(word), word);
}

}  // namespace
}  // namespace limb_ring::app
