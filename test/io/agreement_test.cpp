#include "io/link_header.h"

#include <gtest/gtest.h>

#include "io/admission.h"

namespace limb_ring::link {
namespace {

Agreement some() { return {{1, 2, 3, 4, 5, 6, 7}}; }

TEST(Agreement, ComesBackFromItsBytes) {
  std::array<std::uint8_t, kAgreementSize> bytes{};
  store_agreement(bytes.data(), some());
  EXPECT_EQ(bytes[7], 1);
  EXPECT_EQ(load_agreement(bytes.data()).parts, some().parts);
}

TEST(Agreement, SaysWhichPartsDiffer) {
  EXPECT_EQ(differences(some(), some()), 0u);
  Agreement other = some();
  other.parts[0] = 9;
  EXPECT_EQ(differing_parts(differences(some(), other)), "nodes differ");
  other.parts[2] = 9;
  EXPECT_EQ(differing_parts(differences(some(), other)), "nodes and timeouts differ");
  other.parts[6] = 9;
  EXPECT_EQ(differing_parts(differences(some(), other)), "nodes, timeouts and supervisor differ");
  EXPECT_EQ(differing_parts(2), "redundancy differs");
}

struct OtherFile : testing::Test {
  static constexpr std::uint64_t kOurRing = 7;
  Admission admission{{kOurRing, 3, some()}, {5, 3}, {"neck", "head"}};
  LinkHeader connect;
  Agreement theirs = some();

  void SetUp() override {
    connect.ring = kOurRing;
    connect.sender = 5;
    theirs.parts[2] = 9;
  }
};

TEST_F(OtherFile, IsRefusedWithWhatDiffers) {
  EXPECT_FALSE(admission.judge(connect, some(), {}));
  const auto refuse = admission.judge(connect, theirs, {});
  ASSERT_TRUE(refuse);
  EXPECT_EQ(refuse->refusal, Refusal::other_ring_file);
  EXPECT_EQ(reason_of(*refuse), "it runs another ring file: timeouts differ");
  EXPECT_EQ(why_unfit(connect, *refuse), "it runs another ring file: timeouts differ");
  EXPECT_EQ(admission.label(5), "node 5 (neck)");
}

TEST_F(OtherFile, IsTheReasonAlsoForANodeThatIsNotInOurs) {
  connect.sender = 77;
  EXPECT_EQ(admission.judge(connect, theirs, {})->refusal, Refusal::other_ring_file);
  EXPECT_EQ(admission.judge(connect, some(), {})->refusal, Refusal::not_in_ring);
}

TEST_F(OtherFile, DoesNotHideAnotherVersionOrAnotherRing) {
  connect.ring = 8;
  EXPECT_EQ(admission.judge(connect, theirs, {})->refusal, Refusal::wrong_ring);
  connect.version = 2;
  EXPECT_EQ(admission.judge(connect, theirs, {})->refusal, Refusal::wrong_version);
}

}  // namespace
}  // namespace limb_ring::link
