#include "firmware/fault_command.h"

#include <string>

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

std::optional<FaultCommand> order(const std::string& text) {
  return parse_fault_command({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Orders, KnowHangAndExit) {
  EXPECT_EQ(order("hang").value().kind, FaultCommand::Kind::hang);
  EXPECT_EQ(order("hang\n").value().kind, FaultCommand::Kind::hang);
  ASSERT_TRUE(order("exit 3"));
  EXPECT_EQ(order("exit 3")->kind, FaultCommand::Kind::exit);
  EXPECT_EQ(order("exit 3")->code, 3);
}

TEST(Orders, AreNothingElse) {
  for (const char* text : {"", " ", "hangs", "ha", "exit", "exit ", "exit x", "exit 256", "exit -1", "exit 3 4",
                           "EXIT 3", "exit 99999999999999999999"})
    EXPECT_FALSE(order(text)) << "'" << text << "'";
}

}  // namespace
}  // namespace limb_ring::firmware
