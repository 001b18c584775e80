#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/common/colour.h"
#include "app/common/text_table.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/line_report.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/ring_clock.h"
#include "app/ringctl/ring_folder.h"
#include "app/ringctl/screen.h"
#include "app/ringctl/status_rows.h"
#include "app/ringctl/status_table.h"
#include "app/ringctl/supervision.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::ringctl {

namespace {

struct StatusOptions {
  std::string ring;
  bool json = false, pids = false;
};

void print_json(const RingAccess& ring, std::vector<nlohmann::json> rows) {
  for (auto& row : rows) row.erase("ring");  // once is enough
  nlohmann::json all{{"ring", ring.ring()}, {"path", ring.path()}, {"nodes", rows}};
  const nlohmann::json clock = ring_clock(ring.ring());
  if (clock.is_object()) all["clock"] = clock;
  std::cout << all.dump(2) << '\n';
}

void print_text(const RingAccess& ring, const std::vector<nlohmann::json>& rows, bool pids) {
  StatusStyle style;
  style.pids = pids;
  style.colour = app::colour_wanted(STDOUT_FILENO);
  // What goes into a file or through a pipe is for grep: as wide as it is.
  if (::isatty(STDOUT_FILENO) == 1) style.width = Screen::size().columns;
  const std::string heading = headline(ring.ring(), rows) + clock_words(ring_clock(ring.ring()));
  std::cout << app::wrapped(heading, style.width) << status_table(rows, style)
            << app::wrapped(line_report(rows) + unanswered_report(rows) + warning_report(rows) + stop_report(rows) +
                                supervision_text(rows),
                            style.width);
}

/// Of a ring that is frozen as a whole, the nodes that its files tell of.
RingAccess running_or_frozen(const std::string& ring) {
  try {
    return RingAccess::open(ring);
  } catch (const AllFrozen&) {
    return RingAccess::open_also_dead(ring);
  }
}

int run(const Context& context, const StatusOptions& options) {
  const RingAccess ring = running_or_frozen(choose_ring(options.ring, context.ring));
  tell_unreadable(ring_directory(ring.ring()));
  const auto rows = status_rows(ring);
  if (options.json)
    print_json(ring, rows);
  else
    print_text(ring, rows, options.pids);
  return kDone;
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command =
      add_command(app, "status",
                  "Show all nodes; one without a daemon is 'down'; one whose daemon is stopped is 'frozen', and "
                  "'unanswered' where it lives and has not answered, or could not be asked");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  command->add_flag("-p,--pids", options->pids, "Process numbers of daemons and CPUs too");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
