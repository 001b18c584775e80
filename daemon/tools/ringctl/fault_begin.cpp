#include "tools/ringctl/fault_begin.h"

#include <algorithm>
#include <optional>

#include "io/in_parallel.h"
#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "ring/lock_files.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

namespace {

struct AtNode {
  std::optional<live::Begun> begun;
  std::exception_ptr problem;
  std::string text;        ///< of the problem
  bool no_daemon = false;  ///< it does not answer, or does not run
};

AtNode begin_at(const live::LiveFaults& faults, const fault::Fault& fault, const live::LiveFaults::Wait& wait) {
  AtNode at;
  try {
    at.begun = faults.begin(fault, wait).front();
  } catch (const std::exception& problem) {
    at.problem = std::current_exception();
    at.text = problem.what();
    at.no_daemon = dynamic_cast<const HostPortError*>(&problem) != nullptr;
  }
  return at;
}

/// One that is alone as it is.
std::exception_ptr problem_of(const std::vector<AtNode>& failed) {
  if (failed.empty()) return nullptr;
  if (failed.size() == 1) return failed[0].problem;
  std::string text;
  for (const AtNode& at : failed) text += (text.empty() ? "" : "; ") + at.text;
  const bool no_daemons = std::all_of(failed.begin(), failed.end(), [](const AtNode& at) { return at.no_daemon; });
  return no_daemons ? std::make_exception_ptr(HostPortError(text)) : std::make_exception_ptr(NotDone(text));
}

/// Leaves out of `fault` the nodes that are dead: for one of them the virtual ring would do nothing at all.
std::vector<AtNode> take_out_dead(const live::RunningDaemons& daemons, fault::Fault& fault) {
  std::vector<AtNode> dead;
  std::vector<wire::NodeId> alive;
  for (const wire::NodeId node : fault.nodes) {
    try {
      daemons.require_runs(node);
      alive.push_back(node);
    } catch (const HostPortError& problem) {
      dead.push_back({std::nullopt, std::current_exception(), problem.what(), true});
    }
  }
  fault.nodes = alive;
  return dead;
}

/// The virtual ring does it to all of its nodes at one instant, or to none.
bool is_done_by_the_ring(const std::string& ring, const fault::Fault& fault) {
  return fault::word_of(fault.name).of == fault::Of::node &&
         live::holder_of(ring_directory(ring), fault.nodes.front()).on_virtual_ring;
}

}  // namespace

BegunFaults begin_fault(const std::string& ring, const fault::RingNodes& nodes, const fault::Fault& fault,
                        const live::LiveFaults::Wait& wait) {
  const live::LiveFaults faults(ring, nodes);
  if (is_done_by_the_ring(ring, fault) && fault.name != fault::Name::start) {
    fault::Fault of_alive = fault;
    const std::vector<AtNode> dead = take_out_dead(live::RunningDaemons(ring, nodes), of_alive);
    if (of_alive.nodes.empty()) return {{}, problem_of(dead)};
    return {faults.begin(of_alive, wait), problem_of(dead)};
  }
  if (fault.nodes.size() < 2 || is_done_by_the_ring(ring, fault)) return {faults.begin(fault, wait), nullptr};
  std::vector<AtNode> all(fault.nodes.size());
  process::in_parallel(all.size(), all.size(), [&](std::size_t i) {
    fault::Fault one = fault;
    one.nodes = {fault.nodes[i]};
    all[i] = begin_at(faults, one, wait);
  });
  BegunFaults begun;
  std::vector<AtNode> failed;
  for (AtNode& at : all) at.begun ? begun.done.push_back(std::move(*at.begun)) : failed.push_back(std::move(at));
  begun.problem = problem_of(failed);
  return begun;
}

}  // namespace limb_ring::ringctl
