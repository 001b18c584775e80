#include "ns3_program.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

namespace limb_ring::hops {

namespace {

namespace fs = std::filesystem;

fs::path program() { return fs::read_symlink("/proc/self/exe").replace_filename("bench_ns3_ring"); }

/// What a shell reads as one word.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

}  // namespace

bool ns3_installed() { return fs::exists(program()); }

double ns3_ring(unsigned nodes, std::uint64_t hops) {
  const std::string command = quoted(program()) + " " + std::to_string(nodes) + " " + std::to_string(hops);
  const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "r"), pclose);
  double rate = 0;
  if (!output || std::fscanf(output.get(), "%lf", &rate) != 1) throw std::runtime_error("failed: " + command);
  return rate;
}

}  // namespace limb_ring::hops
