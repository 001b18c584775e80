#include "ros_bridge/fault_services.h"

#include <ros/init.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "ros_bridge/answered.h"

namespace limb_ring::bridge {
namespace {

using fault::Name;

void append(std::string& text, const std::string& more, const char* between) {
  if (!more.empty()) text += (text.empty() ? "" : between) + more;
}

/// A node that is frozen for a time does not stay frozen when the bridge ends.
bool sleeps_until_shutdown(std::chrono::milliseconds time) {
  std::this_thread::sleep_for(time);
  return ros::isShuttingDown();
}

}  // namespace

FaultServices::FaultServices(TwoNames& names, const config::RingConfig& ring, const std::string& own, RingPort& port)
    : ring_nodes_(fault::nodes_by_id(ring)), own_(own), port_(port), faults_(ring.ring, ring_nodes_) {
  names.advertise("inject_fault", &FaultServices::inject, this);
  names.advertise("clear_faults", &FaultServices::clear, this);
  names.advertise("list_faults", &FaultServices::list, this);
}

void FaultServices::require_survival(const fault::Fault& fault) const {
  if (fault.name != Name::hang && fault.name != Name::crash && fault.name != Name::reset) return;
  for (const auto& node : ring_nodes_) {
    const bool hit = std::count(fault.nodes.begin(), fault.nodes.end(), node.id) != 0;
    if (hit && (own_ == node.name || own_ == node.number))
      throw std::invalid_argument("the CPU of node " + node.name +
                                  " is this bridge, which could not answer then; use "
                                  "ringctl fault");
  }
}

bool FaultServices::inject(InjectFault::Request& request, InjectFault::Response& response) {
  return answered(port_, response, [&] {
    const fault::Fault fault = fault::from_words(request.fault, ring_nodes_);
    require_survival(fault);
    for (const live::Begun& begun : faults_.begin(fault, sleeps_until_shutdown)) {
      append(response.message, begun.words, "; ");
      append(response.id, begun.id, " ");
    }
  });
}

bool FaultServices::clear(ClearFaults::Request& request, ClearFaults::Response& response) {
  return answered(port_, response, [&] {
    if (!request.id.empty()) return faults_.remove(request.id);
    for (const std::string& problem : faults_.clear()) append(response.message, problem, "; ");
    response.success = response.message.empty();
  });
}

bool FaultServices::list(ListFaults::Request&, ListFaults::Response& response) {
  return answered(port_, response, [&] {
    const live::FaultList list = faults_.list();
    for (const std::string& problem : list.unknown) append(response.message, problem, "; ");
    response.success = list.unknown.empty();
    for (const live::LiveFault& fault : list.faults) {
      response.ids.push_back(fault.id);
      response.faults.push_back(fault.words);
      response.ages.push_back(fault.age_s);
      response.hits.push_back(fault.hits);
    }
  });
}

}  // namespace limb_ring::bridge
