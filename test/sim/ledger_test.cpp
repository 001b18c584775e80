// Which send a packet on the line belongs to, as the soak and scenarios judge it.
#include "judge/ledger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/virtual_ring.h"
#include "support/node_literal.h"

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;

struct LedgerOfThree : testing::Test {
  static wire::Code code(unsigned number) {
    return {false, 0, wire::Sequence{static_cast<std::uint8_t>(number)}, wire::Incarnation{0}};
  }
  void ask(std::uint32_t token) {
    core::SendRequest request;
    request.owner = VirtualRing::kUser;
    request.token = token;
    request.destination = 2_id;
    request.data = {kData, sizeof kData};
    ledger.ask(1_id, request, true, now += 1us);
  }
  /// A first try leaves. @return its send
  Sent* leaves(unsigned number) {
    now += 1us;
    ledger.try_begins(1_id, code(number), now);
    return ledger.depart(1_id, code(number),
                         {2_id, 0, 0, sizeof kData, crc_of(number), wire::crc32({kData, sizeof kData})}, now);
  }
  Sent* found_at_node_2(unsigned number) { return ledger.on_line(1_id, code(number), 2_id, crc_of(number), 2_id); }
  void ends(std::uint32_t token, core::Outcome outcome) {
    core::SendEnded end;
    end.owner = VirtualRing::kUser;
    end.token = token;
    end.outcome = outcome;
    end.tries = 1;
    ledger.end(1_id, end, now += 1us);
  }
  /// Equal data under an equal number have an equal CRC.
  static std::uint32_t crc_of(unsigned number) { return 100 + number; }

  static constexpr std::uint8_t kData[1] = {7};
  core::Time now{};
  std::vector<std::string> complaints;
  Complain complain = [this](Promise, const std::string& what) { complaints.push_back(what); };
  Ledger ledger{3, false, complain};
};

// Numbers wrap after eight packets, and a refused send goes again with a new one each time. When it came to the number
// of an equal send of before, which nobody had decided on, the judge took it for that one: "ended delivered, and nobody
// has taken it".
TEST_F(LedgerOfThree, ARefusedSendThatComesToTheNumberOfAnEqualOneIsFound) {
  ask(1);
  Sent* untaken = leaves(0);
  ledger.come_home(untaken, wire::kFbcUntaken, now += 1us);
  ends(1, core::Outcome::no_such_node);
  ask(2);
  for (unsigned number = 1; number < 8; ++number) {
    Sent* sent = leaves(number);
    ASSERT_NE(sent, nullptr);
    EXPECT_EQ(found_at_node_2(number)->token, 2u);
    ledger.refuse(sent, 2_id, now);
    ledger.come_home(sent, 0, now += 1us);
  }
  ASSERT_NE(leaves(0), nullptr);
  ASSERT_NE(found_at_node_2(0), nullptr);
  EXPECT_EQ(found_at_node_2(0)->token, 2u);
  EXPECT_THAT(complaints, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::sim
