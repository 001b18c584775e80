#include "tools/ringctl/refusal_counters.h"

#include <array>
#include <set>

#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

namespace {

struct Counter {
  const char* name;
  Reason reason;
};
constexpr std::array<Counter, 4> kCounters{{{"refused_cpu_absent", Reason::cpu_absent},
                                            {"refused_no_buffer", Reason::no_buffer},
                                            {"refused_joining", Reason::joining},
                                            {"refused_unwired", Reason::pin_unwired}}};

/// The counter of refusals does not say whether a missing CPU is absent, boots or has failed; the CPU's state does.
Reason refined(Reason reason, const nlohmann::json& row) {
  if (!row.contains("cpu")) return reason;
  const std::string state = row["cpu"].value("state", "");
  if (reason == Reason::cpu_absent && state == "booting") return Reason::cpu_booting;
  if (reason == Reason::cpu_absent && state == "failed") return Reason::cpu_failed;
  if (reason == Reason::no_buffer && state == "silent") return Reason::cpu_silent;
  return reason;
}

}  // namespace

void RefusalCounters::explain(std::vector<Result>& results, const std::vector<ask::Node>& nodes,
                              const ask::Rows& now) const {
  std::set<Reason> reasons;
  std::string where;
  for (const auto& [id, row] : now) {
    const auto then = before_.find(id);
    if (then == before_.end()) continue;
    for (const Counter& counter : kCounters) {
      if (counter_of(row, counter.name) <= counter_of(then->second, counter.name)) continue;
      if (reasons.insert(refined(counter.reason, row)).second)
        where += (where.empty() ? "" : ", ") + name_of(nodes, id);
    }
  }
  if (reasons.size() != 1) return;
  const Reason reason = *reasons.begin();
  for (Result& result : results) {
    if (result.outcome != Outcome::refused) continue;
    result.why = reason;
    result.reason = "at " + where + ": " + sentence(reason) + " (counted there)";
  }
}

}  // namespace limb_ring::ringctl
