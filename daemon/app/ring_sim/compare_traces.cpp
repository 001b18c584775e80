#include <fstream>
#include <iostream>
#include <memory>

#include "app/capture_text/packet_text.h"
#include "app/ring_sim/commands.h"
#include "app/ring_sim/problems.h"
#include "capture/capture_comparison.h"

namespace limb_ring::ring_sim {

namespace {

struct CompareTracesOptions {
  std::string first, second;
};

/// A capture that stays open while it is read.
struct Capture {
  explicit Capture(const std::string& path) : name(path), file(path, std::ios::binary), reader(file, path) {}

  std::string name;
  std::ifstream file;
  capture::PcapngReader reader;
};

std::string line_of(const std::optional<capture::PcapngReader::Record>& record, const capture::RingNames& names) {
  if (!record) return "ends here";
  app::PacketText text(names, {});
  return std::visit([&text](const auto& of) { return text.line(of); }, *record);
}

int tell(const capture::CaptureComparison& result, const Capture& first, const Capture& second) {
  const std::string equal = std::to_string(result.equal) + " packets and events";
  if (result.same()) {
    std::cout << "the same: " << equal << std::endl;
    return kDone;
  }
  std::cout << "the first " << equal << " are the same, then they differ";
  if (result.first && result.second) std::cout << " (" << difference(*result.first, *result.second) << ")";
  std::cout << ":\n"
            << first.name << "  " << line_of(result.first, first.reader.names()) << '\n'
            << second.name << "  " << line_of(result.second, second.reader.names()) << std::endl;
  return kBroken;
}

int run(const CompareTracesOptions& options) {
  for (const std::string& path : {options.first, options.second})
    if (!std::ifstream(path)) throw UsageError(path + ": cannot be read");
  Capture first(options.first), second(options.second);
  return tell(compare(first.reader, second.reader), first, second);
}

}  // namespace

void add_compare_traces(CLI::App& app, Context& context) {
  auto options = std::make_shared<CompareTracesOptions>();
  CLI::App* command = add_command(app, "compare-traces",
                                  "Name the first packet in which two captures differ, each of a ring on a virtual "
                                  "clock; exit code 1 where they do");
  command
      ->add_option("A", options->first,
                   "pcapng, from 'ringctl up --clock virtual --capture', 'ringctl scenario run' or 'ring_sim run'")
      ->required();
  command->add_option("B", options->second, "pcapng of another run")->required();
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
