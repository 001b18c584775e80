// Datagrams that come to the input of a plain UDP line, from a neighbour that knows its sessions and says anything:
// what is handed on comes between "up" and "lost", and datagrams are counted once each.
#include <array>
#include <boost/asio/io_context.hpp>
#include <vector>

#include "fuzz/fuzz.h"
#include "link/input.h"
#include "link/udp_socket.h"
#include "link/unix_socket.h"

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
  void on_input_gap(std::uint32_t lost) override { fuzz::require(up && lost != 0, "a gap is of a line that is up"); }
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

link::Endpoint free_endpoint() {
  boost::asio::io_context io;
  return link::Endpoint::udp("127.0.0.1",
                             link::listen_udp(io, link::Endpoint::udp("127.0.0.1", 0)).local_endpoint().port());
}

/// Node 1 of three, and this program as all others.
class Line {
 public:
  explicit Line(const link::Endpoint& endpoint)
      : input_(io_, settings(endpoint), heard_), socket_(link::connect_udp(io_, link::udp_address(endpoint))) {}

  void send(link::LinkHeader header, wire::ByteView behind) {
    std::vector<std::uint8_t> bytes(link::kLinkHeaderSize);
    link::store_header(bytes.data(), header);
    bytes.insert(bytes.end(), behind.begin(), behind.end());
    send({bytes.data(), bytes.size()});
  }
  void send(wire::ByteView datagram) {
    if (link::send_now(socket_.native_handle(), datagram) < 0) return;
    ++sent_;
    io_.restart();
    io_.poll();
    fuzz::require(input_.counters().datagrams == sent_, "a datagram is counted once");
    hear();
  }
  std::uint64_t session() const { return session_; }

 private:
  static link::InputSettings settings(const link::Endpoint& endpoint) {
    link::InputSettings settings;
    settings.self = {kRing, 1};
    settings.endpoint = endpoint;
    settings.order = {0, 1, 2};
    return settings;
  }
  void hear() {
    std::array<std::uint8_t, 256> bytes;
    for (;;) {
      const auto size = link::receive_now(socket_.native_handle(), bytes.data(), bytes.size());
      if (size <= 0) return;
      const auto header = link::parse_header({bytes.data(), static_cast<std::size_t>(size)});
      fuzz::require(header && header->ring == kRing && header->sender == 1, "it answers with headers of its own");
      if (header->type == link::LinkHeaderType::accept) session_ = header->session;
    }
  }

  boost::asio::io_context io_;
  Heard heard_;
  link::Input input_;
  link::UdpSocket socket_;
  std::uint64_t sent_ = 0, session_ = 0;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const link::Endpoint endpoint = free_endpoint();
  Line line(endpoint);
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
        line.send(input.bytes(what & 0x3F));
    }
  }
  return 0;
}
