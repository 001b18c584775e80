#pragma once

#include <cstdint>
#include <string_view>

#include "wire/slice.h"

namespace limb_ring::link {

/// The reason of an input that was lost because nothing came for `silence`.
constexpr std::string_view kSilent = "silent";
/// That of one whose other end had given this one up, since this process stood still.
constexpr std::string_view kGivenUp = "given up: this process stood still";

/// What comes out of an Input. Calls come from the event loop, never from inside a call into the
/// Input. A handler may close() the Input; nothing is called after that.
struct InputHandler {
  virtual ~InputHandler() = default;
  /// In the order sent, each once; never an idle slice. The bytes are valid during the call only.
  virtual void on_slice(const wire::Slice& slice) = 0;
  /// After all slices of one read: now write what they led to.
  virtual void on_batch_end() = 0;
  /// Datagrams are missing here, or one was garbled: a packet that is coming in cannot be finished.
  virtual void on_input_gap() = 0;
  /// An upstream neighbour has connected. Another one's on_input_lost has come before.
  virtual void on_input_up(std::uint8_t from) = 0;
  /// It is gone, or another one takes its place. `reason` is for people.
  virtual void on_input_lost(std::string_view reason) = 0;
  /// A peer has asked to be our upstream neighbour that cannot be; once for each reason until an input comes up.
  /// `reason` is for people.
  virtual void on_unknown_peer(std::string_view reason) = 0;
};

}  // namespace limb_ring::link
