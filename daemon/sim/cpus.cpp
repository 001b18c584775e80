#include "sim/cpus.h"

#include <algorithm>

#include "config/core_settings.h"
#include "wire/packet.h"

namespace limb_ring::scenario {

using fault::ToCpu;

namespace {

/// From its death to the next start, as the daemon's default. (ours)
constexpr std::chrono::milliseconds kBackOff{100};

}  // namespace

Cpus::Cpus(sim::VirtualRing& ring, core::Duration boot_time) : ring_(ring), boot_time_(boot_time), cpus_(ring.size()) {
  for (unsigned id = 0; id < ring.size(); ++id) tell(static_cast<NodeId>(id), wire::CpuState::running);
}

void Cpus::tell(NodeId id, wire::CpuState state) {
  cpus_[id].state = state;
  if (state != wire::CpuState::silent) cpus_[id].spoke_at = ring_.now();
  core::CpuReport report;
  report.boots = cpus_[id].boots;
  report.state = state;
  report.spoke_at = cpus_[id].spoke_at + ring_.ahead(id);
  ring_.node(id).apply(core::input::Cpu{report}, ring_.time_of(id));
}

void Cpus::read(NodeId id, bool reads) {
  ring_.set_cpu_reads(id, reads);
  cpus_[id].slow = false;
  ++cpus_[id].reading;
}

void Cpus::begin(const fault::Fault& fault, NodeId id) {
  const fault::Word& word = fault::word_of(fault.name);
  if (word.silences && !has_crashed(id)) cpus_[id].silenced_by |= bit_of(fault.name);
  switch (word.to_cpu) {
    case ToCpu::stop:
      return hang(id);
    case ToCpu::read_slowly:
      return read_slowly(id, fault.every);
    case ToCpu::cure:
      return resume(id);
    case ToCpu::restart:
      return reset(id);
    case ToCpu::crash:
      return crash(id);
    case ToCpu::babble:
      ++cpus_[id].generation;  // it takes the place of one before
      return;
    case ToCpu::mute:
    case ToCpu::nothing:
      return;
  }
}

void Cpus::end(fault::Name fault, NodeId id) {
  cpus_[id].silenced_by &= ~bit_of(fault);
  switch (fault::word_of(fault).to_cpu) {
    case ToCpu::stop:
      return cpus_[id].booted ? go_on(id) : resume(id);
    case ToCpu::read_slowly:
      cpus_[id].slowed_to.reset();
      return is_hung(id) ? void() : read(id, true);
    case ToCpu::babble:
      ++cpus_[id].generation;
      return;
    case ToCpu::mute:
      return;
    case ToCpu::cure:
    case ToCpu::restart:
    case ToCpu::crash:
    case ToCpu::nothing:
      return;  // they do not last
  }
}

void Cpus::hang(NodeId id) {
  if (has_crashed(id)) return;
  cpus_[id].running = cpus_[id].boots_later = false;
  read(id, false);
  cpus_[id].spoke_at = ring_.now();
  const core::Duration silent_after = config::CpuConfig::kSilentPeriods * kAlivePeriod;
  ring_.at(ring_.now() + silent_after, [this, id, epoch = ++cpus_[id].epoch] {
    if (cpus_[id].epoch == epoch && ring_.alive(id)) tell(id, wire::CpuState::silent);
  });
}

// One that boots goes on booting; one that hung meanwhile has booted now.
void Cpus::resume(NodeId id) {
  if (cpus_[id].boots_later) return;
  if (!cpus_[id].booted) return boot(id);
  run(id);
}

void Cpus::run(NodeId id) {
  ++cpus_[id].generation;
  cpus_[id].silenced_by = 0;
  cpus_[id].slowed_to.reset();
  go_on(id);
}

void Cpus::go_on(NodeId id) {
  cpus_[id].running = true;
  ++cpus_[id].epoch;
  cpus_[id].slowed_to ? read_slowly(id, *cpus_[id].slowed_to) : read(id, true);
  tell(id, wire::CpuState::running);
}

void Cpus::read_slowly(NodeId id, core::Duration period) {
  cpus_[id].slowed_to = period;
  if (is_hung(id)) return;
  read(id, false);
  if (period.count() == 0) return;
  cpus_[id].slow = true;
  read_one_and_wait(id, period);
}

// From now on it may take one packet. node() wakes the controller, so that a waiting packet is taken at once.
void Cpus::read_one_and_wait(NodeId id, core::Duration period) {
  ring_.set_cpu_reads(id, true);
  ring_.node(id);
  ring_.at(ring_.now() + period, [this, id, period, reading = cpus_[id].reading] {
    if (cpus_[id].reading == reading) read_one_and_wait(id, period);
  });
}

// Its process is gone. It is started again later, unless something else happens to it first.
void Cpus::lose_process(NodeId id, wire::CpuState state, core::Duration later, void (Cpus::*next)(NodeId)) {
  Cpu& cpu = cpus_[id];
  ++cpu.generation;
  cpu.running = cpu.booted = false;
  cpu.boots_later = true;
  cpu.slowed_to.reset();
  read(id, true);
  ring_.reset_cpu(id);
  ring_.set_cpu_present(id, false);
  tell(id, state);
  ring_.at(ring_.now() + later, [this, id, next, epoch = ++cpu.epoch] {
    if (cpus_[id].epoch == epoch) (this->*next)(id);
  });
}

void Cpus::reset(NodeId id) { lose_process(id, wire::CpuState::booting, boot_time_, &Cpus::boot); }

void Cpus::crash(NodeId id) {
  if (!has_crashed(id)) lose_process(id, wire::CpuState::failed, kBackOff, &Cpus::reset);
}

// As in the daemon, a boot counts from the CPU's first message.
void Cpus::boot(NodeId id) {
  ++cpus_[id].boots;
  cpus_[id].booted = true;
  cpus_[id].boots_later = false;
  ring_.set_cpu_present(id, true);
  run(id);
}

void Cpus::started(NodeId id) {
  cpus_[id].boots = 0;
  reset(id);
}

watchdog::CpuSighting Cpus::sighting_of(NodeId id) const {
  const Cpu& cpu = cpus_[id];
  const core::Duration silent = cpu.running ? core::Duration{0} : ring_.now() - cpu.spoke_at;
  return {ring_.time_of(id), cpu.boots, cpu.state, std::chrono::duration_cast<std::chrono::milliseconds>(silent), true};
}

namespace {

NodeId supervisor_place(const config::RingConfig& config) {
  if (!config.supervisor.node) return NodeId{0};
  return static_cast<NodeId>(setup::index_of(config, *config.find(*config.supervisor.node)));
}

}  // namespace

Supervisor::Supervisor(const config::RingConfig& config, sim::VirtualRing& ring, const Cpus& cpus)
    : config_(config),
      ring_(ring),
      cpus_(cpus),
      beacon_(config.timeouts.beacon),
      node_(supervisor_place(config)),
      membership_(&ring.node(node_).membership()),
      watchdog_(fresh()) {}

watchdog::Watchdog Supervisor::fresh() const {
  std::vector<wire::NodeId> watched;
  for (std::size_t place = 0; place < config_.nodes.size(); ++place)
    if (config::first_pin(config_.nodes[place], config::PinConfig::Action::reset))
      watched.push_back(static_cast<NodeId>(place));
  return {config_.supervisor, wire::kMissedBeacons * beacon_, watched};
}

void Supervisor::start() {
  if (config_.supervisor.policy == config::SupervisorConfig::Policy::automatic) evaluate_later();
}

void Supervisor::started(NodeId id) {
  if (id != node_) return;
  membership_ = &ring_.node(id).membership();
  watchdog_ = fresh();
  resets_.clear();
}

void Supervisor::evaluate_later() {
  ring_.at(ring_.now() + beacon_, [this] {
    if (ring_.alive(node_)) evaluate();
    evaluate_later();
  });
}

void Supervisor::evaluate() {
  const watchdog::Watchdog::Round round = watchdog_.evaluate([this](NodeId id) { return sighting_of(id); }, now());
  for (const NodeId id : round.resets) reset(id);
}

void Supervisor::reset(NodeId id) {
  const std::uint32_t token =
      ring_.interrupt(node_, id, *config::first_pin(config_.nodes[id], config::PinConfig::Action::reset));
  resets_.push_back({id, token, watchdog::ResetOrder(cpu_of(id), now())});
  ring_.at(ring_.now() + core::Duration(watchdog_.confirm_within()), [this, token] {
    const auto late =
        std::find_if(resets_.begin(), resets_.end(), [token](const Reset& each) { return each.token == token; });
    if (late != resets_.end()) finish(late, late->order.timed_out(now()));
  });
}

void Supervisor::came(const core::Event& event, NodeId at) {
  if (at != node_) return;
  const auto* ended = std::get_if<core::SendEnded>(&event.what);
  const auto* changed = std::get_if<core::PeerChanged>(&event.what);
  for (auto it = resets_.begin(); it != resets_.end();) {
    const auto place = it++;
    if (ended && ended->token == place->token)
      finish(place, place->order.interrupt_ended(*ended, cpu_of(place->node), event.at + ring_.ahead(node_)));
    else if (changed && changed->node == place->node)
      finish(place, place->order.cpu_changed(cpu_of(place->node), event.at + ring_.ahead(node_)));
  }
}

void Supervisor::finish(std::list<Reset>::iterator reset, const watchdog::ResetOrder::Report& report) {
  if (!report) return;
  const NodeId node = reset->node;
  resets_.erase(reset);
  watchdog_.reset_ended(node, report->success(), report->message, now());
}

watchdog::CpuSighting Supervisor::sighting_of(NodeId id) const {
  if (id == node_) return cpus_.sighting_of(id);
  return watchdog::sighting_of(membership_->peers()[id]);
}

watchdog::CpuKnown Supervisor::cpu_of(NodeId id) const {
  const watchdog::CpuSighting cpu = sighting_of(id);
  return watchdog::known_of(cpu, watchdog::is_heard(cpu, now(), beacon_),
                            watchdog::reach_of(ring_.settings(node_).order, membership_->broken_line(), node_, id));
}

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
