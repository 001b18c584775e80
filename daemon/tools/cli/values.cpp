#include "tools/cli/values.h"

#include <cmath>

#include "config/names.h"
#include "config/quantity.h"

namespace limb_ring::cli {

namespace {

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

std::string range(const std::string& least, const std::string& most) { return least + " to " + most; }

std::optional<double> seconds_in(const std::string& text) {
  if (const auto plain = config::parse_real(text)) return plain;
  const auto time = config::parse_time(text);
  if (!time) return std::nullopt;
  return std::chrono::duration<double>(*time).count();
}

std::string time_text(double seconds) {
  return config::format_time(std::chrono::nanoseconds(std::llround(seconds * 1e9)));
}

std::string time_range(const std::string& least, const std::string& most) {
  return "a time, " + range(least, most) + ": 500ms, 2s, or a number of seconds";
}

/// As CLI11 reads it back, to the nanosecond.
std::string digits(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

CLI::Validator whole(std::int64_t least, std::int64_t most) {
  const std::string allowed = "a whole number, " + range(std::to_string(least), std::to_string(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_integer(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = std::to_string(*value);
        return {};
      },
      "");
}

CLI::Validator real(double least, double most) {
  const std::string allowed = "a number, " + range(config::format_real(least), config::format_real(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_real(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = digits(*value);
        return {};
      },
      "");
}

CLI::Validator pace() {
  return CLI::Validator(
      [number = real(0.001, 1000)](std::string& text) -> std::string {
        const std::string wrong = text == "max" ? "" : number(text);
        if (text == "max") text = "inf";
        return wrong.empty() ? "" : wrong + ", or max";
      },
      "");
}

CLI::Validator seconds(double least, double most) {
  const std::string allowed = time_range(time_text(least), time_text(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = seconds_in(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = digits(*value);
        return {};
      },
      "");
}

CLI::Validator nanoseconds(std::chrono::nanoseconds least, std::chrono::nanoseconds most) {
  const std::string allowed = time_range(config::format_time(least), config::format_time(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_time(config::parse_real(text) ? text + "s" : text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = std::to_string(value->count());
        return {};
      },
      "");
}

CLI::Validator one_of(std::vector<std::string> words) {
  return CLI::Validator(
      [words = std::move(words)](std::string& text) -> std::string {
        for (const std::string& word : words)
          if (word == text) return {};
        const std::string meant = config::closest(text, words);
        return in_quotes(text) + " is unknown" + (meant.empty() ? "; " : ", did you mean '" + meant + "'? ") +
               "allowed: " + config::join(words);
      },
      "");
}

}  // namespace limb_ring::cli
