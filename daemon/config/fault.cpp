
#include "config/fault.h"

namespace limb_ring::fault {

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
