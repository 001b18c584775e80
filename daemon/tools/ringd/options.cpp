#include "tools/ringd/options.h"

#include <iostream>

#include "config/load_ring.h"
#include "config/ring_config.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"

namespace limb_ring::ringd {
namespace {

constexpr const char* kPlainName = "plain";

void check_node_count(const Options& options, const config::RingConfig& ring) {
  if (options.nodes && *options.nodes != ring.nodes.size())
    throw UsageError("--nodes is " + std::to_string(*options.nodes) + ", but " + options.config + " has " +
                     std::to_string(ring.nodes.size()) + " nodes; make them the same, or leave --nodes out");
}

/// Adds the options of a virtual ring.
void add_clock(CLI::App& app, Options& o) {
  CLI::Option* clock =
      app.add_option(
             "--clock", o.clock,
             "virtual: all nodes of the ring in this one process, on a clock of their own, with the lines' rates "
             "and delays of the configuration (default: 1 Gbit/s, 512 ns). follow: the same, but its time goes on only "
             "as far as a client allows, such as ring_bridge by /clock")
          ->transform(cli::one_of({"machine", "virtual", "follow"}));
  app.add_option(
         "--pace", o.pace,
         "With --clock virtual: its time per real time, 0.001 to 1000, or max: as fast as the machine and the CPUs "
         "are; default 1, of follow max")
      ->transform(cli::pace())
      ->needs(clock);
  app.add_option("--for", o.lasts_s, "With --clock virtual: the ring ends after that many seconds of its time")
      ->transform(cli::seconds(0.001, 1e9))
      ->needs(clock);
  app.add_option("--capture", o.capture, "With --clock virtual: write the packets on all lines there, as pcapng")
      ->needs(clock);
}

}  // namespace

std::optional<Options> parse_options(int argc, const char* const* argv) {
  Options o;
  CLI::App app{
      "Runs the network controller of one node of a ring, and starts its CPU.\n"
      "Usually started by roslaunch (ring.launch) or 'ringctl up'."};
  app.name("ringd");
  app.footer(cli::footer("", "ringd --config leg8.yaml --node left_knee",
                         "Exit codes: 0 ended as asked, 1 could not run, 2 wrong usage or configuration."));
  app.add_option("--config", o.config, "YAML file of the ring; without it a plain ring of --nodes nodes");
  app.add_option("--as-read", o.as_read,
                 "Folder in which 'ringctl up' has kept the configuration; the daemon and its CPU read it from there");
  app.add_option("--node", o.node, "This node: its id or name");
  app.add_option("--index", o.index, "This node: its place in ring order, from 0 (instead of --node)")
      ->transform(cli::whole(0, config::kMostNodes - 1));
  app.add_option("--nodes", o.nodes, "Number of nodes, 2 to 255; with --config it must be the configuration's")
      ->transform(cli::whole(config::kFewestNodes, config::kMostNodes));
  app.add_option("--ring", o.ring, "Name of the ring (default: the configuration's, or 'plain')");
  app.add_option("--transport", o.transport, "unix, shm or udp, for every link (default: the configuration's)")
      ->transform(cli::one_of(config::transport_words()));
  app.add_flag("--one-host", o.one_host, "Run all nodes on this machine, even if the configuration has hosts");
  add_clock(app, o);
  app.add_flag("--record", o.record,
               "Record what goes into the network controller and what comes out, for 'ringctl record'");
  app.add_flag("--options", o.list_options, "Print every entry of the YAML file, and end");
  try {
    const auto asked = cli::read(app, {argv + 1, argv + argc});
    if (!asked) return o;
    std::cout << *asked;
    return std::nullopt;
  } catch (const cli::WrongCommandLine& wrong) {
    throw UsageError(wrong.what());
  }
}

config::RingConfig ring_of(const Options& options) {
  if (options.config.empty() && !options.nodes)
    throw UsageError("--config FILE, or --nodes N for a plain ring, is needed; see ringd --help");
  config::RingConfig ring = options.config.empty()
                                ? config::plain_ring(options.ring.empty() ? kPlainName : options.ring, *options.nodes)
                                : config::load_ring(options.config);
  check_node_count(options, ring);
  if (!options.ring.empty()) config::rename_ring(ring, options.ring);
  if (options.one_host) config::apply_one_host(ring);
  if (!options.transport.empty()) config::apply_transport(ring, options.transport);
  ring.recorder.enabled = ring.recorder.enabled || options.record;
  return ring;
}

void check_virtual(const Options& options) {
  if (!options.node.empty() || options.index)
    throw UsageError("--clock virtual holds all nodes of the ring: leave --node and --index out");
  if (!options.transport.empty()) throw UsageError("--clock virtual has no links: leave --transport out");
  if (options.record)
    throw UsageError("--clock virtual repeats exactly by itself: leave --record out, or --capture it");
  if (app::is_same_file(options.config, options.capture))
    throw UsageError("--capture names the ring's file: " + options.capture + " would be lost; write to another one");
}

void check_machine(const Options& options) {
  if (options.pace || options.lasts_s > 0 || !options.capture.empty())
    throw UsageError("--pace, --for and --capture go with --clock virtual");
}

const config::NodeConfig& node_of(const Options& options, const config::RingConfig& ring) {
  if (options.node.empty() == !options.index)
    throw UsageError("one of --node (id or name) and --index (place in ring order) is needed; see ringd --help");
  if (options.index) {
    if (*options.index < ring.nodes.size()) return ring.nodes[*options.index];
    throw UsageError("--index " + std::to_string(*options.index) + ": ring " + ring.ring + " has " +
                     std::to_string(ring.nodes.size()) + " nodes, so 0 to " + std::to_string(ring.nodes.size() - 1));
  }
  if (const config::NodeConfig* node = ring.find(options.node)) return *node;
  std::string names;
  for (const auto& node : ring.nodes) names += " " + std::to_string(node.id) + "/" + node.name;
  throw UsageError("ring " + ring.ring + " has no node '" + options.node + "'; it has (id/name):" + names);
}

}  // namespace limb_ring::ringd
