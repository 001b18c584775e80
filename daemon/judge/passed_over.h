#pragma once

#include <string>
#include <vector>

#include "judge/violation.h"
#include "wire/packet.h"

namespace limb_ring::sim {

class Ledger;
struct Sent;

/// Sends that waited while another send of their node, which should go after them, went onto the line. They are judged
/// when that instant is over, since results of the same instant are told at its end. (protocol.md section 4.5)
class PassedOver {
 public:
  PassedOver(Ledger& ledger, const Complain& complain) : ledger_(ledger), complain_(complain) {}

  /// @param since when the other one began to leave
  void note(const Sent& waiting, const Sent& leaving, core::Time since);
  /// Judges what was noted in instants before `now`.
  void judge(core::Time now) {
    if (!noted_.empty()) judge_noted(now);
  }
  template <class Archive>
  void archive(Archive& a) {
    a("noted", noted_);
  }

 private:
  struct Noted {
    wire::NodeId source;
    std::uint32_t token;
    core::Time since;
    Promise promise;
    std::string what;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("token", token)("since", since)("promise", promise)("what", what);
    }
  };
  void judge_noted(core::Time now);

  Ledger& ledger_;
  const Complain& complain_;
  std::vector<Noted> noted_;
};

}  // namespace limb_ring::sim
