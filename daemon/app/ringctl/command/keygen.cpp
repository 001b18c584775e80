#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/common/out_file.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "config/config_error.h"
#include "config/key_file.h"

namespace limb_ring::ringctl {

namespace {

int make_key(const std::string& file) {
  if (const std::string problem = app::why_no_file(file); !problem.empty()) throw UsageError(problem);
  try {
    config::make_key_file(file);
  } catch (const config::ConfigError& problem) {
    throw NotDone(problem.what());
  }
  // A path in a ring's file counts from the folder of that file, not from where the user stands now.
  const std::string name = file.substr(file.rfind('/') + 1);
  std::cout << "made " << file
            << ": copy it to all hosts of the ring (scp -p), and name it in a ring's file in the same "
            << "folder: links: {key: " << name << "}; elsewhere by its absolute path" << std::endl;
  return kDone;
}

}  // namespace

void add_keygen(CLI::App& app, Context& context) {
  auto file = std::make_shared<std::string>();
  CLI::App* command = add_command(app, "keygen", "Make a key for the UDP lines between the hosts of a ring");
  command->add_option("FILE", *file, "A file that is not there yet; its mode is 0600")->required();
  command->callback([&context, file] { context.action = [file] { return make_key(*file); }; });
}

}  // namespace limb_ring::ringctl
