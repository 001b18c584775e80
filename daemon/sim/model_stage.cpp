#include "sim/model_stage.h"

namespace limb_ring::scenario {

using fault::Name;

bool ModelStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string&) {
  const core::Time end = at(until);
  if (ring().run_until(done, end - ring().now())) return true;
  ring().run_until(end);
  return done();
}

std::optional<Stage::Failure> ModelStage::apply(const Fault& fault) {
  do_it(fault);
  return std::nullopt;
}

void ModelStage::do_it(const Fault& fault) {
  if (fault::word_of(fault.name).of == fault::Of::line) return lines_.begin(fault);
  // All are off before the first is on again.
  if (fault.name == Name::power_cycle)
    for (const NodeId id : fault.nodes) ring().kill(id);
  for (const NodeId id : fault.nodes) {
    lasting_.begins(fault.name, id);
    apply_to_node(fault, id);
    if (fault.lasts.count() != 0) end_later(fault, id);
  }
}

void ModelStage::end_later(const Fault& fault, NodeId id) {
  Fault end;
  end.name = fault.name == Name::freeze ? Name::thaw : Name::resume;
  end.nodes = {id};
  const unsigned number = lasting_.number(fault.name, id);
  ring().at(ring().now() + core::Duration(fault.lasts), [this, end, lasts = fault.name, number] {
    if (lasting_.number(lasts, end.nodes.front()) == number) do_it(end);
  });
}

void ModelStage::apply_to_node(const Fault& fault, NodeId id) {
  switch (fault.name) {
    case Name::kill:
      frozen_[id] = false;
      return ring().kill(id);
    case Name::start:
    case Name::power_cycle:
      return start(id);
    case Name::freeze:
      return freeze(id);
    case Name::thaw:
      return thaw(id);
    default:
      return apply_to_cpu(fault, id);
  }
}

// A second time it changes nothing.
void ModelStage::freeze(NodeId id) {
  if (!ring().alive(id)) return;
  frozen_[id] = true;
  ring().freeze(id);
}

void ModelStage::start(NodeId id) {
  if (ring().alive(id)) return;
  frozen_[id] = false;
  ring().start(id);
  started(id);
}

void ModelStage::thaw(NodeId id) {
  if (frozen_[id]) ring().thaw(id);
  frozen_[id] = false;
}

void ModelStage::bring_back(NodeId id) { frozen_[id] ? thaw(id) : start(id); }

}  // namespace limb_ring::scenario
