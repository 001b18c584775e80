#include <iostream>
#include <memory>

#include "core/time.h"
#include "tools/ring_sim/case_rows.h"
#include "tools/ring_sim/commands.h"
#include "tools/ring_sim/problems.h"
#include "tools/ring_sim/progress.h"

namespace limb_ring::ring_sim {

namespace {

using study::Case;

struct TableOptions {
  study::Medium medium;
  std::uint64_t seed = 1;
  bool alone = false;
  app::Format format = app::Format::text;
};

class Table {
 public:
  explicit Table(const TableOptions& options) : options_(options) {}

  void add(Case which, const study::Medium& medium) {
    study::CaseRecords records;
    records.goes_on = [&] { progress_.tell(case_words(which, medium)); };
    rows_.push_back(case_row(which, medium, run_case(which, medium, options_.seed, records)));
  }
  void add_nodes() {
    for (const unsigned nodes : {2u, 4u, 8u, 16u, 32u, 64u, 128u, 254u})
      for (const Case which :
           {Case::alone, Case::simultaneous, Case::adversarial, Case::request, Case::interrupt, Case::saturated}) {
        study::Medium medium = options_.medium;
        medium.nodes = nodes;
        add(which, medium);
      }
  }
  void add_payloads() {
    for (const unsigned payload : {1u, 16u, 64u, 128u, 256u, 512u})
      for (const Case which : {Case::alone, Case::simultaneous, Case::adversarial, Case::saturated, Case::payload}) {
        study::Medium medium = options_.medium;
        medium.payload = payload;
        add(which, medium);
      }
  }
  const std::vector<app::Row>& rows() const { return rows_; }

 private:
  const TableOptions& options_;
  Progress progress_;
  std::vector<app::Row> rows_;
};

// In text, what all rows have in common is said once.
std::string in_text(const std::vector<app::Row>& rows, const TableOptions& options) {
  std::vector<app::Row> shown;
  for (const app::Row& row : rows) {
    shown.push_back(row);
    for (const char* common : {"rate_bps", "relay_delay_ns"}) shown.back().erase(common);
  }
  const study::Medium& medium = options.medium;
  return app::format_rows(shown, app::Format::text) + "\nR = " + std::to_string(medium.rate) +
         " bit/s, d = " + std::to_string(core::picoseconds(medium.relay_delay)) + " ps, seed " +
         std::to_string(options.seed) +
         ". T = (B + 12) bytes on the line, i = 12 bytes.\n"
         "measured_us is the worst of its case. Asked a picosecond after a packet of another began to pass,\n"
         "`request` stays that much below its formula; `interrupt_bound` and `random` are the worst that was\n"
         "seen, their formulas bounds. d is our inference: the paper does not state it.\n";
}

int run(const TableOptions& options) {
  Table table(options);
  for (const Case which : study::kCases) table.add(which, options.medium);
  if (!options.alone) {
    table.add_nodes();
    table.add_payloads();
  }
  std::cout << (options.format == app::Format::text ? in_text(table.rows(), options)
                                                    : app::format_rows(table.rows(), options.format));
  return kDone;
}

}  // namespace

void add_table(CLI::App& app, Context& context) {
  auto options = std::make_shared<TableOptions>();
  CLI::App* command = add_command(app, "table", "Print every case of the paper, formula and measured",
                                  "ring_sim table --only", kCasesHelp);
  add_medium(*command, options->medium);
  add_seed(*command, options->seed);
  command->add_flag("--only", options->alone, "Leave out the other numbers of nodes and payloads");
  add_format(*command, options->format);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
