#include "config/node_row.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace limb_ring::status {
namespace {

using nlohmann::json;

template <class T>
struct IsMaybe : std::false_type {};
template <class T>
struct IsMaybe<Maybe<T>> : std::true_type {};
template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<std::vector<T>> : std::true_type {};
template <class T>
constexpr bool is_counters = std::is_same_v<T, Counters>;
template <class T>
constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_same_v<T, Text>;

/// Calls visit(name, member, In, meaning) for each member, and for each field of a beacon that is shown.
template <class T, class Visit>
void each_shown(T& of, const Visit& visit) {
  T::each(of, [&](const char* name, auto& member, In in, const char* meaning) {
    if constexpr (std::is_same_v<std::decay_t<decltype(member)>, wire::Beacon>)
      wire::Beacon::fields([&](auto field, const wire::Field& of_it) {
        if (of_it.heard != nullptr) visit(of_it.name, member.*field, in, of_it.heard);
      });
    else
      visit(name, member, in, meaning);
  });
}

// ---- to JSON ----------------------------------------------------------------------------------

template <class T>
json written(const T& value);

bool is_number(const Text& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}
json written(const Id& id) { return is_number(id.text) ? json(std::stoull(id.text)) : json(id.text); }

template <class T>
bool is_empty(const T& value) {
  if constexpr (IsMaybe<T>::value)
    return !value.has_value();
  else if constexpr (is_plain<T>)
    return value == T{};
  else
    return false;
}

json written(wire::CpuState state) { return wire::to_string(state); }
json written(wire::LinkState state) { return wire::to_string(state); }
json written(wire::NodeId node) { return static_cast<std::uint8_t>(node); }
json written(const wire::ClockLatch& latch);

template <class T>
json object_of(const T& value) {
  json object = json::object();
  each_shown(value, [&](const char* name, const auto& member, In in, const char*) {
    if (in == In::some && is_empty(member)) return;
    object[name] = written(member);
  });
  return object;
}

template <class T>
json written(const T& value) {
  if constexpr (IsMaybe<T>::value) {
    return value ? written(*value) : json();
  } else if constexpr (IsList<T>::value) {
    json list = json::array();
    for (const auto& one : value) list.push_back(written(one));
    return list;
  } else if constexpr (is_plain<T> || is_counters<T>) {
    return value;
  } else {
    return object_of(value);
  }
}

json written(const wire::ClockLatch& latch) { return written(latch_of(latch)); }

// ---- from JSON --------------------------------------------------------------------------------

/// What is wrong with a member, and which: "" for the value itself, else ".name" or "[].name".
struct Wrong {
  std::string path;
  const char* what = nullptr;  ///< null: nothing
};

template <class T>
Wrong take(const json& from, T& to);

template <class T>
Wrong take_whole(const json& from, T& to) {
  if (!from.is_number_integer()) return {"", "not a whole number"};
  const bool below_0 = !from.is_number_unsigned() && from.get<std::int64_t>() < 0;
  const bool fits = below_0 ? std::is_signed_v<T> &&
                                  from.get<std::int64_t>() >= static_cast<std::int64_t>(std::numeric_limits<T>::min())
                            : from.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<T>::max());
  if (!fits) return {"", "too small or too large"};
  to = from.get<T>();
  return {};
}

template <class T>
Wrong take_plain(const json& from, T& to) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!from.is_boolean()) return {"", "neither true nor false"};
  } else if constexpr (std::is_integral_v<T>) {
    return take_whole(from, to);
  } else if constexpr (std::is_floating_point_v<T>) {
    if (!from.is_number()) return {"", "not a number"};
  } else {
    if (!from.is_string()) return {"", "not a string"};
  }
  to = from.get<T>();
  return {};
}

template <class T>
Wrong take_list(const json& from, std::vector<T>& to) {
  if (!from.is_array()) return {"", "not a list"};
  to.clear();
  for (const json& one : from) {
    const Wrong wrong = take(one, to.emplace_back());
    if (wrong.what != nullptr) return {"[]" + wrong.path, wrong.what};
  }
  return {};
}

Wrong take_id(const json& from, Id& to) {
  if (!from.is_string() && !from.is_number_integer()) return {"", "neither a whole number nor a string"};
  to.text = from.is_string() ? from.get<std::string>() : from.dump();
  return {};
}

Wrong take_counters(const json& from, Counters& to) {
  if (!from.is_object()) return {"", "not an object"};
  for (const auto& [name, value] : from.items())
    if (const Wrong wrong = take(value, to[name]); wrong.what != nullptr) return {".*", wrong.what};
  return {};
}

/// A word, as to_string() has it.
template <class State>
Wrong take_state(const json& from, State last, State& to) {
  for (unsigned i = 0; i <= static_cast<unsigned>(last); ++i)
    if (from == wire::to_string(static_cast<State>(i))) {
      to = static_cast<State>(i);
      return {};
    }
  return {"", from.is_string() ? "not a state that a beacon tells" : "not a string"};
}
Wrong take(const json& from, wire::CpuState& to) { return take_state(from, wire::CpuState::failed, to); }
Wrong take(const json& from, wire::LinkState& to) { return take_state(from, wire::LinkState::folded, to); }

Wrong take(const json& from, wire::NodeId& to) {
  std::uint8_t id = 0;
  const Wrong wrong = take_whole(from, id);
  to = wire::NodeId{id};
  return wrong;
}
Wrong take(const json& from, wire::ClockLatch& to) {
  Latch latch;
  const Wrong wrong = take(from, latch);
  to = {latch.count, wire::NodeId{latch.source}, latch.clock_ns};
  return wrong;
}

template <class T>
Wrong take_object(const json& from, T& to) {
  if (!from.is_object()) return {"", "not an object"};
  Wrong wrong;
  each_shown(to, [&](const char* name, auto& member, In in, const char*) {
    if (wrong.what != nullptr) return;
    const auto found = from.find(name);
    const bool is_there = found != from.end() && !found->is_null();
    if (is_there) wrong = take(*found, member);
    if (!is_there && in == In::always) wrong.what = "missing";
    if (wrong.what != nullptr) wrong.path = '.' + (name + wrong.path);
  });
  return wrong;
}

template <class T>
Wrong take(const json& from, T& to) {
  if constexpr (IsMaybe<T>::value)
    return take(from, to.emplace());
  else if constexpr (IsList<T>::value)
    return take_list(from, to);
  else if constexpr (is_counters<T>)
    return take_counters(from, to);
  else if constexpr (is_plain<T>)
    return take_plain(from, to);
  else if constexpr (std::is_same_v<T, Id>)
    return take_id(from, to);
  else
    return take_object(from, to);
}

template <class T>
std::string read_into(const json& answer, T& to) {
  const Wrong wrong = take(answer, to);
  if (wrong.what == nullptr) return {};
  if (wrong.path.empty()) return std::string("it is ") + wrong.what;
  return "'" + wrong.path.substr(wrong.path.front() == '.' ? 1 : 0) + "' is " + wrong.what;
}

// ---- the page ---------------------------------------------------------------------------------

template <class T>
const char* kind_of(const T&) {
  if constexpr (std::is_same_v<T, bool>) return "truth";
  if constexpr (std::is_integral_v<T>) return "whole number";
  if constexpr (std::is_floating_point_v<T>) return "number";
  if constexpr (std::is_same_v<T, Text> || std::is_enum_v<T>) return "text";
  if constexpr (std::is_same_v<T, Id>) return "whole number or text";
  if constexpr (IsList<T>::value) return "list";
  return "object";
}

const char* words_of(In in) {
  switch (in) {
    case In::always:
    case In::told:
      return "always";
    case In::null:
      return "or null";
    case In::some:
      return "or left out";
  }
  return "";
}

template <class T>
void list_members(const T& value, const std::string& path, std::string& page);

template <class T>
void list_member(const T& member, const std::string& path, In in, const char* meaning, std::string& page) {
  if constexpr (std::is_same_v<T, wire::ClockLatch>) {
    list_member(Latch{}, path, in, meaning, page);
  } else if constexpr (IsMaybe<T>::value) {
    list_member(typename T::value_type{}, path, in, meaning, page);
  } else {
    page += "| `" + path + "` | " + kind_of(member) + " | " + words_of(in) + " | " + meaning + " |\n";
    if constexpr (IsList<T>::value)
      list_members(typename T::value_type{}, path + "[].", page);
    else if constexpr (std::is_class_v<T> && !is_plain<T> && !is_counters<T> && !std::is_same_v<T, Id> &&
                       !std::is_same_v<T, wire::NodeId>)
      list_members(member, path + ".", page);
  }
}

template <class T>
void list_members(const T& value, const std::string& path, std::string& page) {
  each_shown(value, [&](const char* name, const auto& member, In in, const char* meaning) {
    list_member(member, path + name, in, meaning, page);
  });
}

}  // namespace

Latch latch_of(const wire::ClockLatch& latch) { return {latch.count != 0, latch.source, latch.count, latch.clock_ns}; }

json to_json(const NodeRow& row) { return written(row); }
json to_json(const Configured& configured) { return written(configured); }
json to_json(const Latch& latch) { return written(latch); }
json to_json(const RoundTrips& round_trips) { return written(round_trips); }
json to_json(const std::vector<Fault>& faults) { return written(faults); }

std::string read(const json& answer, NodeRow& to) { return read_into(answer, to); }
std::string read(const json& answer, Configured& to) {
  const std::string wrong = read_into(answer, to);
  return wrong.empty() && to.nodes.empty() ? "'nodes' is empty" : wrong;
}
std::string read(const json& answer, Latch& to) { return read_into(answer, to); }
std::string read(const json& answer, std::vector<Fault>& to) { return read_into(answer, to); }

std::string members_of_row() {
  std::string page;
  list_members(NodeRow{}, "", page);
  return page;
}

}  // namespace limb_ring::status
