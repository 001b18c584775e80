// A capture file.
#include <sstream>

#include "fuzz/fuzz.h"
#include "wire/pcapng.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  try {
    capture::PcapngReader reader(in, "a.pcapng");
    while (reader.next()) {
    }
  } catch (const capture::CaptureFileError& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
