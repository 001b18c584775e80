#pragma once

#include <cstddef>
#include <string_view>

#include "io/link_header.h"
#include "wire/slice.h"

namespace limb_ring::link {

/// One connection to a candidate for our downstream neighbour, from the first attempt on. Calls
/// its owner from the event loop only, never from within a call, and not after close().
class Downstream {
 public:
  /// Headers of the other end that are read in a row, before others get their turn; a node sends a few in a second.
  static constexpr int kMostHeaders = 64;
  /// Bytes that may wait for the socket. Far above what one batch brings: the Packet Manager writes only while nothing
  /// waits.
  static constexpr std::size_t kMostWaiting = 1 << 20;

  /// `candidate` is its index in OutputSettings::candidates.
  struct Owner {
    virtual void on_accepted(std::size_t candidate) = 0;
    virtual void on_refused(std::size_t candidate, const LinkHeader& refuse) = 0;
    /// As on_refused, but the sender has not proved who it is: for people only, nothing else follows from it.
    virtual void on_hint(std::size_t candidate, const LinkHeader& refuse) = 0;
    virtual void on_no_node(std::size_t candidate) = 0;  ///< what is there answers, but is no node of the ring
    virtual void on_ended(std::size_t candidate, std::string_view reason) = 0;
    virtual void on_heard(std::size_t candidate) = 0;    ///< it says that it is alive
    virtual void on_drained(std::size_t candidate) = 0;  ///< nothing waits inside any more

   protected:
    ~Owner() = default;
  };

  virtual ~Downstream() = default;
  /// @return false: nobody is there; no call follows.
  virtual bool start() = 0;
  /// Whole framed slices. What the socket does not take waits inside, up to a limit, beyond
  /// which the line counts as ended.
  virtual void write(wire::ByteView slices) = 0;
  /// A slice to be sent after the next one, with its own sequence number: it arrives late.
  /// @return false: not possible on this line, or not now; nothing was taken.
  virtual bool hold_back(wire::ByteView) { return false; }
  virtual bool drained() const = 0;
  /// Says that this end lives, though it has nothing to send.
  virtual void say_idle() {
    wire::SliceWriter idle;
    idle.put(wire::SliceKind::idle, {});
    write(idle.view());
  }
  /// Once per `idle`: looks for signs of life of the other end, which alone do not wake this end.
  virtual void tick() = 0;
  /// Called now and then until accepted: asks again where questions can get lost.
  virtual void ask_again() = 0;
  virtual void close() = 0;
  /// As close(), but without telling the other end: as when the wire breaks.
  virtual void sever() { close(); }
};

}  // namespace limb_ring::link
