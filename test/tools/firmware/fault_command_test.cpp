#include "tools/firmware/options.h"

#include <string>

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

std::optional<FaultCommand> parsed(const std::string& text) {
  return parse_fault_command({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(FaultCommandText, MayBeHangOrExit) {
  EXPECT_EQ(parsed("hang").value().kind, FaultCommand::Kind::hang);
  EXPECT_EQ(parsed("hang\n").value().kind, FaultCommand::Kind::hang);
  ASSERT_TRUE(parsed("exit 3"));
  EXPECT_EQ(parsed("exit 3")->kind, FaultCommand::Kind::exit);
  EXPECT_EQ(parsed("exit 3")->code, 3);
}

TEST(FaultCommandText, RefusesEverythingElse) {
  for (const char* text : {"", " ", "hangs", "ha", "exit", "exit ", "exit x", "exit 256", "exit -1", "exit 3 4",
                           "EXIT 3", "exit 99999999999999999999"})
    EXPECT_FALSE(parsed(text)) << "'" << text << "'";
}

}  // namespace
}  // namespace limb_ring::firmware
