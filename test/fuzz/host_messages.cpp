// Messages on a host port, from a client to its daemon and back.
#include "client/arguments.h"
#include "client/frame.h"
#include "client/host_message.h"
#include "fuzz/fuzz.h"

using namespace limb_ring;

namespace {

template <class Decode>
void each_frame(wire::ByteView bytes, std::size_t most, Decode decode) {
  client::FrameParse parse;
  while ((parse = client::parse_frame(bytes, most)).status == client::FrameParse::Status::frame) {
    fuzz::require(parse.consumed <= bytes.size, "a frame lies within what was read");
    decode(parse.frame);
    bytes = bytes.from(parse.consumed);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  each_frame({data, size}, client::kMaxSizeToDaemon, [](const client::Frame& frame) {
    const auto message = client::decode_to_daemon(frame);
    if (!message) return;
    client::Bytes again;
    std::visit([&](const auto& what) { client::append(again, what); }, *message);
    const auto parse = client::parse_frame({again.data(), again.size()}, client::kMaxSizeToDaemon);
    fuzz::require(parse.status == client::FrameParse::Status::frame && client::decode_to_daemon(parse.frame),
                  "a client's message is encoded as it was decoded");
  });
  each_frame({data, size}, client::kMaxSizeToClient,
             [](const client::Frame& frame) { client::decode_to_client(frame); });
  return 0;
}
