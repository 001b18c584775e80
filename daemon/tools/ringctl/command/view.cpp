#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "io/find_program.h"
#include "tools/cli/values.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/view_server.h"

namespace limb_ring::ringctl {

namespace {

/// PREFIX/share/limb_ring/web, the programs being in PREFIX/lib/limb_ring.
std::string page_folder() {
  const std::filesystem::path programs = process::own_folder();
  return (programs.parent_path().parent_path() / "share" / "limb_ring" / "web").string();
}

}  // namespace

void add_view(CLI::App& app, Context& context) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command = add_command(app, "view", "Show the ring in a browser, until Ctrl-C",
                                  "ringctl view leg8 --control", "Serves one page, and prints its address.");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  command->add_flag("--control", options->control,
                    "The page may also break, mend, reset and stop, and set the pace of a virtual ring");
  command->add_option("--port", options->port, "TCP port, 0 to 65535; default 0: any that is free")
      ->transform(cli::whole(0, 65535));
  command->add_option("--address", options->address,
                      "Address of this host to listen at, in numbers; default 127.0.0.1: for this host alone");
  command->callback([&context, options] {
    context.action = [&context, options] {
      options->ring = choose_ring(options->ring, context.ring);
      options->folder = page_folder();
      return serve_view(*options);
    };
  });
}

}  // namespace limb_ring::ringctl
