#pragma once

#include "core/events.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// A DATP to be sent.
struct SendRequest {
  Owner owner = kController;
  std::uint32_t token = 0;  ///< given back in SendEnded
  NodeId destination{0};    ///< 0..254, or wire::kBroadcast
  wire::Priority priority{};
  wire::ChannelId channel{};  ///< 1 is the network controllers' own
  wire::ByteView data;        ///< 1..512 bytes; copied

  template <class Archive>
  void archive(Archive& a) {
    a("owner", owner)("token", token)("destination", destination)("priority", priority)("channel", channel)("data",
                                                                                                            data);
  }
};

/// An INTP to be sent.
struct InterruptRequest {
  Owner owner = kController;
  std::uint32_t token = 0;
  NodeId destination{0};  ///< 0..254, or wire::kBroadcast
  wire::Factor factor{};

  template <class Archive>
  void archive(Archive& a) {
    a("owner", owner)("token", token)("destination", destination)("factor", factor);
  }
};

/// The SendEnded of a request, as far as it is known at the start. Its outcome is `rejected` until it gets another.
inline SendEnded end_of(const SendRequest& request) {
  SendEnded end;
  end.owner = request.owner;
  end.token = request.token;
  end.destination = request.destination;
  return end;
}
inline SendEnded end_of(const InterruptRequest& request) {
  SendEnded end;
  end.owner = request.owner;
  end.token = request.token;
  end.interrupt = true;
  end.destination = request.destination;
  end.factor = request.factor;
  return end;
}

}  // namespace limb_ring::core
