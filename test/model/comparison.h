#pragma once

#include <optional>
#include <string>

#include "core/network_controller.h"
#include "model/node.h"

namespace limb_ring::model {

/// Where specification and core part.
struct Difference {
  int node = 0;
  Time at{};
  std::string section, specified, core;
  std::string model;   ///< its state
  std::string before;  ///< what went in and out before
};
std::string in_words(const Difference& difference);

/// Does to a model what is done to a core, and compares what comes out of both.
///
/// What the specification leaves open is not compared:
///  - how the bytes of a DATP are spread over slices that are given out in the same instant (protocol.md section 6.3);
///  - the order of events of the same instant.
class Comparison final : public core::Journal {
 public:
  Comparison(core::NetworkController& controller, Time now);
  ~Comparison() override { controller_.set_journal(nullptr); }
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;

  void goes_in(const core::Input& input, Time now) override;
  void goes_out(core::Line line, wire::ByteView framed_slices) override;
  void taken(const core::Event& event, Time now) override;
  void taken(const core::ReceivedPacket& packet, Time now) override;

  const std::optional<Difference>& difference() const { return difference_; }
  Node& model() { return model_; }
  /// Its driver does not run it in time, or it takes no time: nothing is said of when it should have been, until it is.
  void stands_still() {
    stands_still_ = true;
    due_ = core::kNever;
  }
  /// So many calls before a difference are told with it.
  static inline std::size_t trace = 0;
  std::uint64_t compared() const { return compared_; }

 private:
  void note(const std::string& what);
  void nothing_left();
  void differ(std::string section, std::string specified, std::string core);

  core::NetworkController& controller_;
  Node model_;
  Time now_;
  Time due_ = core::kNever;  ///< the specification has something to do then
  bool ran_ = false;         ///< run() was the last call
  bool stands_still_ = false;
  Time went_on_ = core::kNever;  ///< it had stood still, and ran again in that instant
  std::uint64_t compared_ = 0;
  std::deque<std::string> last_;
  std::optional<Difference> difference_;
};

}  // namespace limb_ring::model
