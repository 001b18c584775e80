#include "config/sections.h"

namespace limb_ring::config {

using namespace std::chrono_literals;

const Section<SupervisorConfig>& supervisor_section() {
  static const Section<SupervisorConfig> section{
      {"node", "the first whose cpu is attached, else the first", "id or name of a node",
       "The one node that watches, by the others' beacons and its own CPU's word.",
       [](const Entry& entry, SupervisorConfig& supervisor) { supervisor.node = read_node(entry); }},
      choice_option("policy", &SupervisorConfig::policy, {"off", "report", "auto"},
                    "off: nothing is watched. report: a hung CPU is logged and shown. auto: it is reset as well."),
      time_option("grace", &SupervisorConfig::grace, 10ms, 600s,
                  "A CPU is not judged for so long after its start; a reset that is not confirmed by then has failed."),
      integer_option("tries", &SupervisorConfig::tries, {1, 10}, "auto: resets in a row before a CPU is given up."),
      time_option("backoff", &SupervisorConfig::backoff, 10ms, 600s,
                  "auto: wait from one reset of a CPU to the next; it doubles, until the CPU has run for `grace` and "
                  "this wait."),
  };
  return section;
}

}  // namespace limb_ring::config
