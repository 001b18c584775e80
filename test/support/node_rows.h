#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "config/node_row.h"

namespace limb_ring::test {

/// A status row, read from JSON that may leave out what every row has.
inline status::NodeRow node_row(const nlohmann::json& members) {
  nlohmann::json whole{{"id", 0}, {"name", ""}, {"state", ""}, {"cpu", {{"state", ""}}}};
  whole.merge_patch(members);
  status::NodeRow row;
  EXPECT_EQ(status::read(whole, row), "") << members;
  return row;
}

inline std::vector<status::NodeRow> node_rows(const std::vector<nlohmann::json>& all) {
  std::vector<status::NodeRow> rows;
  for (const nlohmann::json& one : all) rows.push_back(node_row(one));
  return rows;
}

}  // namespace limb_ring::test
