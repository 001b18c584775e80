#include <iostream>
#include <memory>

#include "tools/capture_text/packet_text.h"
#include "tools/ring_sim/commands.h"
#include "tools/ring_sim/problems.h"
#include "tools/ring_sim/progress.h"
#include "wire/capture_comparison.h"
#include "wire/capture_file.h"

namespace limb_ring::ring_sim {

namespace {

struct CompareTracesOptions {
  std::string first, second;
};

std::string line_of(const std::optional<capture::PcapngReader::Record>& record, const capture::RingNames& names) {
  if (!record) return "ends here";
  app::PacketText text(names, {});
  return std::visit([&text](const auto& of) { return text.line(of); }, *record);
}

/// Where one ends in the middle, nobody knows what would have come next: neither the same nor different.
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
                                  "Both are of rings on a virtual clock. Ends with 1 if they differ.");
  command
      ->add_option("A", options->first,
                   "pcapng, from 'ringctl up --clock virtual --capture', 'ringctl scenario run' or 'ring_sim run'")
      ->required();
  command->add_option("B", options->second, "pcapng of another run")->required();
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ring_sim
