#include <spdlog/spdlog.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <memory>

#include "config/as_read.h"
#include "config/core_settings.h"
#include "config/option.h"
#include "config/quantity.h"
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
#include "tools/ringd/options.h"
#include "tools/ringd/stderr_sink.h"

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
