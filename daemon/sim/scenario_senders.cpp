#include "sim/scenario_senders.h"

#include <algorithm>

#include "wire/data_packet.h"

namespace limb_ring::scenario {

namespace {

/// The period of a babble that gives none. In a ring of 16 at 1 Gbit/s a node cannot send that often, so its queue is
/// full. (ours)
constexpr std::chrono::microseconds kBabblePeriod{10};

}  // namespace

std::size_t Senders::index_of(const std::string& name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  const auto index = static_cast<std::size_t>(found - names_.begin());
  if (found != names_.end()) return index;
  names_.push_back(name);
  tallies_.emplace_back();
  return index;
}

const Tally& Senders::tally(const std::string& name) const {
  static const Tally kNone;
  const auto found = std::find(names_.begin(), names_.end(), name);
  return found == names_.end() ? kNone : tallies_[static_cast<std::size_t>(found - names_.begin())];
}

void Senders::begin(const Send& send) {
  for (const NodeId from : send.from) {
    Job& job = jobs_.emplace_back(Job{send, from, index_of(send.name), send.times()});
    if (!send.is_stream()) {
      for (; job.left != 0; --job.left) ask(job);
      continue;
    }
    const core::Duration period = send.every;
    const core::Duration phase{static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(period.count()))};
    ring_.at(ring_.now() + phase, [this, &job] { ask_and_go_on(job); });
  }
}

void Senders::babble(NodeId from, core::Duration every, std::function<bool()> over) {
  Send send;
  send.name = "babble";
  send.to = wire::kBroadcast;
  send.size = wire::kMaxPayload;
  send.every = every.count() == 0 ? kBabblePeriod : core::whole_nanoseconds(every);
  ask_and_go_on(jobs_.emplace_back(Job{send, from, index_of(send.name), UINT64_MAX, std::move(over)}));
}

void Senders::ask_and_go_on(Job& job) {
  if (job.over && job.over()) return;
  ask(job);
  if (--job.left != 0) ring_.at(ring_.now() + core::Duration(job.send.every), [this, &job] { ask_and_go_on(job); });
}

void Senders::ask(const Job& job) {
  const Send& send = job.send;
  if (!(send.input ? ring_.alive(job.from) : cpu_sends_(job.from))) return;
  std::uint32_t token = 0;
  if (send.input) {
    of_interrupt_[{job.from, ring_.settings(job.from).inputs[*send.input]->factor}] = job.tally;
    token = ring_.pull(job.from, *send.input);
  } else if (send.interrupt) {
    of_interrupt_[{job.from, *send.interrupt}] = job.tally;
    token = ring_.interrupt(job.from, send.to, *send.interrupt);
  } else {
    const std::vector<std::uint8_t> data(send.size, static_cast<std::uint8_t>(job.tally));
    token = ring_.send(job.from, send.to, data, send.priority);
  }
  asked_[{job.from, token}] = {job.tally, ring_.now()};
}

// All bytes of its packets are the number of a send.
std::optional<std::size_t> Senders::send_of(const core::ReceivedPacket& packet) const {
  const std::size_t send = packet.data[0];
  const auto is_it = [&](const Job& job) {
    return job.tally == send && job.from == packet.source && job.send.size == packet.bytes().size;
  };
  const bool ours =
      packet.channel == wire::id_of(wire::Channel::user) && std::any_of(jobs_.begin(), jobs_.end(), is_it);
  return ours ? std::optional(send) : std::nullopt;
}

void Senders::came(const core::Event& event, NodeId at) {
  if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) {
    const auto found = of_interrupt_.find({pin->source, pin->factor});
    if (found != of_interrupt_.end()) ++tallies_[found->second].taken;
  }
  const auto* ended = std::get_if<core::SendEnded>(&event.what);
  const auto found = ended ? asked_.find({at, ended->token}) : asked_.end();
  if (found == asked_.end()) return;
  Tally& tally = tallies_[found->second.tally];
  ++tally.results[static_cast<std::size_t>(ended->outcome)];
  if (ended->outcome == core::Outcome::delivered) tally.worst = std::max(tally.worst, event.at - found->second.at);
  asked_.erase(found);
}

}  // namespace limb_ring::scenario
