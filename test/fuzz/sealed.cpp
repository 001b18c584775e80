// Datagrams of a keyed line, given anything: what the sealer has made is taken once; what was changed, cut or made up
// never.
#include <array>
#include <vector>

#include "fuzz/fuzz.h"
#include "io/seal.h"

using namespace limb_ring;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes sealed(link::Sealer& sealer, wire::ByteView content) {
  Bytes bytes(content.begin(), content.end());
  bytes.resize(content.size + link::kSealSize);
  sealer.seal(bytes.data(), content.size);
  return bytes;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const link::LineKey line(link::Key{1}, 42, false);
  const link::SessionKeys keys = line.session({{1}, {2}, 3, 4, 5});
  link::Sealer sealer(keys.forward);
  link::Opener opener(keys.forward);
  fuzz::Input input(data, size);
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    const wire::ByteView content = input.bytes(what & 0x3F);
    Bytes datagram = sealed(sealer, content);
    if ((what & 0x80) != 0) {  // made up, whatever its number says
      fuzz::require(opener.open(content) != link::Opener::Verdict::good, "what was made up is not taken");
    } else if ((what & 0x40) != 0) {
      const std::size_t at = input.byte() % datagram.size();
      const std::uint8_t change = input.byte();
      datagram[at] = static_cast<std::uint8_t>(datagram[at] ^ change);
      const bool good = opener.open({datagram.data(), datagram.size()}) == link::Opener::Verdict::good;
      fuzz::require(good == (change == 0), "only what is unchanged is taken");
    } else {
      const wire::ByteView all{datagram.data(), datagram.size()};
      fuzz::require(opener.open(all.first(all.size - 1)) != link::Opener::Verdict::good, "nothing cut is taken");
      fuzz::require(opener.open(all) == link::Opener::Verdict::good, "what is sealed is taken");
      fuzz::require(opener.open(all) == link::Opener::Verdict::replayed, "but once");
    }
  }
  return 0;
}
