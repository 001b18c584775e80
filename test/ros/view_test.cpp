#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "config/load_ring.h"
#include "ros/small_robot.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/ring_picture.h"

namespace limb_ring::bridge {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using visualization_msgs::Marker;

std::string humanoid_urdf() {
  std::ostringstream text;
  text << std::ifstream(LIMB_RING_URDF_DIR "/humanoid16.urdf").rdbuf();
  return text.str();
}

RingStatus well(const config::RingConfig& ring) {
  RingStatus status;
  for (std::size_t i = 0; i < ring.nodes.size(); ++i) {
    NodeStatus node = unheard_node(ring.nodes[i]);
    node.state = "up";
    node.cpu_state = "running";
    node.output_to = ring.nodes[(i + 1) % ring.nodes.size()].id;
    node.pid = 1;
    status.nodes.push_back(node);
  }
  return status;
}

std::vector<Marker> of(const std::string& space, const std::vector<Marker>& markers) {
  std::vector<Marker> found;
  for (const auto& marker : markers)
    if (marker.ns == space) found.push_back(marker);
  return found;
}

class Picture : public ::testing::Test {
 protected:
  std::vector<Marker> draw() const { return RingPicture(ring).markers(status, load); }
  const config::RingConfig ring = small_robot();  // body 0, knee 7, hip 3
  RingStatus status = well(ring);
  LineLoad load;
};

TEST_F(Picture, ShowsEveryNodeAndLineOfAWholeRing) {
  EXPECT_EQ(of("nodes", draw()).size(), 3u);
  EXPECT_EQ(of("lines", draw()).size(), 3u);
  EXPECT_THAT(of("breaks", draw()), IsEmpty());
  EXPECT_THAT(of("bypasses", draw()), IsEmpty());
  EXPECT_EQ(of("nodes", draw()).front().color, colour_of(Condition::well));
}

TEST_F(Picture, ColoursANodeByItsCondition) {
  status.nodes[1].state = "down";
  EXPECT_EQ(of("nodes", draw())[1].color, colour_of(Condition::down));
  status.nodes[1] = well(ring).nodes[1];
  status.nodes[1].cpu_state = "silent";
  EXPECT_EQ(of("nodes", draw())[1].color, colour_of(Condition::hung));
  status.nodes[1].cpu_state = "running";
  status.silent_joints = {"knee_pitch"};
  EXPECT_EQ(of("nodes", draw())[1].color, colour_of(Condition::hung));
  status.silent_joints.clear();
  status.nodes[1].state = "open_chain";
  EXPECT_EQ(of("nodes", draw())[1].color, colour_of(Condition::unclear));
}

TEST_F(Picture, MarksABreakBetweenItsNodes) {
  status.nodes[0].broken_before = 7;
  status.nodes[0].broken_behind = 3;
  const auto breaks = of("breaks", draw());
  ASSERT_EQ(breaks.size(), 1u);
  EXPECT_EQ(breaks.front().id, 7);
  EXPECT_EQ(of("lines", draw())[1].color, colour_of(Condition::down));
}

TEST_F(Picture, LeadsPastABypassedNode) {
  status.nodes[0].output_to = 3;
  const auto bypasses = of("bypasses", draw());
  ASSERT_EQ(bypasses.size(), 1u);
  EXPECT_EQ(bypasses.front().id, 0);
}

// As is a foreign one, or one of another host.
TEST_F(Picture, LeadsOnFromANodeWithoutADaemonHereByWhatTheNodeBehindItSays) {
  status.nodes[1].pid = 0;
  status.nodes[1].output_to = -1;
  const auto unknown = of("lines", draw())[1].color;
  status.nodes[2].input_from = 7;
  EXPECT_EQ(of("lines", draw())[1].color, of("lines", draw())[0].color);
  EXPECT_NE(of("lines", draw())[1].color, unknown);
}

TEST_F(Picture, TellsTheRoundTrip) {
  status.nodes[2].round_trip_p50 = 61.4e-6;
  EXPECT_EQ(of("names", draw())[2].text, "hip\n61 us");
  status.nodes[2].stopped = true;
  EXPECT_EQ(of("names", draw())[2].text, "hip\nstopped\n61 us");
  status.nodes[2].stopped = false;
  status.nodes[2].state = "down";
  EXPECT_EQ(of("names", draw())[2].text, "hip\ndown");
}

TEST_F(Picture, KnowsALoadFromTwoSamples) {
  status.nodes[1].counter_names = {"input_bytes", "input_slices"};
  status.nodes[1].counter_values = {1000, 10};
  status.nodes[0].output_rate = 80000;
  load.take(status);
  EXPECT_EQ(load.of(7), std::nullopt);
  status.header.stamp += ros::Duration(1.0);
  status.nodes[1].counter_values = {6400, 110};  // 5000 bytes and a hundred slice headers
  load.take(status);
  EXPECT_DOUBLE_EQ(*load.of(7), 0.5);
  status.nodes[1].pid = 2;  // another daemon counts from 0
  status.header.stamp += ros::Duration(1.0);
  load.take(status);
  EXPECT_EQ(load.of(7), std::nullopt);
}

TEST_F(Picture, KnowsALoadInEachLoopOfABag) {
  status.nodes[1].counter_names = {"input_bytes"};
  status.nodes[0].output_rate = 80000;
  const auto played = [this](double at, std::uint64_t bytes) {
    status.header.stamp = ros::Time(at);
    status.nodes[1].counter_values = {bytes};
    load.take(status);
  };
  played(100, 1000);
  played(200, 1001000);
  EXPECT_DOUBLE_EQ(*load.of(7), 1.0);
  played(100, 1000);
  EXPECT_EQ(load.of(7), std::nullopt);
  played(101, 6000);
  EXPECT_DOUBLE_EQ(*load.of(7), 0.5);
}

TEST(Limbs, AreMarkedInTheirFramesIfTheirNodeIsDown) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/humanoid16.yaml");
  const LimbMarks limbs(ring, humanoid_urdf());
  EXPECT_EQ(limbs.root(), "base_link");
  RingStatus status = well(ring);
  EXPECT_THAT(limbs.markers(status), IsEmpty());
  status.nodes[10].state = "open_chain";
  EXPECT_THAT(limbs.markers(status), IsEmpty());
  status.nodes[11].state = "down";
  std::vector<std::string> frames;
  for (const auto& marker : of("limbs of left_ankle", limbs.markers(status))) {
    frames.push_back(marker.header.frame_id);
    EXPECT_GT(marker.color.r, marker.color.g);
  }
  EXPECT_THAT(frames, ElementsAre("l_ankle_pitch_link", "l_ankle_roll_link"));
}

TEST(Limbs, AreAbsentWithoutARobotAndAnErrorForAnInvalidDescription) {
  const auto ring = small_robot();
  EXPECT_THAT(LimbMarks(ring, "").markers(RingStatus()), IsEmpty());
  EXPECT_THROW(LimbMarks(ring, "<robot/>"), std::invalid_argument);
}

}  // namespace
}  // namespace limb_ring::bridge
