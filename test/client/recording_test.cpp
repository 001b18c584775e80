// The iCub walking recording: 26 joints, positions and velocities, 100 Hz, as the robot gave them.
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/hostile_bytes.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::payload {
namespace {

constexpr std::size_t kJoints = 26;
constexpr std::size_t kFirstPosition = 2;
constexpr std::size_t kFirstVelocity = kFirstPosition + kJoints;
constexpr std::size_t kFirstImu = kFirstVelocity + kJoints;

std::string recording_path() {
  const char* given = std::getenv("LIMB_RING_DATA");
  return std::string(given ? given : LIMB_RING_DATA_DEFAULT) + "/icub_walking/walking.csv";
}

std::vector<double> numbers(const std::string& line) {
  std::vector<double> row;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
  return row;
}

class Recording : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(recording_path());
    if (!file) GTEST_SKIP() << "no recording at " << recording_path() << "; set LIMB_RING_DATA";
    std::string line;
    std::getline(file, line);  // names
    while (std::getline(file, line)) rows.push_back(numbers(line));
    ASSERT_GT(rows.size(), 1000U);
    ASSERT_GE(rows[0].size(), kFirstImu + 6);
  }

  static JointState state_of(const std::vector<double>& row) {
    JointState state;
    for (std::size_t i = 0; i < kJoints; ++i)
      state.joints.push_back({row[kFirstPosition + i], row[kFirstVelocity + i], 0});
    return state;
  }

  std::vector<std::vector<double>> rows;
};

/// Half a step of the joints' resolution, and what a double of this size cannot tell apart.
constexpr double kHalfStep = 0.5e-6 + 1e-12;

/// The nearest double to a decimal number of six places: found through text, not as the codec does.
bool is_whole_micro(double value) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(6);
  text << value;
  return std::stod(text.str()) == value;
}

TEST_F(Recording, JointsCrossExactlyInTheStatedResolution) {
  for (const auto& row : rows) {
    const auto read = decode_joint_state(view(*encode(state_of(row))));
    ASSERT_TRUE(read);
    ASSERT_FALSE(read->mode.saturated);
    for (std::size_t i = 0; i < kJoints; ++i) {
      ASSERT_NEAR(read->joints[i].position, row[kFirstPosition + i], kHalfStep);
      ASSERT_NEAR(read->joints[i].velocity, row[kFirstVelocity + i], kHalfStep);
      ASSERT_TRUE(is_whole_micro(read->joints[i].position));
      ASSERT_TRUE(is_whole_micro(read->joints[i].velocity));
    }
  }
}

TEST_F(Recording, CrossingASecondTimeChangesNothing) {
  for (const auto& row : rows) {
    const auto once = *encode(state_of(row));
    ASSERT_EQ(*encode(*decode_joint_state(view(once))), once);
  }
}

TEST_F(Recording, ImuIsWithinHalfAStep) {
  for (const auto& row : rows) {
    SensorReading reading;
    for (std::size_t i = 0; i < 3; ++i) {
      reading.linear[i] = row[kFirstImu + i];
      reading.angular[i] = row[kFirstImu + 3 + i];
    }
    const auto read = decode_sensor_reading(view(*encode(reading)));
    ASSERT_TRUE(read);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_NEAR(read->linear[i], reading.linear[i], kHalfStep);
      ASSERT_NEAR(read->angular[i], reading.angular[i], kHalfStep);
    }
  }
}

}  // namespace
}  // namespace limb_ring::payload
