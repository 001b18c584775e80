#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::app {

/// One row of a report: an object of numbers, words, true/false and null, the same keys in each.
using Row = nlohmann::ordered_json;

enum class Format { text, json, csv };

/// The same rows for people (aligned columns, the keys as heading; null is '-'), as a JSON array,
/// or as CSV with a heading (RFC 4180).
std::string format_rows(const std::vector<Row>& rows, Format format);

}  // namespace limb_ring::app
