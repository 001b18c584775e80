// Answers of daemons of another version, or of what is not a ringd: named, and never read.
#include "config/node_row.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tools/ringctl/status_rows.h"
#include "tools/ringctl/top_table.h"
#include "tools/ringctl/wait.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// As a daemon answers that has something to say of everything.
json row() {
  return json::parse(R"({"id": 1, "name": "knee", "state": "up", "pid": 4711, "ring": "r", "ring_size": 2,
    "uptime_s": 12.5, "cpu": {"kind": "child", "pid": 4712, "boots": 1, "state": "running", "hung": false,
    "stop": {"latched": false}}, "input": {"state": "up", "from": 0}, "output": {"state": "up", "to": 0, "rate_bit_s": null},
    "round_trip_us": {"p50": 61.2, "p99": 90.0, "max": 120.4}, "broken_line": {"before": 0, "behind": 1, "since_s": 1.5,
    "announced_ms": 2.5}, "faults": [{"id": 1, "fault": "cut a -> b"}], "refusals": [{"refused": 1, "by": 0, "text": "no"}],
    "counters": {"crc_errors": 1}, "lately_damaged": {"within_s": 10, "oldest_s": 3.2, "crc_errors": 4, "returns_damaged": 1},
    "heard": [{"id": 0, "age_ms": 20, "cpu_state": "running", "cpu_boots": 1, "stop_latched": false, "input": "up",
    "output": "up", "broken_line": {"before": 0, "behind": 1}}], "fold": {"second_input": "down"}, "warnings": [{"rule": "descriptors", "text": "few"}],
    "supervisor": {"policy": "auto", "watched": [{"id": 1, "name": "knee", "verdict": "hung", "last": "reset", "for_ms": 1,
    "hangs": 1, "resets": 1, "confirmed": 1}]}})");
}

/// All that is made of a row.
void show(const status::NodeRow& one) {
  Rows rows{one, one};
  add_verdicts(rows);
  status_table(rows);
  headline("r", rows);
  whole_report(rows);
  lack_of_node(rows[0], 2);
  lack_in_part(rows[0], 2);
  errors_of(rows[0]);
  top_rows({rows, 1}, {rows, 2});
}

std::string wrong_in_row(const json& answer) {
  status::NodeRow row;
  return status::read(answer, row);
}
std::string wrong_in_config(const json& answer) {
  status::Configured config;
  return status::read(answer, config);
}

void change(bool& is) { is = !is; }
void change(wire::NodeId& node) { node = wire::NodeId{7}; }
void change(wire::ClockLatch& latch) { latch = {1, wire::NodeId{2}, 3}; }
template <class T>
void change(T& number) {
  number = static_cast<T>(1);
}

TEST(AnswerShape, AFieldOfABeaconThatARowShowsComesBackUnderItsName) {
  wire::Beacon::fields([](auto member, const wire::Field& field) {
    status::NodeRow one, back;
    change(one.heard.emplace_back().beacon.*member);
    const json told = to_json(one);
    EXPECT_EQ(told["heard"][0].contains(field.name), field.heard != nullptr || field.name == std::string("boot"))
        << field.name;
    ASSERT_EQ(status::read(told, back), "") << field.name;
    EXPECT_EQ(back.heard[0].beacon.*member == one.heard[0].beacon.*member, field.heard != nullptr) << field.name;
  });
}

/// Calls `with` for each change of one member, at any depth: left out, or something else.
template <typename With>
void change_each(json& whole, json& at, With with) {
  const auto change = [&](json& member) {
    const json right = member;
    for (const json& other : {json(), json("text"), json(-1), json(1.5), json(true), json::array(), json::object(),
                              json::array({1}), json::object({{"a", 1}})}) {
      member = other;
      with(whole);
    }
    member = right;
    change_each(whole, member, with);
  };
  if (at.is_array())
    for (json& member : at) change(member);
  if (!at.is_object()) return;
  const json members = at;
  for (const auto& [name, right] : members.items()) {
    change(at[name]);
    at.erase(name);
    with(whole);
    at[name] = right;
  }
}

/// All that is in `part` is in `whole`.
void expect_in(const json& whole, const json& part) {
  if (part.is_object()) {
    for (const auto& [name, member] : part.items()) expect_in(whole.value(name, json("missing: " + name)), member);
  } else if (part.is_array()) {
    for (std::size_t i = 0; i < part.size(); ++i) expect_in(whole.at(i), part[i]);
  } else {
    EXPECT_EQ(whole, part);
  }
}

TEST(AnswerShape, OfARingdIsAccepted) {
  EXPECT_EQ(wrong_in_row(row()), "");
  EXPECT_EQ(wrong_in_config(json::parse(R"({"nodes": [{"id": 0, "name": "a"}], "path": "", "beacon_ms": 100})")), "");
}

TEST(AnswerShape, ThatIsWrongIsNamed) {
  json wrong = row();
  wrong["cpu"]["state"] = 3;
  EXPECT_EQ(wrong_in_row(wrong), "'cpu.state' is not a string");
  wrong = row();
  wrong["heard"][0].erase("id");
  EXPECT_EQ(wrong_in_row(wrong), "'heard[].id' is missing");
  EXPECT_EQ(wrong_in_row(json(3)), "it is not an object");
  EXPECT_EQ(wrong_in_config(json::object()), "'nodes' is missing");
  EXPECT_EQ(wrong_in_config(json::parse(R"({"nodes": [{"id": "a"}]})")), "'nodes[].id' is not a whole number");
  EXPECT_THAT(ask::sentence_of_shape("'id' is missing"), HasSubstr("of one version of limb_ring"));
}

TEST(AnswerShape, IsTheSameReadAndWrittenAgain) {
  status::NodeRow read, again;
  EXPECT_EQ(status::read(row(), read), "");
  const json written = to_json(read);
  EXPECT_EQ(status::read(written, again), "");
  EXPECT_EQ(to_json(again), written);
  expect_in(written, row());
}

TEST(AnswerShape, ANullMemberCountsAsMissing) {
  json bare = row();
  bare["ring_size"] = nullptr;
  status::NodeRow read;
  EXPECT_EQ(status::read(bare, read), "");
  EXPECT_FALSE(read.ring_size);
  bare["name"] = nullptr;
  EXPECT_EQ(wrong_in_row(bare), "'name' is missing");
}

TEST(AnswerShape, ANumberThatDoesNotFitIsNamed) {
  json wrong = row();
  wrong["id"] = 256;
  EXPECT_EQ(wrong_in_row(wrong), "'id' is too small or too large");
  wrong["id"] = -1;
  EXPECT_EQ(wrong_in_row(wrong), "'id' is too small or too large");
}

TEST(AnswerShape, ThatIsRightCanBeShownWhateverElseIsChanged) {
  json changed = row();
  std::size_t refused = 0, shown = 0;
  change_each(changed, changed, [&](const json& answer) {
    status::NodeRow read;
    if (!status::read(answer, read).empty()) return void(++refused);
    ++shown;
    EXPECT_NO_THROW(show(read)) << answer;
  });
  EXPECT_GT(refused, 300u);
  EXPECT_GT(shown, 50u);
}

}  // namespace
}  // namespace limb_ring::ringctl
