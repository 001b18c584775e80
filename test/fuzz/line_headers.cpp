// Handshakes of UNIX and UDP lines, and the headers of datagrams.
#include "fuzz/fuzz.h"
#include "io/link_header.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto header = link::parse_header({data, size});
  if (!header) return 0;
  fuzz::require(size >= link::kLinkHeaderSize, "a header is all there");
  fuzz::require(!link::reason_of(*header).empty(), "every refusal has words");
  if (header->version != link::kLinkVersion) return 0;
  const auto bytes = link::encode(*header);
  const auto again = link::parse_header({bytes.data(), bytes.size()});
  fuzz::require(again && again->type == header->type && again->ring == header->ring &&
                    again->session == header->session && again->sequence == header->sequence &&
                    again->sender == header->sender && again->refusal == header->refusal,
                "a header is encoded as it was parsed");
  return 0;
}
