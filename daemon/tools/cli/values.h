#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace limb_ring::cli {

/// @name What an option's value may be, for `->transform(...)`
/// Numbers are taken as people write them (config/quantity.h) and refused in plain words.
///@{
/// A whole number, also 1e6 or 64k.
CLI::Validator whole(std::int64_t least, std::int64_t most);
/// A number, also 1e-3.
CLI::Validator real(double least, double most);
/// A time for an option that holds seconds: 5ms, 2s; a plain number is seconds. In seconds.
CLI::Validator seconds(double least, double most);
/// The same to the nanosecond, for an option that holds nanoseconds.
CLI::Validator nanoseconds(std::chrono::nanoseconds least, std::chrono::nanoseconds most);
/// Time of a virtual clock per real time: a number, or max, which is infinite.
CLI::Validator pace();
/// One of these words.
CLI::Validator one_of(std::vector<std::string> words);
///@}

/// A word that stands for a value of an enumeration.
template <typename Enum>
CLI::Validator word_of(const std::map<std::string, Enum>& values) {
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  CLI::Validator validator = one_of(words);
  return CLI::Validator(
      [validator, values](std::string& text) {
        const std::string wrong = validator(text);
        if (wrong.empty()) text = std::to_string(static_cast<int>(values.at(text)));
        return wrong;
      },
      "");
}

}  // namespace limb_ring::cli
