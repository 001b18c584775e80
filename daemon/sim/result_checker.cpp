#include "sim/result_checker.h"

#include <algorithm>

namespace limb_ring::sim {

using core::NodeState;

Time ResultChecker::last_hello_of(NodeId destination) const {
  if (destination == wire::kBroadcast) return record_.said_hello;
  return destination < record_.nodes.size() ? record_.at(destination).history.said_hello : core::kNever;
}

ResultJudge ResultChecker::judge_of(NodeId node, const Sent& sent) const {
  const NodeRecord& n = record_.at(node);
  return {sent, n.settings, n.history, last_hello_of(sent.destination), record_.was_broken};
}

void ResultChecker::ends(NodeId node, const core::SendEnded& end, Time at_end) {
  NodeRecord& n = record_.at(node);
  const bool paced = end.outcome == core::Outcome::unconfirmed;  // as it left. (protocol.md section 8.4)
  const core::Duration pace = paced ? n.settings.open_chain_interrupt_pace() : core::Duration{0};
  if (end.interrupt) n.interrupt_free = std::max(n.interrupt_free, at_end + pace);  // others are cancelled meanwhile
  record_.ledger.settle(at_end);
  judge_unexplained(node);
  // If tries fail or numbers are used up, copies are under way, and a hello may come between them.
  if (end.tries > 1 || end.outcome == core::Outcome::lost || end.outcome == core::Outcome::no_such_node)
    record_.disturbed(at_end);
  const Sent* sent = record_.ledger.end(node, end, at_end);
  if (!sent) return;
  std::vector<Unexplained>& unexplained = unexplained_[node];
  const std::string ended = sent->name() + " ended " + core::to_string(end.outcome);
  if (const char* objection = judge_of(node, *sent).objection())
    record_.complain(Promise::true_result, ended + objection);
  if (end.outcome == core::Outcome::cancelled && n.history.cancelled != at_end)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and nobody had cancelled it"});
  const bool was_in_chain =
      n.history.open_chain_until != Time{} && at_end - n.history.open_chain_until <= told_within(n.settings);
  if (end.outcome == core::Outcome::unconfirmed && n.history.state != NodeState::open_chain && !was_in_chain)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and its node is in no open chain"});
  const bool was_in_ring = sent->asked_in_ring && n.history.state_at < sent->asked;
  if (end.reject == core::Reject::not_in_ring && was_in_ring)
    unexplained.push_back({record_.ring.now(), end.outcome, ended + ", and its node was in a ring"});
}

// A node that starts over cancels its sends, and rejects new ones until it is in a ring again.
void ResultChecker::state_changes(NodeId node, NodeState state) {
  const auto explains = [&](core::Outcome outcome) {
    const auto of_it = [&](const Unexplained& result) { return result.outcome == outcome; };
    auto& all = unexplained_[node];
    all.erase(std::remove_if(all.begin(), all.end(), of_it), all.end());
  };
  if (state == NodeState::open_chain) explains(core::Outcome::unconfirmed);
  if (!may_send(state)) explains(core::Outcome::rejected);
  if (state == NodeState::starting || state == NodeState::duplicate_id) explains(core::Outcome::cancelled);
}

// The state that explains a result may be shown after it: a node that starts over ends its sends first.
void ResultChecker::judge_unexplained(NodeId node) {
  const core::Duration tail = told_within(record_.at(node).settings);
  for (const Unexplained& result : unexplained_[node])
    if (result.when + tail < record_.ring.now()) record_.complain(Promise::true_result, result.what);
}

void ResultChecker::judge_open(NodeId node, bool all) {
  record_.ledger.each_open(node, [&](const Sent& sent) {
    if (all || judge_of(node, sent).due() < record_.ring.now())
      record_.complain(Promise::one_result, sent.name() + " has not ended");
  });
}

}  // namespace limb_ring::sim
