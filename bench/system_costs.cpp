#include "bench/system_costs.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "bench/cores.h"
#include "bench/shared.h"
#include "bench/waits.h"
#include "bench/worker.h"
#include "io/unique_fd.h"

namespace limb_ring::bench {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kCostTime{100};

template <typename Once>
double us_each(Once once) {
  const auto begun = steady_clock::now();
  std::size_t times = 0;
  auto now = begun;
  for (; now - begun < kCostTime; now = steady_clock::now())
    for (int i = 0; i < 100; ++i, ++times) once();
  return std::chrono::duration<double, std::micro>(now - begun).count() / static_cast<double>(times);
}

struct Pipe {
  Pipe() {
    int ends[2];
    if (::pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
    from.reset(ends[0]);
    to.reset(ends[1]);
  }
  process::UniqueFd from, to;
};

bool pass(int from, int to) {
  char byte = 0;
  return ::read(from, &byte, 1) == 1 && ::write(to, &byte, 1) == 1;
}

struct Measured {
  std::atomic<bool> done{false};
  SystemCosts costs;
};

void measure(Pipe& there, Pipe& back, Measured& measured) {
  measured.costs.system_call = us_each([] { ::syscall(SYS_getppid); });
  const char first = 0;
  if (::write(there.to.get(), &first, 1) != 1) return;
  measured.costs.process_switch = us_each([&] { pass(back.from.get(), there.to.get()); }) / 2;
  measured.done = true;
}

}  // namespace

SystemCosts measure_system_costs() {
  const auto cores = cores_for(Pinning::one_core);
  Pipe there, back;
  Shared<Measured> measured(1);
  Worker echo([&] {
    stay_on(cores);
    while (pass(there.from.get(), back.to.get())) {
    }
  });
  Worker other([&] {
    stay_on(cores);
    measure(there, back, measured[0]);
  });
  while (other.running()) std::this_thread::sleep_for(kTick);
  if (!measured[0].done) throw std::runtime_error("the cost of a process switch could not be measured");
  return measured[0].costs;
}

}  // namespace limb_ring::bench
