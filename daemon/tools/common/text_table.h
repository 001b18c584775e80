#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::app {

/// Rows with aligned columns, two spaces between them; the first row is the heading. Columns
/// whose cells below the heading all are numbers or '-' are aligned to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// The text cut to `width` columns: its beginning and its end, with '~' between, since similar names differ at either
/// end.
std::string shortened(const std::string& text, std::size_t width);

/// Breaks lines between words so that they fit into `width` columns, unless a word is longer. Continued lines are
/// indented.
std::string wrapped(const std::string& text, std::size_t width);

/// "1 daemon", "2 daemons": a noun whose plural has an s.
std::string counted(std::uint64_t count, const std::string& noun);

/// A number for people: as many decimals as given.
std::string number(double value, int decimals = 1);

/// One row of a report: an object of numbers, words, true/false and null, the same keys in each.
using Row = nlohmann::ordered_json;

enum class Format { text, json, csv };

/// The same rows for people (aligned columns, the keys as heading; null is '-'), as a JSON array,
/// or as CSV with a heading (RFC 4180).
std::string format_rows(const std::vector<Row>& rows, Format format);

/// Whether output there is to be coloured: on a terminal that can, unless NO_COLOR is set
/// (https://no-color.org).
bool colour_wanted(int file);

// Plain ANSI.
constexpr const char* kRed = "\033[31m";
constexpr const char* kYellow = "\033[33m";
constexpr const char* kMagenta = "\033[35m";
constexpr const char* kDim = "\033[2m";
constexpr const char* kChanged = "\033[7m";  ///< light and dark exchanged
constexpr const char* kPlain = "\033[0m";

/// The word as a shell reads it back, whatever is in it: in quotes if it needs them.
std::string shell_word(const std::string& word);

}  // namespace limb_ring::app
