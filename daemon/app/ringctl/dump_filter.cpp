#include "app/ringctl/dump_filter.h"

#include <algorithm>

#include "app/ringctl/problems.h"
#include "app/ringctl/ring_access.h"

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

capture::Wish wish_of(const FilterWords& words, const capture::RingNames& names) {
  capture::Wish wish;
  if (!words.at.empty()) {
    wish.filter.input = given(words.at, "in");
    wish.filter.output = given(words.at, "out");
  }
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) wish.filter.kinds[kind] = given(words.kinds, kKinds[kind]);
  for (const std::string& node : words.from) wish.filter.source.set(destination_of(node, names));
  for (const std::string& node : words.to) wish.filter.destination.set(destination_of(node, names));
  for (const unsigned priority : words.priority) wish.filter.priority.set(priority);
  for (const unsigned channel : words.channel) wish.filter.channel.set(channel);
  wish.sample = words.sample;
  wish.limit_per_s = words.limit;
  return wish;
}

json order_of(const capture::Wish& wish) {
  json order{{"at", json::array()},
             {"kinds", json::array()},
             {"source", list_of(wish.filter.source)},
             {"destination", list_of(wish.filter.destination)},
             {"priority", list_of(wish.filter.priority)},
             {"channel", list_of(wish.filter.channel)},
             {"sample", wish.sample},
             {"limit_per_s", wish.limit_per_s}};
  if (wish.filter.input) order["at"].push_back("in");
  if (wish.filter.output) order["at"].push_back("out");
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    if (wish.filter.kinds[kind]) order["kinds"].push_back(kKinds[kind]);
  return order;
}

}  // namespace limb_ring::ringctl
