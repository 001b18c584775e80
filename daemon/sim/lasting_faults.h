#pragma once

#include <map>
#include <utility>

#include "config/fault.h"

namespace limb_ring::scenario {

/// Which fault of a node, or of its CPU, that lasts for a time is still there when that is over: another one may have
/// ended it, or taken its place, and is not to be ended with it. (ours)
class LastingFaults {
 public:
  /// To be told of every fault of a node or its CPU.
  void begins(fault::Name name, wire::NodeId node) {
    for (const Name lasting : {Name::freeze, Name::hang, Name::slow, Name::not_reading, Name::babble})
      if (ends(name, lasting)) ++numbers_[{lasting, node}];
  }

  /// Of the fault of this name that the node has now; another one once that has ended or was replaced.
  unsigned number(fault::Name lasting, wire::NodeId node) const {
    const auto found = numbers_.find({lasting, node});
    return found == numbers_.end() ? 0 : found->second;
  }

 private:
  using Name = fault::Name;

  static bool ends(Name name, Name lasting) {
    if (name == lasting || name == Name::kill || name == Name::power_cycle) return true;
    if (lasting == Name::freeze) return name == Name::thaw;
    return name == Name::resume || name == Name::reset || name == Name::crash;
  }

  std::map<std::pair<Name, wire::NodeId>, unsigned> numbers_;
};

}  // namespace limb_ring::scenario
