// Datagrams that come to the input of a plain UDP line, from a neighbour that knows its sessions and says anything:
// what is handed on comes between "up" and "lost", and datagrams are counted once each.
#include <vector>

#include "fuzz/fuzz.h"
#include "io/datagram_input.h"

using namespace limb_ring;

namespace {

constexpr std::uint64_t kRing = 42;

struct Heard : link::InputHandler {
  void on_slice(const wire::Slice& slice) override {
    fuzz::require(up, "slices come while the line is up");
    fuzz::require(slice.kind != wire::SliceKind::idle, "idles are the line's own");
    fuzz::require(wire::slice_size_fits(slice.kind, slice.bytes.size), "a slice has a size that its kind may have");
  }
  void on_batch_end() override {}
  void on_input_gap() override { fuzz::require(up, "a gap is of a line that is up"); }
  void on_input_up(std::uint8_t) override {
    fuzz::require(!up, "one neighbour at a time");
    up = true;
  }
  void on_input_lost(std::string_view reason) override {
    fuzz::require(up && !reason.empty(), "what is lost was up, and why is said");
    up = false;
  }
  void on_unknown_peer(std::string_view what) override { fuzz::require(!what.empty(), "a stranger is named"); }
  bool up = false;
};

/// The line of node 1 of three, and this program as all others.
class Line : link::InputLine {
 public:
  Line()
      : input_(settings(), *this, heard_, report_, upstream_,
               [this](wire::ByteView datagram, const link::UdpAddress&) { hear(datagram); }) {}

  void send(link::LinkHeader header, wire::ByteView behind) {
    std::vector<std::uint8_t> bytes(link::kLinkHeaderSize);
    link::store_header(bytes.data(), header);
    bytes.insert(bytes.end(), behind.begin(), behind.end());
    send({bytes.data(), bytes.size()});
  }
  void send(wire::ByteView datagram) {
    input_.take(datagram, {}, now_);
    fuzz::require(report_.counters.datagrams == ++sent_, "a datagram is counted once");
  }
  void pass(link::milliseconds time) {
    now_ += time;
    input_.end_batch();
    if (input_.tick(now_)) input_.lose_if_silent();
  }
  std::uint64_t session() const { return session_; }

 private:
  static link::InputSettings settings() {
    link::InputSettings settings;
    settings.self = {kRing, 1};
    settings.order = {0, 1, 2};
    return settings;
  }
  void hear(wire::ByteView datagram) {
    const auto header = link::parse_header(datagram);
    fuzz::require(header && header->ring == kRing && header->sender == 1, "it answers with headers of its own");
    if (header->type == link::LinkHeaderType::accept) session_ = header->session;
  }
  void close() override { input_.close(); }
  std::optional<std::uint8_t> from() const override { return input_.from(); }
  void replace(std::uint8_t by) override { input_.replace(by); }

  Heard heard_;
  link::InputReport report_;
  link::Upstream upstream_;
  link::Time now_{};
  std::uint64_t sent_ = 0, session_ = 0;
  link::DatagramInput input_;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Line line;
  fuzz::Input input(data, size);
  std::uint32_t sequence = 0;
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    link::LinkHeader header;
    header.ring = kRing;
    header.sender = what & 3;
    switch (what >> 6) {
      case 0:
        header.type = link::LinkHeaderType::slices;
        header.session = line.session();
        header.sequence = sequence += static_cast<std::int8_t>(input.byte());
        line.send(header, input.bytes(what & 0x3C));
        break;
      case 1: {
        header.type = link::LinkHeaderType::connect;
        header.session = std::uint64_t{input.byte()} << 32;
        const auto bytes = link::encode_connect(header, {});
        line.send({bytes.data(), bytes.size()});
        sequence = 0;
        break;
      }
      case 2:
        header.type = static_cast<link::LinkHeaderType>(input.byte());
        header.session = line.session() + (what & 4);
        line.send(header, input.bytes(what & 0x3C));
        break;
      default:
        if ((what & 0x20) != 0) line.pass(link::milliseconds(50));
        line.send(input.bytes(what & 0x1F));
    }
  }
  return 0;
}
