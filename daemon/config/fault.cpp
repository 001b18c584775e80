#include "config/fault.h"

namespace limb_ring::fault {

std::optional<Node> after(Name fault, Node node) {
  if (fault == Name::step_clock) return node;  // it is the host's, whatever runs there
  if (fault == Name::start || node == Node::dead)
    return fault == Name::start && node == Node::dead ? std::optional(Node::runs) : std::nullopt;
  if (fault == Name::kill) return Node::dead;
  if (freezes(fault)) return Node::frozen;
  if (fault == Name::power_cycle && node == Node::frozen) return std::nullopt;
  return Node::runs;  // thaw, power_cycle
}

std::vector<std::string> words() {
  std::vector<std::string> all;
  for (const Word& word : kWords) all.emplace_back(word.word);
  return all;
}

const Word* find_word(const std::string& word) {
  for (const Word& known : kWords)
    if (word == known.word) return &known;
  return nullptr;
}

}  // namespace limb_ring::fault
