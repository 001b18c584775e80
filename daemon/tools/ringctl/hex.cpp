#include "tools/ringctl/hex.h"

#include <cctype>

#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

namespace {

bool passed_over(char c) { return c == ' ' || c == ':'; }

std::string digits_of(const std::string& text) {
  std::string digits;
  const std::size_t begin = text.rfind("0x", 0) == 0 ? 2 : 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (passed_over(text[i])) continue;
    if (std::isxdigit(static_cast<unsigned char>(text[i])) == 0)
      throw UsageError("--hex: '" + std::string(1, text[i]) + "' at position " + std::to_string(i + 1) +
                       " is not a hexadecimal digit (0-9, a-f)");
    digits += text[i];
  }
  return digits;
}

}  // namespace

std::vector<std::uint8_t> parse_hex(const std::string& text) {
  const std::string digits = digits_of(text);
  if (digits.size() % 2 != 0)
    throw UsageError("--hex: " + std::to_string(digits.size()) +
                     " digits; a byte has two, so their number must be even");
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

}  // namespace limb_ring::ringctl
