// A peer that has much to say: a node's event loop has other work to do meanwhile.
#include <gtest/gtest.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include <boost/asio/post.hpp>

#include "io/link_rig.h"
#include "io/unix_line.h"
#include "io/unix_listener.h"

namespace limb_ring::link {
namespace {

/// Says that it lives as often as the socket takes it.
void say_much(int socket) {
  LinkHeader alive;
  alive.ring = LinkRig::kRing;
  alive.sender = 1;
  const auto header = encode(alive);
  std::vector<std::uint8_t> many;
  for (int i = 0; i < 10; ++i) many.insert(many.end(), header.begin(), header.end());
  while (send_now(socket, {many.data(), many.size()}) > 0) {
  }
}

/// What the other end has not read; in memory of the kernel's.
int unread(int socket) {
  int bytes = 0;
  EXPECT_EQ(::ioctl(socket, SIOCOUTQ, &bytes), 0);
  return bytes;
}

TEST(TalkativePeer, DoesNotKeepTheEventLoopFromItsOtherWork) {
  LinkRig rig(2, Endpoint::Transport::unix_stream);
  boost::asio::io_context elsewhere;
  event_loop::UnixListener door(elsewhere, rig.endpoint(1).path);
  rig.start_output(0);
  event_loop::UnixSocket peer(elsewhere);
  door.acceptor().accept(peer);
  say_much(peer.native_handle());
  const int said = unread(peer.native_handle());
  for (int i = 0; i < 3; ++i) {
    bool worked = false;
    boost::asio::post(rig.node(0).io, [&] { worked = true; });
    rig.node(0).io.restart();
    while (!worked) rig.node(0).io.run_one();
  }
  EXPECT_GT(unread(peer.native_handle()), said / 2);
  EXPECT_TRUE(rig.until([&] { return unread(peer.native_handle()) == 0; }));
}

}  // namespace
}  // namespace limb_ring::link
