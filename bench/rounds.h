#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/setup.h"
#include "bench/suite.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

/// How many nodes can have a core each; 0: this machine has too few cores.
unsigned spin_nodes(const Setup& setup);

/// "one core", "unpinned"
std::string words(Pinning pinning);

/// Measures all rings at one pinning, round by round, each beside the reference.
class Rounds {
 public:
  /// Setup and folder outlive this.
  Rounds(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning);

  void run();
  std::vector<Row> rows() const { return cases_.rows(pinning_); }

 private:
  /// Files of rings, which all rounds have in common.
  struct Files {
    std::string two_cpus, keyed;
  };

  void run_round(const Files& files, bool odd);
  void ring(const std::string& what, const RingRequest& request);
  /// The same again while a dump reads all that one node sees: what that costs.
  void watched(const PrivateRing& ring, Sending sending, const Measurement& unwatched, double reference);
  /// A ring with every node's flight recorder on beside one without, in turns: what that costs.
  /// @param first with it
  void recorded(bool first);
  /// A ring with somebody at work beside it, and the same without, in turns: what that costs.
  /// @tparam AtWork RingJudge, RingLook @param first with it
  template <typename AtWork>
  void beside(const std::string& what, bool first);
  void cpu_to_cpu(const std::string& two_cpus);
  void spin();
  double measure_reference_p50(Sending sending);
  void tell(const std::string& what, Sending sending) const;

  const Setup& setup_;
  const live::PrivateFolder& folder_;
  Pinning pinning_;
  std::string where_;
  Cases cases_;
  std::map<Sending, Measurement> udp_;  ///< of this round
};

}  // namespace limb_ring::bench
