#include "ros_bridge/node_main.h"

#include <ros/ros.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "config/quantity.h"
#include "io/child.h"
#include "io/signal_wait.h"
#include "io/spawn.h"
#include "ros_bridge/bridge.h"
#include "tools/common/command_line.h"
#include "tools/common/man_page.h"

namespace limb_ring::bridge {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 ended as asked, 1 could not run, 2 wrong arguments, parameters or configuration.\n";

bool asks_for_help(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--help") == 0 || std::strcmp(argv[i], "-h") == 0) return true;
  return false;
}

int complain(const std::exception& error, int code) {
  ROS_FATAL("%s", error.what());
  return code;
}

/// roscpp ends a node in order at SIGINT alone. What nohup has ignored stays so.
void end_in_order_when_asked() {
  for (const int signal : {SIGTERM, SIGHUP})
    if (std::signal(signal, [](int) { ros::requestShutdown(); }) == SIG_IGN) std::signal(signal, SIG_IGN);
}

/// Two nodes of one name would end each other for ever: the master ends the older one, and whatever restarts that one
/// thereby ends this one.
bool is_name_taken() {
  const std::string& name = ros::this_node::getName();
  if (!ros::service::exists(name + "/get_loggers", /*print_failure_reason=*/false)) return false;
  ROS_FATAL("node %s runs already. End it by `rosnode kill %s`, or give this one another name or namespace",
            name.c_str(), name.c_str());
  return true;
}

int run_or_complain(const NodeProgram& program) {
  // When the last NodeHandle is destroyed, ROS shuts down, and rosconsole with it. This one keeps both alive until the
  // last message is out.
  const ros::NodeHandle until_all_is_said;
  try {
    program.run();
    return 0;
  } catch (const config::ConfigError& error) {
    return complain(error, 2);
  } catch (const std::invalid_argument& error) {
    return complain(error, 2);
  } catch (const std::exception& error) {
    return complain(error, 1);
  }
}

/// `man-page`, for the build.
bool asks_for_man_page(int argc, char** argv) { return argc == 2 && std::strcmp(argv[1], "man-page") == 0; }

}  // namespace

int run_node(int argc, char** argv, const NodeProgram& program) {
  process::open_standard_descriptors();
  process::outlive_file_limit();
  if (asks_for_help(argc, argv)) {
    std::cout << program.help << kExitCodes;
    return cli::code_with_output(program.name, 0);
  }
  if (asks_for_man_page(argc, argv)) {
    std::cout << cli::man_page_of_text(program.name, std::string(program.help) + kExitCodes,
                                       "[OPTIONS] _PARAMETER:=VALUE ...");
    return cli::code_with_output(program.name, 0);
  }
  try {
    ros::init(argc, argv, program.name);  // takes NAME:=VALUE out of argv
  } catch (const std::exception& error) {
    std::cerr << program.name << ": " << error.what() << std::endl;
    return 2;
  }
  end_in_order_when_asked();
  if (argc > 1) {
    std::cerr << program.name << ": unknown argument '" << argv[1] << "'; see " << program.name << " --help\n";
    return 2;
  }
  return is_name_taken() ? 2 : run_or_complain(program);
}

namespace {

void keep_parameters(const ros::NodeHandle& own, const KeptText& kept) {
  XmlRpc::XmlRpcValue given;
  if (ros::param::get(own.getNamespace(), given) && given.hasMember("config")) return kept.put(given.toXml());
  const std::string before = kept.get();
  if (before.empty()) return;  // its first life
  int offset = 0;
  XmlRpc::XmlRpcValue known(before, &offset);
  if (known.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  for (auto& [name, value] : known) own.setParam(name, value);
  ROS_WARN("a new ROS master did not know this node's parameters; they have been set again");
}

}  // namespace

void run_bridge(const KeptText& kept) {
  const ros::NodeHandle own("~");
  keep_parameters(own, kept);
  const Bridge bridge(ros::NodeHandle(), read_parameters(own));
  ros::spin();
}

KeptText::KeptText() : file_(::memfd_create("limb_ring kept text", MFD_CLOEXEC)) {}

// Half a text would be worse than none.
void KeptText::put(const std::string& text) const {
  if (::ftruncate(file_.get(), 0) != 0) return;
  if (::pwrite(file_.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size())) return;
  (void)!::ftruncate(file_.get(), 0);
}

std::string KeptText::get() const {
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0) return {};
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const ssize_t size = ::pread(file_.get(), text.data(), text.size(), 0);
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return text;
}

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kWrongParameters = 2;

/// @return whether this process was asked to end while the child ran
bool wait_for(process::Child& child, const process::SignalWait& signals) {
  bool asked = false;
  while (!child.reap()) {
    const int signal = signals.next();
    if (!process::SignalWait::asks_to_end(signal)) continue;
    asked = true;
    child.signal(signal);
  }
  return asked;
}

/// @return true if the parent is asked to end meanwhile
bool wait_before_next(milliseconds wait, const process::SignalWait& signals) {
  const auto until = steady_clock::now() + wait;
  for (auto now = steady_clock::now(); now < until; now = steady_clock::now())
    if (signals.asked_to_end(std::chrono::ceil<milliseconds>(until - now))) return true;
  return false;
}

}  // namespace

int respawned(const std::function<int()>& program) {
  // Held back to the end of this process: one that comes after the child's end must not change our exit code.
  const process::SignalWait& signals = *new process::SignalWait;
  // It ends by exit(), as from main(): ROS ends in an exit handler.
  const auto work = [&]() -> int {
    signals.release();
    std::exit(program());
  };
  const pid_t starter = ::getppid();
  process::BackOff back_off({});
  for (;;) {
    const auto start = steady_clock::now();
    process::Child child(process::spawn_copy(work, SIGTERM), "the process");
    if (child.ended()) throw std::runtime_error(child.ended()->text);
    const bool asked = wait_for(child, signals);
    const process::ExitStatus& end = *child.ended();
    const int code = end.code.value_or(1);
    if (asked || code == kWrongParameters || ::getppid() != starter) return code;
    std::cerr << "the process ended with " << end.text << " and is started again" << std::endl;
    const auto ran = std::chrono::duration_cast<milliseconds>(steady_clock::now() - start);
    if (wait_before_next(back_off.after(ran), signals)) return code;
  }
}

}  // namespace limb_ring::bridge
