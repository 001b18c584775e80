#include "config/as_read.h"

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace limb_ring::config {
namespace {

/// Named by the hash of its path (FNV-1a, 64 bits): paths are longer than names may be.
std::string place_kept(const std::string& folder, const std::string& path) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : std::filesystem::absolute(path).lexically_normal().string())
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  std::ostringstream name;
  name << folder << '/' << std::hex << hash << ".read";
  return name.str();
}

}  // namespace

void keep_as_read(const std::string& folder, const std::string& path, const std::string& text) {
  const std::string place = place_kept(folder, path);
  std::ofstream out(place, std::ios::binary);
  if (!out.write(text.data(), static_cast<std::streamsize>(text.size())).flush())
    throw std::runtime_error(place + ": cannot be written: " + std::strerror(errno));
}

std::optional<std::string> as_read(const std::string& path) {
  const char* folder = std::getenv(kAsRead);
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  std::ifstream in(place_kept(folder, path), std::ios::binary);
  if (!in) return std::nullopt;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace limb_ring::config
