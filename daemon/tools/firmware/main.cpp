#include <cstdio>
#include <exception>
#include <iostream>

#include "io/standard_descriptors.h"
#include "tools/cli/output.h"
#include "tools/firmware/cpu_loop.h"
#include "tools/firmware/node_setup.h"
#include "tools/firmware/options.h"
#include "tools/firmware/stop_signal.h"

namespace {

using namespace limb_ring;

int fail(const std::exception& error, int code) {
  std::fprintf(stderr, "limb_firmware: %s\n", error.what());
  return code;
}

HostPort connect(const firmware::Options& options, const firmware::ProgramSetup& setup) {
  ConnectOptions connection;
  connection.ring = setup.ring;
  connection.node = options.node;
  connection.role = Role::cpu;
  connection.alive_period = setup.alive_period;
  connection.results_may_wait = true;  // they are counted, no more
  return HostPort::connect(connection);
}

int run_cpu(const firmware::Options& options) {
  const auto setup = firmware::make_setup(options);
  HostPort port = connect(options, setup);
  firmware::catch_stop_signals();
  firmware::NodeCpu cpu(setup.cpu, firmware::read_clocks(port));
  const int code =
      firmware::run(port, cpu, setup.alive_period, {options.hang_after, options.endless_loop_at, options.command_log});
  std::fprintf(stderr, "limb_firmware %s: %s\n", port.name().c_str(), cpu.summary().c_str());
  return code;
}

}  // namespace

int main(int argc, char** argv) try {
  process::open_standard_descriptors();
  process::outlive_file_limit();
  const auto options = firmware::parse_options(argc, argv);
  if (options.print.empty()) return run_cpu(options);
  std::cout << options.print;
  return cli::code_with_output("limb_firmware", 0);
} catch (const limb_ring::HostPortError& error) {
  return fail(error, 1);
} catch (const std::exception& error) {
  return fail(error, 2);
}
