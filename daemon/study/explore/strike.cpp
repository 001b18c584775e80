#include "study/explore/strike.h"

#include <array>
#include <sstream>
#include <stdexcept>

#include "config/characters.h"

namespace limb_ring::study {

namespace {

constexpr std::array<const char*, 10> kWords{"lost", "header-damaged", "data-damaged", "end-damaged", "doubled",
                                             "late", "restart",        "freeze",       "cut",         "interrupt"};

/// A whole number of at most 6 digits. @throw std::invalid_argument
unsigned number_from(const std::string& text, const std::string& part) {
  if (config::are_digits(text, 6)) return static_cast<unsigned>(std::stoul(text));
  throw std::invalid_argument("'" + part + "': '" + text +
                              "' is no whole number from 0 to 999999, as in 12:lost or 20:restart:1");
}

Choice choice_from(const std::string& part) {
  std::istringstream in(part);
  std::string place, word, node;
  std::getline(in, place, ':');
  std::getline(in, word, ':');
  std::getline(in, node);
  Choice choice;
  choice.place = number_from(place, part);
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (word != kWords[i]) continue;
    choice.strike.kind = static_cast<Strike::Kind>(i);
    if (choice.strike.is_of_node() == node.empty())
      throw std::invalid_argument("'" + part + "': " + word +
                                  (node.empty() ? " needs a node, as in 20:restart:1" : " is of no node"));
    if (!node.empty()) choice.strike.node = static_cast<wire::NodeId>(number_from(node, part));
    return choice;
  }
  std::string allowed;
  for (const char* known : kWords) allowed += std::string(allowed.empty() ? "" : ", ") + known;
  throw std::invalid_argument("'" + part + "': '" + word + "' is none of " + allowed);
}

}  // namespace

const char* to_string(Strike::Kind kind) { return kWords[static_cast<std::size_t>(kind)]; }

std::string to_text(const std::vector<Choice>& choices) {
  std::string text;
  for (const Choice& choice : choices) {
    text += (text.empty() ? "" : ",") + std::to_string(choice.place) + ":" + to_string(choice.strike.kind);
    if (choice.strike.is_of_node()) text += ":" + std::to_string(choice.strike.node);
  }
  return text;
}

std::vector<Choice> choices_from(const std::string& text) {
  std::vector<Choice> choices;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const Choice choice = choice_from(part);
    if (!choices.empty() && choice.place <= choices.back().place)  // its place would be over
      throw std::invalid_argument("'" + part + "': its place is not behind that of the one before it");
    choices.push_back(choice);
  }
  return choices;
}

}  // namespace limb_ring::study
