#include <poll.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "config/core_settings.h"
#include "config/entry.h"
#include "config/load_ring.h"
#include "config/option.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "core/time.h"
#include "io/packet_loop.h"
#include "io/signal_wait.h"
#include "io/spawn.h"
#include "node/node.h"
#include "node/realtime.h"
#include "node/virtual_ring_host.h"
#include "sim/planned_ring.h"
#include "sim/trace.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"

namespace limb_ring::ringd {

/// What one ringd is to be, from its command line.
struct Options {
  std::string config;             ///< YAML file; empty: a plain ring of `nodes`
  std::string as_read;            ///< folder with the configuration as `ringctl up` has read it; empty: as it is now
  std::string node;               ///< id or name
  std::optional<unsigned> index;  ///< or its place in ring order, from 0
  std::optional<unsigned> nodes;  ///< must be the configuration's number
  std::string ring;               ///< another name for the ring
  bool record = false;
  std::string transport;          ///< unix, shm or udp for every link
  bool one_host = false;          ///< all nodes are on this machine, whatever hosts the file gives
  std::string clock = "machine";  ///< or virtual: the whole ring is in this process
  std::optional<double> pace;     ///< of the virtual clock: its time per real time; infinite: as fast as the machine is
  double lasts_s = 0;             ///< of the virtual clock: the ring ends by itself then; 0: it does not
  std::string capture;            ///< of the virtual clock: file for all packets on the lines; empty: none
  bool list_options = false;      ///< print config/OPTIONS.md and end
};

/// The command line is wrong; what() says what would be right.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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

/// Reads the command line.
/// @return nothing if help or version was asked for, and printed
/// @throw UsageError
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

/// The ring these options mean. @throw UsageError, config::ConfigError
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

/// Checks that no option is given that cannot be used with a virtual clock. @throw UsageError
void check_virtual(const Options& options) {
  if (!options.node.empty() || options.index)
    throw UsageError("--clock virtual holds all nodes of the ring: leave --node and --index out");
  if (!options.transport.empty()) throw UsageError("--clock virtual has no links: leave --transport out");
  if (options.record)
    throw UsageError("--clock virtual repeats exactly by itself: leave --record out, or --capture it");
  if (app::is_same_file(options.config, options.capture))
    throw UsageError("--capture names the ring's file: " + options.capture + " would be lost; write to another one");
}

/// Checks that no option is given that goes with a virtual clock alone. @throw UsageError
void check_machine(const Options& options) {
  if (options.pace || options.lasts_s > 0 || !options.capture.empty())
    throw UsageError("--pace, --for and --capture go with --clock virtual");
}

/// This daemon's node in it. @throw UsageError
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

/// The daemon's log on standard error, which does not wait for whoever reads it: a terminal after Ctrl-S, or a pipe
/// nobody empties, must not stop the ring. It waits kPatience once, since a reader may just be busy with other daemons'
/// lines. What does not fit is left out, counted, and told once there is room. Each line is one write, so that lines of
/// several daemons do not mix. The daemon has one thread.
class StderrSink final : public spdlog::sinks::stderr_color_sink_st {
 public:
  StderrSink() { std::setvbuf(stderr, nullptr, _IOFBF, kLongest); }
  void log(const spdlog::details::log_msg& message) override {
    if (!has_room()) {
      ++left_out_;
      return;
    }
    tell_left_out();
    Base::log(message);
  }

 private:
  using Base = spdlog::sinks::stderr_color_sink_st;

  static constexpr std::size_t kLongest = 4096;  ///< bytes, PIPE_BUF: a pipe that polls writable takes so many
  static constexpr int kPatience = 2;            ///< ms

  bool has_room() {
    pollfd entry{STDERR_FILENO, POLLOUT, 0};
    is_read_ = ::poll(&entry, 1, is_read_ ? kPatience : 0) > 0;
    return is_read_;
  }

  void tell_left_out() {
    if (left_out_ == 0) return;
    const std::string text =
        std::to_string(left_out_) + (left_out_ == 1 ? " line" : " lines") + " left out: standard error was not read";
    left_out_ = 0;
    Base::log(spdlog::details::log_msg("ringd", spdlog::level::warn, text));
  }

  bool is_read_ = true;
  std::uint64_t left_out_ = 0;
};

}  // namespace limb_ring::ringd

namespace {

using namespace limb_ring;
using ringd::StderrSink;

void set_up_log(const std::string& whose) {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("ringd", std::make_shared<StderrSink>()));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ [" + whose + "] %v");
  spdlog::flush_on(spdlog::level::info);
}

/// Ends `node`, or whatever has its stop(), when a signal asks for it.
template <class Node>
void end_on_signals(boost::asio::signal_set& signals, boost::asio::io_context& io, Node& node) {
  if (!process::ignores_hangup()) signals.add(SIGHUP);
  signals.async_wait([&](const boost::system::error_code& error, int number) {
    if (error) return;
    spdlog::info("signal {} ({}): ending", number, ::strsignal(number));
    node.stop([&io] { io.stop(); });
  });
}

int run(const config::RingConfig& ring, const config::NodeConfig& config) {
  set_up_log(ring.ring + "/" + config.name);
  boost::asio::io_context io(1);
  runtime::Node node(io, ring, config, runtime::daemon_base(io, ring, config));
  runtime::apply_realtime(ring, setup::index_of(ring, config));
  const std::string few = runtime::too_few_descriptors(ring);
  if (!few.empty()) spdlog::warn("{}", few);
  const std::string small = setup::too_small_insertion_buffer(ring, config);
  if (!small.empty()) spdlog::warn("{}", small);
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  end_on_signals(signals, io, node);
  node.start();
  event_loop::PacketLoop::of(io).run(ring.realtime.spin);
  return 0;
}

void report(const virtual_host::VirtualRingHost& host, const virtual_host::Pace& pace) {
  const double seconds = std::chrono::duration<double>(host.now().time_since_epoch()).count();
  if (pace.lost().count() > 0)
    spdlog::info("the machine was too slow for pace {}: {:.1f} s were lost", pace.factor(),
                 std::chrono::duration<double>(pace.lost()).count());
  const std::string not_repeatable = host.not_repeatable();
  spdlog::info("trace hash {} of {:.9f} s{}", sim::hash_text(host.trace_hash()), seconds,
               not_repeatable.empty() ? "" : "; not repeatable: " + not_repeatable);
}

int run_virtual(const config::RingConfig& given, const ringd::Options& options) {
  set_up_log(given.ring);
  const config::RingConfig ring = sim::with_assumed_lines(given, sim::kUsualRate, sim::kUsualRelayDelay);
  runtime::keep_on_one_core(ring);
  boost::asio::io_context io(1);
  virtual_host::VirtualRingHostOptions settings;
  settings.libraries = true;
  virtual_host::VirtualRingHost host(io, ring, settings);
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  end_on_signals(signals, io, host);
  std::ofstream capture;
  if (!options.capture.empty()) {
    const std::string problem = app::open_for_writing(capture, options.capture);
    if (!problem.empty()) throw ringd::UsageError("--capture " + problem);
    host.capture(capture);
  }
  host.start();
  const bool follows = options.clock == "follow";
  if (follows) host.follow();
  const double usual = follows ? std::numeric_limits<double>::infinity() : 1;
  virtual_host::Pace pace(options.pace.value_or(usual), std::chrono::steady_clock::now());
  const core::Time end =
      options.lasts_s > 0 ? core::Time{} + std::chrono::nanoseconds(std::llround(options.lasts_s * 1e9)) : core::kNever;
  host.run(pace, end);
  report(host, pace);
  const std::string problem = capture.is_open() ? cli::finish_writing(capture, options.capture) : "";
  if (!problem.empty()) throw std::runtime_error(problem);
  return 0;
}

int complain(const char* what, int code) {
  std::cerr << "ringd: " << what << '\n';
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  process::open_standard_descriptors();
  process::outlive_file_limit();
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const auto options = ringd::parse_options(argc, argv);
    if (!options) return cli::code_with_output("ringd", 0);
    if (options->list_options) {
      std::cout << config::options_markdown();
      return cli::code_with_output("ringd", 0);
    }
    if (!options->as_read.empty()) ::setenv(config::kAsRead, options->as_read.c_str(), 1);
    const config::RingConfig ring = ringd::ring_of(*options);
    if (options->clock == "machine") {
      ringd::check_machine(*options);
      return run(ring, ringd::node_of(*options, ring));
    }
    ringd::check_virtual(*options);
    return run_virtual(ring, *options);
  } catch (const ringd::UsageError& error) {
    return complain(error.what(), 2);
  } catch (const config::ConfigError& error) {
    return complain(error.what(), 2);
  } catch (const std::exception& error) {
    return complain(error.what(), 1);
  }
}
