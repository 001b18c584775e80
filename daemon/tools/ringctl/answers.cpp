#include "tools/ringctl/answers.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/in_parallel.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kAnswerTick{50};

[[noreturn]] void no_answer(const HostPort& port, milliseconds timeout) {
  require_clock_goes(port.ring());
  throw HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() +
                      " did not answer within " + std::to_string(timeout.count()) + " ms");
}

nlohmann::json checked(const HostPort& port, const std::string& text) {
  const nlohmann::json answer = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!answer.is_object())
    throw HostPortError("node " + label({port.id(), port.name()}) + ": " +
                        sentence_of_shape("it is not a JSON object"));
  if (!answer.contains("error") || !answer["error"].is_string()) return answer;
  const std::string problem = answer["error"].get<std::string>();
  if (!port.connected()) throw gone(port, problem);  // not the daemon's word, but that of the connection to it
  throw NotDone(problem);
}

/// Connecting and the answer together take no longer than an answer may.
Answer ask_one(const std::string& ring, const NodeName& node, const nlohmann::json& request, Deadline all_by) {
  const auto begun = steady_clock::now(), deadline = std::min(all_by, begun + kAnswerTime);
  if (deadline <= begun) return {std::nullopt, "it was not asked: no time was left"};
  if (live::is_frozen(ring_directory(ring), node.id)) return {};  // it would let us wait
  try {
    const auto time = std::chrono::ceil<milliseconds>(deadline - begun);
    HostPort port = connect_within(time, ring, std::to_string(node.id), Stay::asks_only);
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    return {checked(port, port.reply(port.request(request.dump()), std::max(left, milliseconds(0)))), ""};
  } catch (const std::exception& problem) {
    return {std::nullopt, problem.what()};
  }
}

}  // namespace

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout) {
  Progress progress(port.ring());
  return ask(port, request, timeout, [&] { progress.tell("waiting for node " + label({port.id(), port.name()})); });
}

nlohmann::json ask(HostPort& port, const nlohmann::json& request, milliseconds timeout,
                   const std::function<void()>& tick) {
  const auto deadline = steady_clock::now() + timeout;
  const std::uint32_t token = port.request(request.dump());
  while (steady_clock::now() < deadline) {
    const auto message = port.receive(kAnswerTick);
    if (!message)
      tick();
    else if (const auto* reply = std::get_if<Reply>(&*message); reply && reply->token == token)
      return checked(port, reply->json);
    else if (const auto* end = std::get_if<Disconnected>(&*message))
      throw gone(port, end->reason);
  }
  no_answer(port, timeout);
}

std::vector<Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes, const nlohmann::json& request,
                            Deadline deadline) {
  std::vector<Answer> answers(nodes.size());
  // A daemon that is stopped takes its whole time-out.
  process::in_parallel(nodes.size(), kAskers,
                       [&](std::size_t i) { answers[i] = ask_one(ring, nodes[i], request, deadline); });
  return answers;
}

using nlohmann::json;

namespace {

enum class Kind : std::uint8_t { text, number, whole, truth, object, list, any };
enum class If : std::uint8_t { there, needed, null };  ///< null: needed, but it may be null

struct Member {
  const char* path;  ///< "heard[].id": of each in that list; "counters.*": of each member
  Kind kind;
  If needed = If::there;
};

constexpr Member kOfConfig[] = {
    {"nodes", Kind::list, If::needed},
    {"nodes[].id", Kind::whole, If::needed},
    {"nodes[].name", Kind::text, If::needed},
    {"nodes[].host", Kind::text},
    {"hosts", Kind::list},
    {"hosts[].name", Kind::text},
    {"hosts[].address", Kind::text},
    {"hosts[].ssh", Kind::text},
    {"path", Kind::text},
    {"folds_back", Kind::truth},
    {"beacon_ms", Kind::number},
};

constexpr Member kOfRow[] = {
    {"id", Kind::whole, If::needed},
    {"name", Kind::text, If::needed},
    {"state", Kind::text, If::needed},
    {"ring", Kind::text},
    {"ring_size", Kind::whole},
    {"uptime_s", Kind::number},
    {"warnings", Kind::list},
    {"warnings[].rule", Kind::text, If::needed},
    {"warnings[].text", Kind::text, If::needed},
    {"cpu", Kind::object, If::needed},
    {"cpu.state", Kind::text, If::needed},
    {"cpu.kind", Kind::text},
    {"cpu.boots", Kind::whole},
    {"cpu.stopped", Kind::truth},
    {"cpu.stop", Kind::object},
    {"cpu.stop.latched", Kind::truth},
    {"input", Kind::object},
    {"input.from", Kind::whole, If::null},
    {"output", Kind::object},
    {"round_trip_us", Kind::object},
    {"broken_line", Kind::object, If::null},
    {"broken_line.before", Kind::whole, If::needed},
    {"broken_line.behind", Kind::whole, If::needed},
    {"broken_line.since_s", Kind::number},
    {"broken_line.announced_ms", Kind::number},
    {"faults", Kind::list},
    {"faults[].id", Kind::any, If::needed},
    {"faults[].fault", Kind::text, If::needed},
    {"refusals", Kind::list},
    {"refusals[].refused", Kind::whole, If::needed},
    {"refusals[].by", Kind::whole, If::needed},
    {"refusals[].text", Kind::text, If::needed},
    {"counters", Kind::object},
    {"counters.*", Kind::whole},
    {"lately_damaged", Kind::object},
    {"lately_damaged.within_s", Kind::number, If::needed},
    {"lately_damaged.oldest_s", Kind::number},
    {"lately_damaged.crc_errors", Kind::whole},
    {"lately_damaged.returns_damaged", Kind::whole},
    {"heard", Kind::list},
    {"heard[].id", Kind::whole, If::needed},
    {"heard[].age_ms", Kind::number, If::needed},
    {"heard[].cpu_state", Kind::text},
    {"heard[].cpu_boots", Kind::whole},
    {"heard[].stop_latched", Kind::truth},
    {"heard[].input", Kind::text},
    {"heard[].output", Kind::text},
    {"heard[].broken_line.before", Kind::whole, If::needed},
    {"heard[].broken_line.behind", Kind::whole, If::needed},
    {"fold", Kind::object},
    {"fold.second_input", Kind::text, If::needed},
    {"supervisor", Kind::object},
    {"supervisor.policy", Kind::text, If::needed},
    {"supervisor.watched", Kind::list, If::needed},
    {"supervisor.watched[].id", Kind::whole, If::needed},
    {"supervisor.watched[].name", Kind::text, If::needed},
    {"supervisor.watched[].verdict", Kind::text, If::needed},
    {"supervisor.watched[].last", Kind::text, If::needed},
    {"supervisor.watched[].for_ms", Kind::number, If::needed},
    {"supervisor.watched[].hangs", Kind::whole, If::needed},
    {"supervisor.watched[].resets", Kind::whole, If::needed},
    {"supervisor.watched[].confirmed", Kind::whole, If::needed},
};

bool is(const json& value, Kind kind) {
  switch (kind) {
    case Kind::text:
      return value.is_string();
    case Kind::number:
      return value.is_number();
    case Kind::whole:
      return value.is_number_integer();
    case Kind::truth:
      return value.is_boolean();
    case Kind::object:
      return value.is_object();
    case Kind::list:
      return value.is_array();
    case Kind::any:
      return true;
  }
  return true;
}

const char* words_of(Kind kind) {
  switch (kind) {
    case Kind::text:
      return "not a string";
    case Kind::number:
      return "not a number";
    case Kind::whole:
      return "not a whole number";
    case Kind::truth:
      return "neither true nor false";
    case Kind::object:
      return "not an object";
    default:
      return "not a list";
  }
}

/// Of the member of `at` by what is left of its path. Where `at` is no object or list, the entry of that says so.
/// @return what is wrong: "missing", "not a string" ...; null: nothing
const char* wrong_at(const json& at, std::string_view path, const Member& member) {
  if (path.empty()) {
    if (at.is_null() && member.needed == If::null) return nullptr;
    return is(at, member.kind) ? nullptr : words_of(member.kind);
  }
  const bool each = path.substr(0, 2) == "[]" || path.front() == '*';
  if (path.front() == '.') return wrong_at(at, path.substr(1), member);
  if (each) {
    if (!at.is_structured()) return nullptr;
    const std::string_view rest = path.substr(path.front() == '*' ? 1 : 2);
    for (const json& one : at) {
      if (!rest.empty() && !one.is_object()) return "in no object";
      if (const char* wrong = wrong_at(one, rest, member)) return wrong;
    }
    return nullptr;
  }
  if (!at.is_object()) return nullptr;
  const std::size_t end = std::min(path.find_first_of(".["), path.size());
  const auto found = at.find(path.substr(0, end));
  if (found != at.end()) return wrong_at(*found, path.substr(end), member);
  return end == path.size() && member.needed != If::there ? "missing" : nullptr;
}

template <std::size_t count>
std::string wrong_in(const json& answer, const Member (&members)[count]) {
  if (!answer.is_object()) return "it is not an object";
  for (const Member& member : members)
    if (const char* wrong = wrong_at(answer, member.path, member))
      return "'" + std::string(member.path) + "' is " + wrong;
  return {};
}

}  // namespace

std::string wrong_in_row(const json& row, std::uint8_t node) {
  const std::string wrong = wrong_in(row, kOfRow);
  if (!wrong.empty() || row["id"] == node) return wrong;
  return "it says that it is node " + row["id"].dump();
}

std::string wrong_in_config(const json& config) {
  const std::string wrong = wrong_in(config, kOfConfig);
  return wrong.empty() && config["nodes"].empty() ? "'nodes' is empty" : wrong;
}

std::string sentence_of_shape(const std::string& wrong) {
  return "unexpected reply from its daemon: " + wrong +
         "; both have to be of one version of limb_ring ('ringctl down' and 'ringctl up' start this one's)";
}

}  // namespace limb_ring::ringctl
