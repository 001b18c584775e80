#include "tools/ringctl/dump_filter.h"

#include <algorithm>

#include "tools/ringctl/problems.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

namespace {

using nlohmann::json;

bool given(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

template <std::size_t N>
json list_of(const std::bitset<N>& set) {
  json list = json::array();
  for (std::size_t i = 0; i < N; ++i)
    if (set[i]) list.push_back(i);
  return list;
}

wire::NodeId destination_of(const std::string& word, const capture::RingNames& names) {
  return word == "all" ? wire::kBroadcast : node_of(word, names);
}

}  // namespace

wire::NodeId node_of(const std::string& word, const capture::RingNames& names) {
  for (const auto& [id, name] : names.nodes)
    if (word == name || word == std::to_string(id)) return id;
  std::vector<NodeName> nodes;
  for (const auto& [id, name] : names.nodes) nodes.push_back({id, name});
  throw unknown_node(word, names.ring, nodes);
}

capture::Choice choice_of(const FilterWords& words, const capture::RingNames& names) {
  capture::Choice choice;
  if (!words.at.empty()) {
    choice.filter.input = given(words.at, "in");
    choice.filter.output = given(words.at, "out");
  }
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) choice.filter.kinds[kind] = given(words.kinds, kKinds[kind]);
  for (const std::string& node : words.from) choice.filter.source.set(destination_of(node, names));
  for (const std::string& node : words.to) choice.filter.destination.set(destination_of(node, names));
  for (const unsigned priority : words.priority) choice.filter.priority.set(priority);
  for (const unsigned channel : words.channel) choice.filter.channel.set(channel);
  choice.sample = words.sample;
  choice.limit_per_s = words.limit;
  return choice;
}

json order_of(const capture::Choice& choice) {
  json order{{"at", json::array()},
             {"kinds", json::array()},
             {"source", list_of(choice.filter.source)},
             {"destination", list_of(choice.filter.destination)},
             {"priority", list_of(choice.filter.priority)},
             {"channel", list_of(choice.filter.channel)},
             {"sample", choice.sample},
             {"limit_per_s", choice.limit_per_s}};
  if (choice.filter.input) order["at"].push_back("in");
  if (choice.filter.output) order["at"].push_back("out");
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    if (choice.filter.kinds[kind]) order["kinds"].push_back(kKinds[kind]);
  return order;
}

}  // namespace limb_ring::ringctl
