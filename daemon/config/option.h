#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "config/entry.h"
#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::config {

constexpr const char* kRequired = "required";

/// One entry that a map of the configuration may hold: read, checked and documented from here,
/// and nowhere else. T is the struct it belongs to, whose initial values are the defaults.
template <typename T>
struct Option {
  std::string name;
  std::string fallback;  ///< as it would stand in the file, or kRequired
  std::string allowed;
  std::string meaning;
  std::function<void(const Entry&, T&)> read;
};

/// All entries of one map, in the order in which they are read.
template <typename T>
using Section = std::vector<Option<T>>;

template <typename T>
std::vector<std::string> names_of(const Section<T>& section) {
  std::vector<std::string> names;
  for (const Option<T>& option : section) names.push_back(option.name);
  return names;
}

/// Refuses what a map may not hold, and what it must; all of it at once.
void check_names(const Entry& map, const std::vector<std::string>& allowed, const std::vector<std::string>& required);

/// Reads a map into `object`. What is not in the map keeps its value.
/// @throw ConfigError for all that is wrong in it
template <typename T>
void read_section(const Entry& map, const Section<T>& section, T& object) {
  std::vector<std::string> required;
  for (const Option<T>& option : section)
    if (option.fallback == kRequired) required.push_back(option.name);
  Problems problems;
  problems.gather([&] { check_names(map, names_of(section), required); });
  for (const Option<T>& option : section)
    if (const auto entry = map.find(option.name)) problems.gather([&] { option.read(*entry, object); });
  problems.refuse_all();
}

template <typename T, typename V>
Option<T> integer_option(const char* name, V T::*member, IntegerRange range, const char* meaning) {
  return {name, std::to_string(T{}.*member), allowed(range), meaning,
          [=](const Entry& entry, T& object) { object.*member = static_cast<V>(read_integer(entry, range)); }};
}

template <typename T>
Option<T> real_option(const char* name, double T::*member, RealRange range, const char* meaning) {
  return {name, format_real(T{}.*member), allowed(range), meaning,
          [=](const Entry& entry, T& object) { object.*member = read_real(entry, range); }};
}

/// Written with a unit; stored in the unit of the member (V), and must be a whole number of it.
template <typename T, typename V>
Option<T> time_option(const char* name, V T::*member, std::chrono::nanoseconds least, std::chrono::nanoseconds most,
                      const char* meaning) {
  const TimeRange range{least, most, V{1}};
  return {name, format_time(T{}.*member), allowed(range), meaning, [=](const Entry& entry, T& object) {
            object.*member = std::chrono::duration_cast<V>(read_time(entry, range));
          }};
}

/// `deadline` of a stream, for plans.
template <typename T>
Option<T> deadline_option() {
  const TimeRange range{std::chrono::microseconds(1), std::chrono::seconds(3600), std::chrono::nanoseconds(1)};
  return {"deadline", "its period", allowed(range),
          "Only for `ring_sim plan`: a message that may take longer than this, from its send to its delivery, is "
          "late, and the plan fails.",
          [=](const Entry& entry, T& object) { object.deadline = read_time(entry, range); }};
}

template <typename T>
Option<T> rate_option(const char* name, std::uint64_t T::*member, const char* meaning) {
  return {name, format_rate(T{}.*member), kAllowedRates, meaning,
          [=](const Entry& entry, T& object) { object.*member = read_rate(entry); }};
}

template <typename T>
Option<T> flag_option(const char* name, bool T::*member, const char* meaning) {
  return {name, T{}.*member ? "true" : "false", "true, false", meaning,
          [=](const Entry& entry, T& object) { object.*member = read_flag(entry); }};
}

/// `words` in the order of the enum's values, which count from 0.
template <typename T, typename E>
Option<T> choice_option(const char* name, E T::*member, std::vector<std::string> words, const char* meaning) {
  const std::string fallback = words[static_cast<std::size_t>(T{}.*member)];
  const std::string all = join(words);
  return {name, fallback, all, meaning,
          [=](const Entry& entry, T& object) { object.*member = static_cast<E>(read_choice(entry, words)); }};
}

template <typename T>
Option<T> name_option(const char* name, std::string T::*member, bool (*fits)(const std::string&), const char* rule,
                      const char* fallback, const char* meaning) {
  return {name, fallback, rule, meaning,
          [=](const Entry& entry, T& object) { object.*member = read_name(entry, fits, rule); }};
}

template <typename T>
Option<T> node_option(const char* name, std::uint8_t T::*member, const char* meaning) {
  return {name, kRequired, "id or name of a node", meaning,
          [=](const Entry& entry, T& object) { object.*member = read_node(entry); }};
}

/// A map with a section of its own.
template <typename T, typename V>
Option<T> section_option(const char* name, V T::*member, const Section<V>& section, const char* meaning) {
  return {name, "{}", "a map, see below", meaning,
          [=](const Entry& entry, T& object) { read_section(entry, section, object.*member); }};
}

/// A list of maps with a section of their own, at most `most`. `complete` sees each when it is read.
template <typename T, typename V>
Option<T> list_option(const char* name, std::vector<V> T::*member, const Section<V>& section, std::size_t most,
                      void (*complete)(const Entry&, V&), const char* meaning) {
  const std::string rule = "a list of up to " + std::to_string(most) + " maps";
  return {name, "[]", rule + ", see below", meaning, [=](const Entry& entry, T& object) {
            Problems problems;
            for (const Entry& item : entry.items(rule, most))
              problems.gather([&] {
                V value;
                read_section(item, section, value);
                complete(item, value);
                (object.*member).push_back(std::move(value));
              });
            problems.refuse_all();
          }};
}

/// Every entry of a ring's file with default, what is allowed, and meaning, as Markdown: what
/// `ringd --options` prints, and config/OPTIONS.md.
std::string options_markdown();

}  // namespace limb_ring::config
