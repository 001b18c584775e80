// Faults as people write them; what is understood is written back as the same fault.
#include "config/fault_parse.h"
#include "config/quantity.h"
#include "fuzz/fuzz.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fault::RingNodes nodes{
      {"a", "1", wire::NodeId{1}}, {"left_hip", "2", wire::NodeId{2}}, {"c", "9", wire::NodeId{9}}};
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const fault::Fault fault = fault::from_words(text, nodes);
    const std::string words = fault::to_words(fault, nodes);
    fuzz::require(fault::to_words(fault::from_words(words, nodes), nodes) == words, "a fault's words are read back");
  } catch (const fault::ParseError& problem) {
    fuzz::require(!problem.problem.empty() && !problem.allowed.empty(), "a problem is named, and what is right");
  }
  if (const auto time = config::parse_time(text))
    fuzz::require(config::parse_time(config::format_time(*time)) == time, "a time is read back");
  if (const auto rate = config::parse_rate(text))
    fuzz::require(config::parse_rate(config::format_rate(*rate)) == rate, "a rate is read back");
  config::parse_real(text);
  config::parse_integer(text);
  return 0;
}
