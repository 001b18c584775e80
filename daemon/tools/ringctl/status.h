#pragma once

#include <optional>
#include <string>

#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

struct StatusStyle {
  std::size_t width = std::string::npos;  ///< columns there are; names are shortened to fit
  bool pids = false;                      ///< process numbers too
  bool colour = false;
};

/// Status rows, one line each, for people.
std::string status_table(const Rows& rows, const StatusStyle& style = {});

/// Red for a node that is not up, yellow for a CPU that should run and does not, else none (an empty text).
const char* status_colour(const std::string& state, const std::string& cpu);

/// Microseconds for people: a decimal only where it says something; "-" for none.
std::string us_cell(std::optional<double> us);

}  // namespace limb_ring::ringctl
