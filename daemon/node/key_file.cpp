#include "node/key_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "config/config_error.h"
#include "io/unique_fd.h"

namespace limb_ring::config {
namespace {

constexpr const char* kHex = "0123456789abcdef";
constexpr std::size_t kTextSize = 2 * sizeof(KeyBytes) + 1;

process::UniqueFd open_file(const std::string& path, int flags) {
  return process::UniqueFd(::open(path.c_str(), flags | O_CLOEXEC, S_IRUSR | S_IWUSR));
}

ConfigError failure(const std::string& path, const std::string& what) {
  return ConfigError("links.key: " + path + ": " + what);
}

std::string why() { return std::generic_category().message(errno); }

/// A key that others can read or write keeps nobody out.
void check_owner(int fd, const std::string& path) {
  struct stat found {};
  if (::fstat(fd, &found) != 0) throw failure(path, why());
  if (!S_ISREG(found.st_mode)) throw failure(path, "is no file");
  if (found.st_uid != ::geteuid())
    throw failure(path, "belongs to user " + std::to_string(found.st_uid) + ", and this is user " +
                            std::to_string(::geteuid()) + ": it has to be of the user who runs the ring");
  if ((found.st_mode & (S_IRWXG | S_IRWXO)) == 0) return;
  throw failure(path, "others may use it: 'chmod 600 " + path +
                          "', and if somebody may have read it, a new one of 'ringctl hosts key' on all hosts");
}

int digit(char c) {
  const std::size_t at = std::string(kHex).find(c);
  return at == std::string::npos ? -1 : static_cast<int>(at);
}

}  // namespace

KeyBytes read_key_file(const std::string& path) {
  const process::UniqueFd file = open_file(path, O_RDONLY | O_NONBLOCK);
  if (!file.valid())
    throw failure(path, why() + "; 'ringctl hosts key " + path + "' makes one, to be copied to all hosts");
  check_owner(file.get(), path);
  std::array<char, kTextSize + 1> text{};
  const ssize_t got = ::read(file.get(), text.data(), text.size());
  KeyBytes key;
  bool good = got == kTextSize && text[kTextSize - 1] == '\n';
  for (std::size_t i = 0; good && i < key.size(); ++i) {
    const int high = digit(text[2 * i]), low = digit(text[2 * i + 1]);
    good = high >= 0 && low >= 0;
    key[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  if (!good)
    throw failure(path, "holds no key: 64 hexadecimal digits and a newline, as 'ringctl hosts key' writes them");
  return key;
}

void make_key_file(const std::string& path) {
  KeyBytes key;
  if (::getrandom(key.data(), key.size(), 0) != static_cast<ssize_t>(key.size()))
    throw ConfigError("no random numbers: " + why());
  std::string text;
  for (const std::uint8_t byte : key) text += {kHex[byte >> 4], kHex[byte & 15]};
  text += '\n';
  const process::UniqueFd file = open_file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.valid()) throw ConfigError(path + ": " + why() + (errno == EEXIST ? "; it is left as it is" : ""));
  if (::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(file.get()) == 0)
    return;
  const std::string reason = why();
  ::unlink(path.c_str());  // part of a key is useless, and the file would stop the next try
  throw ConfigError(path + ": " + reason);
}

}  // namespace limb_ring::config
