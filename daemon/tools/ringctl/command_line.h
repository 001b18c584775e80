#pragma once

#include <functional>
#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// Runs ringctl. Errors go to standard error. @return an ExitCode
int run_command_line(int argc, char** argv);

}  // namespace limb_ring::ringctl

namespace CLI {
class App;
}

namespace limb_ring::ringctl {

/// What the command line has said, shared by all subcommands.
struct Context {
  std::string ring;                    ///< --ring; empty: the only one running
  bool ssh = false;                    ///< --ssh: what only another host can do is done there
  std::vector<std::string> arguments;  ///< all of them but the program's name and --ssh
  std::function<int()> action;         ///< set by the subcommand given; @return an ExitCode
};

/// Adds a subcommand. Its `--ring` is the global one.
/// @param description what the list of commands says of it: one line
/// @param example a whole command line
/// @param more what else its own --help says
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& example, const std::string& more = {});
/// Adds a subcommand that has subcommands, of which one must be given.
CLI::App& add_group(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                    const std::string& more = {});
/// Adds the switch --json.
void add_json(CLI::App& command, bool& json);
/// For a command that concerns no ring, or all. @throw UsageError "--ring: WHY; leave it out" if one was named
void require_no_ring(const Context& context, const std::string& why);

// One subcommand each, in a file of its name.
void add_new(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_up(CLI::App& app, Context& context);
void add_down(CLI::App& app, Context& context);
void add_wait(CLI::App& app, Context& context);
void add_status(CLI::App& app, Context& context);
void add_log(CLI::App& app, Context& context);
void add_view(CLI::App& app, Context& context);
void add_traffic(CLI::App& app, Context& context);            ///< show, events, why, judge, again
void add_traffic_judge(CLI::App& traffic, Context& context);  ///< below `traffic`
void add_traffic_why(CLI::App& traffic, Context& context);    ///< below `traffic`
void add_traffic_again(CLI::App& traffic, Context& context);  ///< below `traffic`
void add_record(CLI::App& app, Context& context);             ///< save, keep, check, cause
void add_record_cause(CLI::App& record, Context& context);    ///< below `record`
void add_send(CLI::App& app, Context& context);
void add_ping(CLI::App& app, Context& context);
void add_interrupt(CLI::App& app, Context& context);
void add_reset(CLI::App& app, Context& context);
void add_stop(CLI::App& app, Context& context);
void add_resume(CLI::App& app, Context& context);
void add_clock(CLI::App& app, Context& context);  ///< pace, pause, step, run, sync
void add_fault(CLI::App& app, Context& context);
void add_scenario(CLI::App& app, Context& context);
void add_scenario_list(CLI::App& scenario, Context& context);    ///< below `scenario`
void add_scenario_shrink(CLI::App& scenario, Context& context);  ///< below `scenario`
void add_scenario_cause(CLI::App& scenario, Context& context);   ///< below `scenario`
void add_hosts(CLI::App& app, Context& context);                 ///< key, launch
void add_conform(CLI::App& app, Context& context);

/// What a shell may complete: names of the rings that run, if `wanted` is "RING" or "--ring"; of a ring's nodes
/// if it is "NODE", "TO" and the like. Nothing if it is none of these, or the ring is not there or not clear. No
/// daemon that is frozen is asked, so nobody waits at the prompt.
/// @param ring as typed on the command line; empty: the only one running
std::vector<std::string> names_to_complete(const std::string& wanted, const std::string& ring);

/// The name behind `--ring`, or in `--ring=NAME`, among words of a command line; empty if there is none.
std::string typed_ring(const std::vector<std::string>& words);

}  // namespace limb_ring::ringctl
