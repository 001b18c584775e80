#include "node/link_settings.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "config/core_settings.h"
#include "config/quantity.h"
#include "io/seal.h"
#include "io/unique_fd.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::setup {
namespace {

using config::LinkConfig;
using config::NodeConfig;
using config::RingConfig;
using core::Line;

/// Where node `to` listens for node `from`.
link::Endpoint endpoint_between(const NodeConfig& from, const NodeConfig& to, const std::string& directory, Line line) {
  const bool second = line == Line::second;
  const LinkConfig::Transport transport = config::transport_between(from, to);
  if (transport == LinkConfig::Transport::udp)
    return link::Endpoint::udp(to.link.address, second ? to.link.second_port() : to.link.port);
  std::string path = socket_path(directory, std::to_string(to.id), second ? "link2" : "link");
  return transport == LinkConfig::Transport::shm ? link::Endpoint::shm(std::move(path))
                                                 : link::Endpoint::unix_stream(std::move(path));
}

/// If it listens for the nodes of other hosts; nothing if there are none. By a bypass each of them may come to
/// be its upstream neighbour, however far away it is.
std::optional<link::Endpoint> endpoint_from_hosts(const RingConfig& ring, const NodeConfig& node,
                                                  const std::string& directory, Line line) {
  if (node.link.transport == LinkConfig::Transport::udp) return std::nullopt;  // one endpoint for all
  for (const NodeConfig& other : ring.nodes)
    if (other.host != node.host) return endpoint_between(other, node, directory, line);
  return std::nullopt;
}

/// Of the nodes in that order.
std::vector<std::string> names_on(const RingConfig& ring, Line line) {
  std::vector<std::string> names;
  for (const std::uint8_t id : order_on(ring, line)) names.push_back(ring.find(id)->name);
  return names;
}

bool has_udp_lines(const RingConfig& ring) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(), [&ring](const NodeConfig& node) {
    return config::transport_between(ring.nodes[0], node) == LinkConfig::Transport::udp ||
           node.link.transport == LinkConfig::Transport::udp;
  });
}

/// Of the UDP lines that run in this direction; none if they are not keyed, or if there are none: a ring of many
/// hosts that is tried out on one machine needs no key there. @throw config::ConfigError
std::shared_ptr<const link::LineKey> key_of(const RingConfig& ring, Line line) {
  if (ring.links.key.empty() || !has_udp_lines(ring)) return nullptr;
  return std::make_shared<link::LineKey>(config::read_key_file(ring.links.key), link::ring_hash(ring.ring),
                                         line == Line::second);
}

link::Identity identity_of(const RingConfig& ring, const NodeConfig& node, Line line) {
  return {link::ring_hash(ring.ring), node.id, agreement_of(ring), key_of(ring, line)};
}

link::InputSettings input_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                   Line line) {
  return {identity_of(ring, node, line),
          endpoint_between(node, node, directory, line),
          order_on(ring, line),
          timing_of(ring),
          node.link.delay,
          endpoint_from_hosts(ring, node, directory, line),
          names_on(ring, line),
          ring.hosts.size() > 1};
}

link::OutputSettings output_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory,
                                     Line line) {
  link::OutputSettings s{identity_of(ring, node, line), {}, timing_of(ring)};
  const std::size_t at = index_of(ring, node);
  const std::size_t nodes = ring.nodes.size();
  for (std::size_t i = 1; i <= nodes; ++i) {
    const NodeConfig& next = ring.nodes[(at + (line == Line::first ? i : nodes - i)) % nodes];
    s.candidates.push_back({next.id, endpoint_between(node, next, directory, line)});
  }
  return s;
}

}  // namespace

std::vector<std::uint8_t> order_on(const RingConfig& ring, Line line) {
  const core::RingOrder ids = order_of(ring);
  std::vector<std::uint8_t> order(ids.begin(), ids.end());
  if (line == Line::second) std::reverse(order.begin(), order.end());
  return order;
}

link::Timing timing_of(const RingConfig& ring) {
  return {ring.timeouts.idle, ring.timeouts.silence, ring.timeouts.first_successor};
}

std::vector<LinkSettings> link_settings(const RingConfig& ring, const NodeConfig& node, const std::string& directory) {
  std::vector<LinkSettings> lines;
  for (const Line line : core::Lines(ring.folds_back()))
    lines.push_back({line, input_settings(ring, node, directory, line), output_settings(ring, node, directory, line)});
  return lines;
}

namespace {

using config::JointConfig;
using config::PinConfig;
using config::SensorConfig;

/// A line of text for each node in ring order: its id and what `rest` says of it.
template <typename Rest>
std::string line_per_node(const RingConfig& ring, Rest rest) {
  std::string text;
  for (const NodeConfig& node : ring.nodes) text += std::to_string(node.id) + rest(node) + '\n';
  return text;
}

std::string redundancy_text(const RingConfig& ring) { return ring.folds_back() ? "foldback\n" : "none\n"; }

std::string timeouts_text(const config::Timeouts& t) {
  std::string text;
  for (const auto time :
       {t.send, t.stall, t.idle, t.silence, t.first_successor, t.break_grace, t.fold_permission, t.beacon})
    text += std::to_string(time.count()) + '\n';
  return text;
}

std::string line_text(const NodeConfig& node) {
  return ' ' + std::to_string(node.link.rate) + ' ' + std::to_string(node.link.whole_delay().count());
}

std::string joints_text(const NodeConfig& node) {
  std::string text;
  for (const JointConfig& joint : node.joints) text += (joint.slides() ? " slide " : " joint ") + joint.name;
  for (const SensorConfig& sensor : node.sensors)
    text += (sensor.kind == SensorConfig::Kind::imu ? " imu " : " force ") + sensor.name;
  return text;
}

std::string pins_text(const NodeConfig& node) {
  std::string text;
  for (const PinConfig& pin : node.pins) text += std::string(" ") + config::name_of(pin.action);
  return text;
}

}  // namespace

link::Agreement agreement_of(const RingConfig& ring) {
  return {{link::text_hash(line_per_node(ring, [](const NodeConfig& node) { return ' ' + node.name; })),
           link::text_hash(redundancy_text(ring)), link::text_hash(timeouts_text(ring.timeouts)),
           link::text_hash(line_per_node(ring, line_text)), link::text_hash(line_per_node(ring, joints_text)),
           link::text_hash(line_per_node(ring, pins_text)),
           link::text_hash(std::to_string(config::supervisor_of(ring).id) + '\n')}};
}

}  // namespace limb_ring::setup

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
  if (!S_ISREG(found.st_mode)) throw failure(path, "is not a file");
  if (found.st_uid != ::geteuid())
    throw failure(path, "belongs to user " + std::to_string(found.st_uid) + ", and this is user " +
                            std::to_string(::geteuid()) + ": it must belong to the user who runs the ring");
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
