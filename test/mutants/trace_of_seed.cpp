// trace_of_seed SEED: the trace of a run under random faults, and its hash as the last line.
#include <cstdlib>
#include <iostream>

#include "sim/trace.h"
#include "study/random_faults.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: trace_of_seed SEED\n";
    return 2;
  }
  limb_ring::study::RandomFaults run(std::strtoull(argv[1], nullptr, 10));
  limb_ring::sim::Trace trace(run.ring(), &std::cout);
  run.run();
  std::cout << "seed " << argv[1] << " hash " << limb_ring::sim::hash_text(trace.hash()) << '\n';
  return run.violation() ? 1 : 0;
}
