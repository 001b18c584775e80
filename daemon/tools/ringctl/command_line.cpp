#include "tools/ringctl/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>
#include <set>

#include "config/quantity.h"
#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/ringctl/hosts.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& example, const std::string& more) {
  CLI::App* command = app.add_subcommand(name, description);
  command->fallthrough();
  command->footer(cli::footer(more, example, kExitCodesInShort));
  return command;
}

CLI::App& add_group(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                    const std::string& more) {
  CLI::App* group = add_command(app, name, description, example, more);
  group->require_subcommand(1);
  return *group;
}

void add_json(CLI::App& command, bool& asked) { command.add_flag("--json", asked, "Print JSON, for programs"); }

void require_no_ring(const Context& context, const std::string& why) {
  if (!context.ring.empty()) throw UsageError("--ring: " + why + "; leave it out");
}

namespace {

struct Section {
  const char* title;
  std::vector<void (*)(CLI::App&, Context&)> commands;
};

/// The sections of `ringctl --help`, in the order in which a user needs them.
const std::vector<Section>& sections() {
  static const std::vector<Section> all{
      {"Start and end a ring", {add_new, add_check, add_up, add_down, add_wait}},
      {"Look at it", {add_status, add_log, add_view, add_traffic, add_record}},
      {"Act on it", {add_send, add_ping, add_interrupt, add_reset, add_stop, add_resume, add_clock}},
      {"Break and test it", {add_fault, add_scenario}},
      {"For several hosts and for nodes of your own", {add_hosts, add_conform}}};
  return all;
}

void add_commands(CLI::App& app, Context& context) {
  for (const Section& section : sections())
    for (const auto add : section.commands) {
      add(app, context);
      app.get_subcommands([](const CLI::App*) { return true; }).back()->group(section.title);
    }
}

int failed(const std::exception& problem, ExitCode code) {
  tell_user(problem.what());
  return code;
}

int act(const Context& context) {
  try {
    return context.action();
  } catch (const UsageError& problem) {
    return failed(problem, kUsage);
  } catch (const config::ConfigError& problem) {
    return failed(problem, kUsage);
  } catch (const capture::CaptureFileError& problem) {
    return failed(problem, kUsage);
  } catch (const Elsewhere& problem) {
    if (context.ssh) return run_there(problem, context.arguments);
    return failed(std::runtime_error(std::string(problem.what()) + ". Ask there, or with --ssh"), kNoRing);
  } catch (const NoRing& problem) {
    return failed(problem, kNoRing);
  } catch (const NotKnown& problem) {
    return failed(problem, kUnknown);
  } catch (const HostPortError& problem) {
    return failed(problem, kNoRing);
  } catch (const nlohmann::json::exception& problem) {
    return failed(std::runtime_error("a daemon: " + ask::sentence_of_shape(problem.what())), kNoRing);
  } catch (const std::exception& problem) {
    return failed(problem, kNotDone);
  }
}

}  // namespace

int run_command_line(int argc, char** argv) {
  Context context;
  CLI::App app("Starts, queries and controls rings of limb_ring daemons (ringd).", "ringctl");
  app.footer(cli::footer("'ringctl help SUBCOMMAND' explains one of them.", "ringctl up leg8", kExitCodesHelp));
  app.require_subcommand(1);
  app.add_option("--ring", context.ring,
                 "Name of the ring; default: LIMB_RING_RING of the environment, else the only ring that runs");
  app.add_flag("--ssh", context.ssh,
               "Run a command that only another host can carry out there, by ssh without a password");
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]) != "--ssh") context.arguments.emplace_back(argv[i]);
  add_commands(app, context);
  const auto names = [&context](const std::string& wanted) {
    return names_to_complete(wanted, typed_ring(context.arguments));
  };
  if (const auto end = cli::parse(app, argc, argv, names)) return *end;
  return act(context);
}

namespace {

/// By what a daemon says, which knows the nodes of other hosts, too; if none can answer by what their files tell.
std::vector<std::string> node_names(const std::string& ring) {
  const std::string folder = ring_directory(ring);
  const auto held = live::held_nodes(folder);
  const bool answers = std::any_of(
      held.begin(), held.end(), [&folder](const live::HeldNode& node) { return !live::is_frozen(folder, node.node); });
  std::vector<std::string> names;
  if (!answers) {
    for (const live::KnownNode& node : live::known_nodes(folder)) names.push_back(node.name);
    return names;
  }
  const RingAccess access = RingAccess::open(ring);
  for (const NodeName& node : access.nodes()) names.push_back(node.name);
  return names;
}

}  // namespace

std::vector<std::string> names_to_complete(const std::string& wanted, const std::string& ring) {
  if (wanted == "RING" || wanted == "--ring") return live::held_rings();
  const std::set<std::string> nodes{"NODE", "TO", "--to", "--from"};
  if (nodes.count(wanted) == 0) return {};
  try {
    return node_names(choose_ring(ring));
  } catch (const std::exception&) {
    return {};  // none runs, or several do
  }
}

std::string typed_ring(const std::vector<std::string>& words) {
  const std::string option = "--ring", with_value = option + '=';
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].compare(0, with_value.size(), with_value) == 0) return words[i].substr(with_value.size());
    if (words[i] == option && i + 1 < words.size()) return words[i + 1];
  }
  return {};
}

}  // namespace limb_ring::ringctl
