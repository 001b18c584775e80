#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include "core/time.h"
#include "sim/trace.h"
#include "study/cases.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/common/timeline.h"
#include "tools/ring_sim/command_line.h"
#include "wire/capture_comparison.h"
#include "wire/pcapng.h"

namespace limb_ring::ring_sim {

/// What each case is, for --help.
constexpr const char* kCasesHelp =
    "Cases (N nodes; T: time of a packet on a line; i: that of an INTP; d: relay delay):\n"
    "  alone: one packet, nobody else sends; T + N d\n"
    "  simultaneous: all nodes start to send at the same instant; N T + d\n"
    "  adversarial: each node starts to send just before this packet arrives there; N (T + d)\n"
    "  request: the same, asked for just after a packet of another began to pass; (N + 1) T + N d\n"
    "  delivery: adversarial, but only as far as the farthest node; (N - 1) (T + d)\n"
    "  interrupt: an INTP that meets one other INTP at every node; N (d + i)\n"
    "  interrupt_bound: the worst INTP that was seen while all nodes send; at most N (d + i + 8 bytes)\n"
    "  saturated: all nodes always send, in step; how much of the time the lines are in use\n"
    "  random: all nodes always send, from random instants on; at most N (T + d)\n"
    "  payload: all nodes always send; how much of what is on the lines is data";

/// "saturated, 16 nodes, 512 bytes"
std::string case_words(study::Case which, const study::Medium& medium);

/// One case as `table` prints it: case, nodes, payload, rate_bps, relay_delay_ns, formula in words,
/// formula_us and measured_us (the worst; null for shares), their difference, and the same of
/// shares in percent (null for times).
app::Row case_row(study::Case which, const study::Medium& medium, const study::CaseResult& result);

/// The same with min, mean, p99, max, occupancy, seed and trace hash, as `run` prints it.
app::Row run_row(study::Case which, const study::Medium& medium, const study::CaseResult& result, std::uint64_t seed);

namespace {

using study::Case;

struct RunOptions {
  Case which = Case::alone;
  study::Medium medium;
  std::uint64_t seed = 1;
  std::string trace, capture, perfetto;
  bool outputs = false;
  app::Format format = app::Format::text;
};

/// What is one row in JSON is a line each for people.
std::string in_lines(const app::Row& row) {
  std::vector<app::Row> lines;
  for (const auto& [name, value] : row.items())
    if (!value.is_null()) lines.push_back({{"figure", name}, {"value", value}});
  return app::format_rows(lines, app::Format::text);
}

/// @return where to write; none if it is not asked for
std::ostream* open(std::ofstream& file, const std::string& option, const std::string& path) {
  if (path.empty()) return nullptr;
  if (path == app::kStandardOutput) return &std::cout;
  const std::string problem = app::open_for_writing(file, path);
  if (!problem.empty()) throw UsageError(option + problem);
  return &file;
}

/// Of standard output the end of the program tells.
void finish(std::ofstream& file, const std::string& path) {
  const std::string problem = file.is_open() ? cli::finish_writing(file, path) : "";
  if (!problem.empty()) throw std::runtime_error(problem);
}

int run(const RunOptions& options) {
  if (options.perfetto == app::kStandardOutput)
    throw UsageError("--perfetto -: a timeline goes into a file, which ui.perfetto.dev opens; name one");
  if (app::is_same_output(options.trace, options.perfetto))
    throw UsageError("--trace and --perfetto both name " + options.perfetto + "; each needs a file of its own");
  if (app::is_same_output(options.trace, options.capture))
    throw UsageError("--trace and --capture both name " + options.capture + "; each needs a file of its own");
  std::ofstream trace, capture, perfetto;
  std::stringstream captured;
  study::CaseRecords records;
  records.trace = open(trace, "--trace ", options.trace);
  records.capture = open(capture, "--capture ", options.capture);
  if (open(perfetto, "--perfetto ", options.perfetto) != nullptr) records.capture = &captured;
  records.goes_on = [&options, progress = Progress()]() mutable {
    progress.tell(case_words(options.which, options.medium));
  };
  if (options.outputs) records.capture_at = sim::CaptureAt::inputs_and_outputs;
  const study::CaseResult result = run_case(options.which, options.medium, options.seed, records);
  finish(trace, options.trace);
  finish(capture, options.capture);
  if (perfetto.is_open()) app::write_timeline(perfetto, captured, "the run");
  finish(perfetto, options.perfetto);
  const app::Row row = run_row(options.which, options.medium, result, options.seed);
  std::ostream& out = records.trace == &std::cout || records.capture == &std::cout ? std::cerr : std::cout;
  if (options.format == app::Format::text) out << in_lines(row);
  if (options.format == app::Format::json) out << row.dump(2) << '\n';
  if (options.format == app::Format::csv) out << app::format_rows({row}, options.format);
  return kDone;
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(app, "run", "Run one case, and print what was measured",
                                  "ring_sim run --case adversarial --nodes 16", kCasesHelp);
  std::map<std::string, Case> cases;
  for (const Case which : study::kCases) cases[to_string(which)] = which;
  command
      ->add_option("--case", options->which,
                   "alone, simultaneous, adversarial, request, delivery, interrupt, interrupt_bound, saturated, "
                   "random or payload (see below); default alone")
      ->transform(cli::word_of(cases));
  add_medium(*command, options->medium);
  add_seed(*command, options->seed);
  command->add_option(
      "--trace", options->trace,
      "Write everything that happened here: time in ps, node, what, and three figures of it; - is standard "
      "output, and what else it says goes to standard error");
  CLI::Option* capture = command->add_option(
      "--capture", options->capture, "Write the packets on all lines there, as pcapng for Wireshark; - as of --trace");
  command->add_flag("--outputs", options->outputs, "Also as they leave each node: 'ringctl traffic why' needs that")
      ->needs(capture);
  command->add_option("--perfetto", options->perfetto, "Write them there as a timeline, which ui.perfetto.dev loads")
      ->excludes(capture);
  add_format(*command, options->format);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

namespace {

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

using study::microseconds;

namespace {

constexpr double kPercent = 100;

/// A share in percent, to 6 decimals: more is but rounding of the division.
double exact_percent(double share) {
  return static_cast<double>(static_cast<std::int64_t>(share * kPercent * 1e6 + 0.5)) / 1e6;
}

}  // namespace

std::string case_words(study::Case which, const study::Medium& medium) {
  return std::string(to_string(which)) + ", " + app::counted(medium.nodes, "node") + ", " +
         app::counted(medium.payload, "byte");
}

app::Row case_row(study::Case which, const study::Medium& medium, const study::CaseResult& result) {
  app::Row row{{"case", to_string(which)},
               {"nodes", medium.nodes},
               {"payload", medium.payload},
               {"rate_bps", medium.rate},
               {"relay_delay_ns", static_cast<double>(medium.relay_delay.count()) / 1e3},
               {"formula", study::formula_words(which, medium)}};
  const bool time = !result.has_share;
  const core::Duration worst = result.measured.max();
  row["formula_us"] = time ? app::Row(microseconds(result.formula)) : app::Row();
  row["measured_us"] = time ? app::Row(microseconds(worst)) : app::Row();
  row["difference_us"] = time ? app::Row(microseconds(worst - result.formula)) : app::Row();
  row["formula_percent"] = time ? app::Row() : app::Row(exact_percent(result.formula_share));
  row["measured_percent"] = time ? app::Row() : app::Row(exact_percent(result.measured_share));
  return row;
}

app::Row run_row(study::Case which, const study::Medium& medium, const study::CaseResult& result, std::uint64_t seed) {
  app::Row row = case_row(which, medium, result);
  row["packets"] = result.measured.count();
  row["min_us"] = microseconds(result.measured.min());
  row["mean_us"] = microseconds(result.measured.mean());
  row["p99_us"] = microseconds(result.measured.quantile(0.99));
  row["max_us"] = microseconds(result.measured.max());
  row["occupancy_percent"] = exact_percent(result.occupancy);
  row["seed"] = seed;
  row["trace_hash"] = sim::hash_text(result.trace_hash);
  return row;
}

namespace {

struct CompareTracesOptions {
  std::string first, second;
};

std::string line_of(const std::optional<capture::PcapngReader::Record>& record, const capture::RingNames& names) {
  if (!record) return "ends here";
  app::PacketText text(names, {});
  return std::visit([&text](const auto& of) { return text.line(of); }, *record);
}

/// If one ends in the middle, nobody knows what would have come next: neither the same nor different.
/// @throw UsageError
void require_whole(const capture::PcapngReader& reader, const std::string& path) {
  if (reader.cut_short()) throw UsageError(path + " ends in the middle of a packet: it cannot be compared further");
}

int tell(const capture::CaptureComparison& result, const CompareTracesOptions& options, const capture::RingNames& first,
         const capture::RingNames& second) {
  const std::string equal = std::to_string(result.equal) + " packets and events";
  if (result.same()) {
    std::cout << "the same: " << equal << std::endl;
    return kDone;
  }
  std::cout << "the first " << equal << " are the same, then they differ";
  if (result.first && result.second) std::cout << " (" << difference(*result.first, *result.second) << ")";
  std::cout << ":\n"
            << options.first << "  " << line_of(result.first, first) << '\n'
            << options.second << "  " << line_of(result.second, second) << std::endl;
  return kBroken;
}

int run(const CompareTracesOptions& options) {
  capture::CaptureFile first(options.first), second(options.second);
  const auto tell_progress = [progress = Progress()](std::uint64_t equal) mutable {
    progress.tell("compared " + std::to_string(equal) + " packets and events");
  };
  const capture::CaptureComparison result = compare(first.reader(), second.reader(), tell_progress);
  if (!result.first) require_whole(first.reader(), options.first);
  if (!result.second) require_whole(second.reader(), options.second);
  return tell(result, options, first.reader().names(), second.reader().names());
}

}  // namespace

void add_compare_traces(CLI::App& app, Context& context) {
  auto options = std::make_shared<CompareTracesOptions>();
  CLI::App* command = add_command(app, "compare-traces", "Name the first packet in which two captures differ",
                                  "ring_sim compare-traces first.pcapng second.pcapng",
                                  "Both captures come from rings on a virtual clock. Exits with 1 if they differ.");
  command
      ->add_option("A", options->first,
                   "pcapng, from 'ringctl up --clock virtual --capture', 'ringctl scenario run' or 'ring_sim run'")
      ->required();
  command->add_option("B", options->second, "pcapng of another run")->required();
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
