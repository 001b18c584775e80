#include "ros_bridge/frame_filter.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "config/names.h"
#include "ros_bridge/parameters.h"

namespace limb_ring::bridge {
namespace {

using nlohmann::json;
using XmlRpc::XmlRpcValue;

constexpr int kLimit = 1000;  // frames a second that any reader keeps up with

const std::vector<std::string> kNames{"nodes",    "at",      "kinds",  "source", "destination",
                                      "priority", "channel", "sample", "limit"};

[[noreturn]] void refuse(const std::string& name, const std::string& value, const std::string& right) {
  throw std::invalid_argument("parameter ~frames/" + name + ": " + value + "; it must be " + right);
}

std::string text_of(const std::string& name, XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeString) return static_cast<std::string&>(value);
  if (value.getType() == XmlRpcValue::TypeInt) return std::to_string(static_cast<int&>(value));
  refuse(name, as_written(value), "a word or a number, or a list of them");
}

class Reader {
 public:
  Reader(XmlRpcValue& parameters, const config::RingConfig& ring) : parameters_(parameters), ring_(ring) {}

  std::vector<std::string> words(const std::string& name) const {
    std::vector<std::string> all;
    if (!parameters_.hasMember(name)) return all;
    XmlRpcValue& value = parameters_[name];
    if (value.getType() != XmlRpcValue::TypeArray) return {text_of(name, value)};
    for (int i = 0; i < value.size(); ++i) all.push_back(text_of(name, value[i]));
    return all;
  }

  json among(const std::string& name, const std::vector<std::string>& allowed) const {
    json list = json::array();
    for (const auto& word : words(name)) {
      if (std::find(allowed.begin(), allowed.end(), word) == allowed.end()) refuse(name, word, config::join(allowed));
      list.push_back(word);
    }
    return list;
  }

  const config::NodeConfig& node(const std::string& name, const std::string& word) const {
    if (const auto* found = ring_.find(word)) return *found;
    std::vector<std::string> there{"all"};
    for (const auto& each : ring_.nodes) there.push_back(each.name);
    refuse(name, word, "of: " + config::join(there));
  }

  json nodes(const std::string& name) const {
    json list = json::array();
    for (const auto& word : words(name)) {
      if (word == "all" && name == "destination")
        list.push_back("all");
      else
        list.push_back(node(name, word).id);
    }
    return list;
  }

  /// One named twice would be observed twice, and each of its frames shown twice.
  std::vector<const config::NodeConfig*> observed(const std::string& name) const {
    std::vector<const config::NodeConfig*> nodes;
    for (const auto& word : words(name)) {
      if (word == "all")
        for (const auto& each : ring_.nodes) nodes.push_back(&each);
      else
        nodes.push_back(&node(name, word));
    }
    for (auto each = nodes.begin(); each != nodes.end(); ++each)
      if (std::find(nodes.begin(), each, *each) != each)
        throw std::invalid_argument("parameter ~frames/" + name + ": node '" + (*each)->name + "' is named twice");
    return nodes;
  }

  json numbers(const std::string& name, int most) const {
    json list = json::array();
    for (const auto& word : words(name)) list.push_back(number(name, word, 0, most));
    return list;
  }

  int single(const std::string& name, int otherwise, int least) const {
    const auto all = words(name);
    if (all.empty()) return otherwise;
    if (all.size() > 1) refuse(name, config::join(all), "one number");
    return number(name, all.front(), least, 1000000);
  }

 private:
  static int number(const std::string& name, const std::string& word, int least, int most) {
    std::size_t end = 0;
    int value = -1;
    try {
      value = std::stoi(word, &end);
    } catch (const std::exception&) {
      end = 0;  // said below, with what would be right
    }
    if (end != word.size() || word.empty() || value < least || value > most)
      refuse(name, word, std::to_string(least) + " to " + std::to_string(most));
    return value;
  }

  XmlRpcValue& parameters_;
  const config::RingConfig& ring_;
};

void check_names(XmlRpcValue& parameters) {
  if (parameters.getType() != XmlRpcValue::TypeStruct)
    throw std::invalid_argument("parameter ~frames must be a map of: " + config::join(kNames));
  for (auto& [name, value] : parameters)
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end())
      throw std::invalid_argument("parameter ~frames/" + name + ": there is none; there are " + config::join(kNames));
}

}  // namespace

FrameFilter read_frame_filter(XmlRpcValue parameters, const config::RingConfig& ring, const config::NodeConfig& own) {
  if (!parameters.valid()) parameters.begin();  // nothing was given: an empty map
  check_names(parameters);
  const Reader reader(parameters, ring);
  FrameFilter filter;
  filter.nodes = reader.observed("nodes");
  if (filter.nodes.empty()) filter.nodes.push_back(&own);
  json packets{{"kinds", reader.among("kinds", {"data", "control", "interrupt"})},
               {"source", reader.nodes("source")},
               {"destination", reader.nodes("destination")},
               {"priority", reader.numbers("priority", 3)},
               {"channel", reader.numbers("channel", 63)},
               {"sample", reader.single("sample", 1, 1)},
               {"limit_per_s", reader.single("limit", kLimit, 0)}};
  if (auto at = reader.among("at", {"in", "out"}); !at.empty()) packets["at"] = at;
  filter.order = json{{"packets", packets}}.dump();
  return filter;
}

}  // namespace limb_ring::bridge
