#include "comparison/plots/gnuplot.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <thread>

#include "io/child.h"
#include "io/program.h"
#include "io/spawn.h"

namespace limb_ring::comparison {

namespace {

using std::chrono::steady_clock;
constexpr std::chrono::milliseconds kTick{5};

/// @return false: it took too long, and was killed
bool wait_for(process::Child& child, std::chrono::milliseconds limit) {
  const auto deadline = steady_clock::now() + limit;
  while (!child.reap()) {
    if (steady_clock::now() >= deadline) {
      child.kill();
      return false;
    }
    std::this_thread::sleep_for(kTick);
  }
  return true;
}

/// The last of what was written into `file`.
std::string last_words(int file) {
  std::array<char, 600> text{};
  const off_t size = ::lseek(file, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t read = ::pread(file, text.data(), text.size(), from);
  return read > 0 ? std::string(text.data(), static_cast<std::size_t>(read)) : std::string{};
}

}  // namespace

std::string find_gnuplot() {
  const std::string path = process::find_program("gnuplot");
  if (path.empty())
    throw std::runtime_error("plots need gnuplot, which is not on PATH: install the package gnuplot-nox");
  return path;
}

void run_gnuplot(const std::string& gnuplot, const std::string& folder, const std::string& script,
                 std::chrono::milliseconds limit) {
  const process::UniqueFd output(::memfd_create("gnuplot", MFD_CLOEXEC));
  process::SpawnRequest request;
  request.path = gnuplot;
  request.arguments = {"gnuplot", "-d", script};  // -d: whatever the user's own start-up file says
  request.folder = folder;
  request.output = output.get();
  process::Child child(process::spawn(request), gnuplot);
  if (child.ended()) throw std::runtime_error("cannot start gnuplot: " + child.ended()->text);
  const std::string where = "gnuplot failed on " + folder + "/" + script + ": ";
  if (!wait_for(child, limit))
    throw std::runtime_error(where + "no end after " + std::to_string(limit.count()) + " ms");
  if (!child.ended()->executed) throw std::runtime_error(where + child.ended()->text);
  if (!child.ended()->clean) throw std::runtime_error(where + last_words(output.get()));
}

}  // namespace limb_ring::comparison
