#include "node/clock_requests.h"

#include <cmath>
#include <limits>
#include <map>

#include "node/request_fields.h"

namespace limb_ring::runtime {
namespace {

using Json = nlohmann::json;
using std::chrono::nanoseconds;

constexpr std::uint64_t kLongest = 1'000'000'000'000'000'000;  // ns, 31 years

Json state_of(const ClockControl& clock) {
  Json state = Json::object();
  add_state(clock, state);
  return state;
}

nanoseconds nanoseconds_in(const Json& request, const std::string& field, std::uint64_t least, std::uint64_t most) {
  if (!request.contains(field)) throw RequestError("'" + field + "' is missing");
  return nanoseconds(static_cast<std::int64_t>(number_in(request, field, 0, least, most)));
}

double pace_in(const Json& request) {
  const auto pace = request.find("pace");
  if (pace != request.end() && *pace == "max") return std::numeric_limits<double>::infinity();
  if (pace == request.end() || !pace->is_number() || !(*pace >= 0.001 && *pace <= 1000))
    throw RequestError("'pace' is missing or out of range; allowed: a number, 0.001 to 1000, or \"max\"");
  return pace->get<double>();
}

void set_pace(ClockControl& clock, const Json& request, const Answer& answer) {
  clock.set_pace(pace_in(request));
  answer(state_of(clock));
}

void pause(ClockControl& clock, const Json&, const Answer& answer) {
  clock.pause();
  answer(state_of(clock));
}

void run(ClockControl& clock, const Json&, const Answer& answer) {
  clock.run();
  answer(state_of(clock));
}

void step(ClockControl& clock, const Json& request, const Answer& answer) {
  clock.step(nanoseconds_in(request, "time_ns", 1, kLongest), [&clock, answer] { answer(state_of(clock)); });
}

void went_on_without(ClockControl& clock, const Json& request, const Answer& answer) {
  const auto whom = request.find("whom");
  if (whom == request.end() || !whom->is_string()) throw RequestError("'whom' is missing or no text");
  clock.went_on_without(whom->get<std::string>());
  answer(Json::object());
}

void allow(ClockControl& clock, const Json& request, const Answer& answer) {
  const nanoseconds until = nanoseconds_in(request, "until_ns", 0, kLongest);
  const auto zero = request.find("outer_zero_ns");
  if (zero == request.end() || !zero->is_number_integer())
    throw RequestError("'outer_zero_ns' is missing or no whole number");
  if (!clock.allow(until, nanoseconds(zero->get<std::int64_t>())))
    throw RequestError("this ring's clock follows no other: 'ringctl up CONFIG --clock follow' has one that does");
  answer(state_of(clock));
}

}  // namespace

bool answer_clock_request(ClockControl* clock, const std::string& what, const Json& request, const Answer& answer) {
  using Handler = void (*)(ClockControl&, const Json&, const Answer&);
  static const std::map<std::string, Handler> handlers{{"allow", allow}, {"pace", set_pace},
                                                       {"pause", pause}, {"run", run},
                                                       {"step", step},   {"went_on_without", went_on_without}};
  const auto handler = handlers.find(what);
  if (handler == handlers.end()) return false;
  if (clock == nullptr)
    throw RequestError(
        "this ring goes by the machine's clock, which nobody can stop or slow down; 'ringctl up CONFIG "
        "--clock virtual' has one of its own");
  handler->second(*clock, request, answer);
  return true;
}

void add_state(const ClockControl& clock, Json& answer) {
  const ClockControl::State state = clock.state();
  answer["now_ns"] = state.now.count();
  answer["pace"] = std::isinf(state.pace) ? Json("max") : Json(state.pace);
  answer["paused"] = state.paused;
  answer["late_s"] = std::chrono::duration<double>(state.late).count();
  answer["lost_s"] = std::chrono::duration<double>(state.lost).count();
  if (!state.follows) return;
  answer["allowed_ns"] = state.allowed.count();
  answer["outer_zero_ns"] = state.outer_zero.count();
}

}  // namespace limb_ring::runtime
