#include "tools/ringctl/up.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <system_error>

#include "config/entry.h"
#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "io/program.h"
#include "io/signal_wait.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/hosts.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/stay.h"
#include "tools/ringctl/wait.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr double kForever = 1e6;  // s

struct UpOptions {
  UpRequest request;
  bool detach = false;
  bool respawn = false;
  std::string clock = "machine";
  std::optional<double> pace;
  double lasts_s = 0;
  std::string capture;
  double timeout_s = 10;
};

void require_not_running(const RingPlan& plan) {
  const std::vector<live::HeldNode> held = live::held_nodes(ring_directory(plan.ring));
  if (held.empty()) return;
  const auto is_planned = [&plan](const live::HeldNode& node) {
    return std::any_of(plan.nodes.begin(), plan.nodes.end(),
                       [&node](const NodeName& planned) { return planned.id == node.node; });
  };
  if (plan.is_part() && std::none_of(held.begin(), held.end(), is_planned))
    throw NotDone("ring " + plan.ring +
                  ": another part of it runs here already; on one machine each host's part needs a "
                  "runtime folder of its own (XDG_RUNTIME_DIR)");
  throw NotDone("ring " + plan.ring + " is running already; 'ringctl down " + plan.ring + "' ends it");
}

/// What saves recordings runs beside the ring, if nobody sees it fail. @throw UsageError
void require_place_for_saves(const RingPlan& plan, const std::string& config) {
  if (plan.keeper.empty()) return;
  const std::string problem = app::make_output_folder(plan.saves);
  if (!problem.empty())
    throw UsageError(config + ": entry 'recorder.folder': " + problem + "; allowed: a folder that can be written");
}

/// Waits until the ring, or this host's part of it, is closed. @return why it is not; empty if it is
std::string wait_until_closed(const RingPlan& plan, RingWatch& watch, live::LaunchedRing& daemons,
                              process::SignalWait& signals, double timeout_s) {
  const auto deadline = steady_clock::now() + milliseconds(static_cast<int>(timeout_s * 1000));
  Progress progress;
  for (;;) {
    const auto waiting = watch.first_not_ready();
    daemons.reap();
    const live::LaunchedDaemon* dead = daemons.first_ended();
    if (dead != nullptr && plan.is_virtual && dead->ended()->clean) return {};
    // What asks us to end may have ended a daemon, too: it is not to blame.
    if (dead != nullptr) return signals.asked_to_end(milliseconds(0)) ? "interrupted" : dead->exit_reason();
    if (!waiting) return {};
    if (steady_clock::now() >= deadline)
      return "not closed within " + config::format_real(timeout_s) + " s (--timeout); " + waiting->lack +
             daemons.all()[plan.is_virtual ? 0 : waiting->index].last_lines();
    if (signals.asked_to_end(process::SignalWait::kTick)) return "interrupted";
    progress.tell("waiting for " + waiting->lack);
  }
}

/// @throw UsageError if --host names another machine, unless it is to be done there
RingPlan planned(const Context& context, const UpOptions& options) try {
  return plan_ring(options.request);
} catch (const Elsewhere& problem) {
  if (context.ssh) throw;
  throw UsageError(std::string(problem.what()) + "; with --ssh it is started there");
}

int run(const RingPlan& plan, const UpOptions& options) {
  if (!plan.missing_program.empty()) throw UsageError(plan.missing_program);
  UpLock lock(plan.ring, plan.host);
  require_not_running(plan);
  require_place_for_saves(plan, options.request.config);
  live::forget_logs(ring_directory(plan.ring));
  for (const config::ReadFile& file : plan.files) config::keep_as_read(ring_directory(plan.ring), file.path, file.text);
  if (options.respawn) return respawn(plan, lock);
  process::SignalWait signals;
  const auto lifetime = options.detach ? process::Lifetime::its_own : process::Lifetime::asked_to_end;
  live::LaunchedRing daemons(launch_request(plan, lifetime));
  RingWatch watch(plan);
  const std::string problem = wait_until_closed(plan, watch, daemons, signals, options.timeout_s);
  if (!problem.empty()) {
    const live::LaunchedDaemon* ended = daemons.first_ended();
    const bool refused = ended != nullptr && ended->ended()->code == kUsage;  // ringd's exit codes are these, too
    end(daemons, signals);
    if (refused) throw UsageError("ring " + plan.ring + ": " + problem);
    throw NotDone("ring " + plan.ring + ": " + problem);
  }
  lock.release();
  if (daemons.first_ended() == nullptr)
    announce(plan, watch);
  else
    std::cout << "ring " << plan.ring << " has ended: its time was over" << std::endl;
  const auto keeper = start_keeper(plan, lifetime);
  if (options.detach) return kDone;
  return stay(plan, daemons, signals, options.lasts_s > 0);
}

void read_clock(UpOptions& options) {
  if (options.clock == "machine") {
    if (options.pace || options.lasts_s > 0 || !options.capture.empty())
      throw UsageError("--pace, --for and --capture go with --clock virtual");
    return;
  }
  if (options.respawn && options.lasts_s > 0)
    throw UsageError("--for and --respawn do not go together: a ring that has run for so long is to stay down");
  if (!options.request.host.empty()) throw UsageError("--clock virtual has all nodes in one process: leave --host out");
  if (!options.request.transport.empty()) throw UsageError("--clock virtual has no links: leave --transport out");
  if (options.request.record)
    throw UsageError("--clock virtual repeats exactly by itself: leave --record out, or --capture it");
  if (const std::string problem = app::why_no_file(options.capture); !problem.empty())
    throw UsageError("--capture " + problem);
  const bool follows = options.clock == "follow";
  const double usual = follows ? std::numeric_limits<double>::infinity() : 1;
  options.request.clock = VirtualClock{options.pace.value_or(usual), options.lasts_s, options.capture, follows};
  if (follows) options.timeout_s = kForever;  // the outer clock may stand for as long as it likes
}

/// Adds the options of a virtual ring.
void add_clock(CLI::App& command, UpOptions& options) {
  CLI::Option* clock =
      command
          .add_option("--clock", options.clock,
                      "virtual: the whole ring in one process, on a clock of its own, with the rates and delays of "
                      "CONFIG (default: 1 Gbit/s, 512 ns). CPUs and tools connect as usual. follow: the same, but "
                      "its "
                      "time goes on only as far as a client allows, such as ring_bridge by /clock; --timeout does not "
                      "count. Default: "
                      "machine")
          ->transform(cli::one_of({"machine", "virtual", "follow"}));
  command
      .add_option("--pace", options.pace,
                  "With --clock virtual: its time per real time, 0.001 to 1000, or max: as fast as "
                  "the machine and the CPUs are; default 1, of follow max")
      ->transform(cli::pace())
      ->needs(clock);
  command
      .add_option("--for", options.lasts_s,
                  "With --clock virtual: the ring ends after that many seconds of its time, and prints its trace "
                  "hash")
      ->transform(cli::seconds(0.001, 1e9))
      ->needs(clock);
  command
      .add_option("--capture", options.capture,
                  "With --clock virtual: write the packets on all lines there, as pcapng; 'ring_sim compare-traces' "
                  "names the first packet in which two runs differ")
      ->needs(clock);
}

/// Adds what is to be started.
void add_request(CLI::App& command, UpRequest& request) {
  command.add_option("CONFIG", request.config,
                     "YAML file of the ring; or its name: NAME.yaml in ~/.config/limb_ring, in "
                     "/etc/limb_ring, or of those that came with limb_ring, such as leg8");
  command
      .add_option(
          "--nodes", request.nodes,
          "Number of nodes, 2 to 255: instead of CONFIG plain nodes without CPUs; with CONFIG it must be the same")
      ->transform(cli::whole(config::kFewestNodes, config::kMostNodes));
  command.add_option("--transport", request.transport, "unix, shm or udp, for all lines, instead of what CONFIG says")
      ->transform(cli::one_of(config::transport_words()));
  command.add_option("--host", request.host,
                     "If CONFIG has `hosts`: start the nodes of this host; all: run all nodes on this machine. "
                     "Default: the host that has this machine's address");
  command.add_flag("--record", request.record,
                   "Each node records all that goes into its network controller and comes out, for 'ringctl record'");
}

/// Adds what ringctl does once the daemons are started.
void add_stay(CLI::App& command, UpOptions& options) {
  command.add_flag("--detach", options.detach,
                   "Return when the ring is closed; its daemons go on, each with a log file "
                   "ID.log in the ring's folder (of a virtual ring one for all, ring.log)");
  command
      .add_flag("--respawn", options.respawn,
                "Restart a daemon that ends by itself, but not one that 'ringctl down' or 'ringctl fault kill' ended. "
                "Stays when the ring is taken down. Has no --timeout. For launch files. With --clock virtual the whole "
                "ring restarts, at 0 s of its time")
      ->excludes("--detach");
}

}  // namespace

void add_up(CLI::App& app, Context& context) {
  auto options = std::make_shared<UpOptions>();
  CLI::App* command =
      add_command(app, "up", "Start a ring, and stay until Ctrl-C or 'ringctl down'", "ringctl up leg8 --detach",
                  "One ringd runs per node. Of a ring over several hosts, this starts the part of this host.");
  add_request(*command, options->request);
  add_stay(*command, *options);
  add_clock(*command, *options);
  CLI::Option* timeout =
      command
          ->add_option("--timeout", options->timeout_s, "Seconds until the ring must be closed, 0.1 to 600; default 10")
          ->transform(cli::seconds(0.1, 600.0));
  command->callback([&context, options, timeout] {
    options->request.ring = context.ring;
    // Launch files give it with every --clock: with `follow` it is passed over, as the help says.
    context.action = [&context, options, useless = options->respawn && timeout->count() != 0] {
      if (useless) throw UsageError("--timeout does not go with --respawn: the ring has all the time it needs");
      read_clock(*options);
      return run(planned(context, *options), *options);
    };
  });
}

namespace {

constexpr const char* kPlainRing = "plain";

config::RingConfig load(const UpRequest& request) {
  if (request.config.empty())
    return config::plain_ring(request.ring.empty() ? kPlainRing : request.ring, request.nodes);
  config::RingConfig config = config::load_ring(request.config);
  if (request.nodes != 0 && request.nodes != config.nodes.size())
    throw UsageError("--nodes is " + std::to_string(request.nodes) + ", but " + request.config + " has " +
                     std::to_string(config.nodes.size()) + " nodes; make them the same, or leave the number out");
  return config;
}

std::string ring_name(const UpRequest& request, const config::RingConfig& config) {
  const std::string name = request.ring.empty() ? config.ring : request.ring;
  try {
    socket_path(ring_directory(name), "255", "host");
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return name;
}

std::string pace_argument(double pace) { return std::isinf(pace) ? "max" : std::to_string(pace); }

std::vector<std::string> daemon_arguments(const UpRequest& request, const std::string& ring, std::size_t nodes) {
  std::vector<std::string> arguments;
  if (request.config.empty())
    arguments = {"--nodes", std::to_string(nodes)};
  else
    arguments = {"--config", std::filesystem::absolute(request.config).string(), "--as-read", ring_directory(ring)};
  arguments.insert(arguments.end(), {"--ring", ring});
  if (!request.transport.empty()) arguments.insert(arguments.end(), {"--transport", request.transport});
  if (request.record) arguments.push_back("--record");
  if (!request.clock) return arguments;
  arguments.insert(arguments.end(), {"--clock", request.clock->follows ? "follow" : "virtual", "--pace",
                                     pace_argument(request.clock->pace)});
  if (request.clock->lasts_s > 0) arguments.insert(arguments.end(), {"--for", std::to_string(request.clock->lasts_s)});
  if (!request.clock->capture.empty())
    arguments.insert(arguments.end(), {"--capture", std::filesystem::absolute(request.clock->capture).string()});
  return arguments;
}

std::vector<std::string> keeper_arguments(const config::RecorderSaves& saves, const std::string& ring) {
  if (saves.when.empty()) return {};
  std::string when;
  for (const std::string& word : saves.when) when += (when.empty() ? "" : ",") + word;
  return {"--ring", ring, "record", "keep", saves.folder, "--when", when, "--keep", std::to_string(saves.keep)};
}

}  // namespace

std::vector<std::string> RingPlan::arguments_of(const NodeName& node) const {
  std::vector<std::string> all = arguments;
  all.insert(all.end(), {"--node", std::to_string(node.id)});
  return all;
}

live::LaunchRequest launch_request(const RingPlan& plan, process::Lifetime lifetime) {
  live::LaunchRequest request;
  request.ring = plan.ring;
  if (plan.is_virtual) {
    const NodeName& first = plan.nodes.front();
    request.nodes.push_back({wire::NodeId{first.id}, first.name, plan.arguments, true});
  } else {
    for (const NodeName& node : plan.nodes)
      request.nodes.push_back({wire::NodeId{node.id}, node.name, plan.arguments_of(node)});
  }
  request.lifetime = lifetime;
  request.logged = lifetime != process::Lifetime::asked_to_end;
  return request;
}

/// The program of a node's CPU that is not there; empty if it is.
std::string missing_program(const config::RingConfig& config, const config::NodeConfig& node) {
  if (node.cpu.kind != config::CpuConfig::Kind::child || node.cpu.command.empty()) return "";
  const std::string& name = node.cpu.command.front();
  if (!process::find_program(name).empty()) return "";
  return config.path + ": the CPU of node " + node.name + ": " + process::no_program(name);
}

RingPlan plan_ring(const UpRequest& given) {
  if (given.config.empty() && given.nodes == 0)
    throw UsageError("give CONFIG, the ring's YAML file or its name, or --nodes N for a plain ring");
  UpRequest request = given;
  if (!given.config.empty()) request.config = app::ring_file(given.config);
  const config::RingConfig config = load(request);
  for (const std::string& warning : config.warnings) tell_user("warning: " + warning);
  RingPlan plan;
  plan.ring = ring_name(request, config);
  plan.is_virtual = request.clock.has_value();
  plan.arguments = daemon_arguments(request, plan.ring, config.nodes.size());
  plan.files = config.files;
  plan.ring_size = config.nodes.size();
  if (!plan.is_virtual && !request.config.empty()) {
    const bool records = config.recorder.enabled || request.record;
    const config::RecorderSaves saves = config::load_recorder_saves(request.config, records);
    plan.keeper = keeper_arguments(saves, plan.ring);
    plan.saves = saves.folder;
  }
  if (!plan.is_virtual) plan.host = chosen_host(config, request.host);
  if (plan.host == kAllHosts) {
    plan.host.clear();
    plan.arguments.push_back("--one-host");
  }
  for (const auto& node : config.nodes) {
    const bool foreign =
        node.controller == config::NodeConfig::Controller::foreign && (!plan.is_virtual || !node.library.empty());
    if (foreign || (!plan.host.empty() && config.host_of(node)->name != plan.host)) continue;
    if (plan.missing_program.empty()) plan.missing_program = missing_program(config, node);
    plan.nodes.push_back({node.id, node.name});
  }
  if (plan.nodes.empty())
    throw UsageError("ring " + plan.ring + ": all its nodes here are foreign; there is nothing to start");
  return plan;
}

namespace {

/// What cannot be looked at, make_ring_directory() names.
bool is_there(const std::string& folder) {
  std::error_code error;
  return std::filesystem::exists(folder, error);
}

/// 'ringctl down' may remove the folder at any time before the lock is had. @return nothing if another one has it
std::optional<process::LockFile> take_in_folder(const std::string& ring, const std::string& host) {
  for (;;) {
    try {
      return process::LockFile::take(up_lock(make_ring_directory(ring), host));
    } catch (const std::system_error& problem) {
      if (problem.code() != std::errc::no_such_file_or_directory) throw;
    }
  }
}

}  // namespace

std::string up_lock(const std::string& folder, const std::string& host) {
  return folder + (host.empty() ? "/up" : "/up-" + host) + ".lock";
}

UpLock::UpLock(const std::string& ring, const std::string& host)
    : ring_(ring),
      folder_is_new_(!is_there(ring_directory(ring))),
      folder_(make_ring_directory(ring)),
      file_(take_in_folder(ring, host)) {
  if (!file_)
    throw NotDone("ring " + ring + " is being started already, by " + process::lock_holder(up_lock(folder_, host)));
  file_->write(std::to_string(::getpid()) + '\n');
}

UpLock::~UpLock() {
  try {
    if (file_ && folder_is_new_) tidy_folder(ring_);
  } catch (const std::system_error&) {  // what cannot be looked at, for want of descriptors, stays
  }
  release();
}

void UpLock::release() {
  if (!file_) return;
  file_->remove();
  file_.reset();
  ::rmdir(folder_.c_str());  // stays where a daemon has left something in it
}

}  // namespace limb_ring::ringctl
