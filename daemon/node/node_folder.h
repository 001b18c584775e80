#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "config/ring_config.h"
#include "io/node_clock.h"
#include "io/unique_fd.h"
#include "node/host_server.h"

namespace limb_ring::runtime {

/// The last boot number of a node, kept in the ring's folder beside its lock (`ID.boot`, 8 bytes, big-endian), so that
/// a new process continues where the previous one ended, even after kill -9. A packet carries two bits of its
/// source's boot number. As the new process counts these on by one, they tell the two processes apart before any
/// hello is heard. (ours, protocol.md section 4.8)
class BootRecord {
 public:
  /// Opens or creates the file. If it holds no number, the previous one is unknown. The same if it cannot be opened,
  /// which is logged as a warning.
  BootRecord(const std::string& directory, std::uint8_t id);

  /// The first boot number of a new process: nanoseconds since 1970, or the previous number + 1 if that is higher. Its
  /// two low bits are always those of the previous number + 1, if that is known.
  std::uint64_t first(std::uint64_t now_ns) const;
  /// The node's current boot number. Written to the file only if it has changed.
  void note(std::uint64_t boot) {
    if (boot != last_) write(boot);
  }

 private:
  void write(std::uint64_t boot);

  process::UniqueFd fd_;
  std::uint64_t last_ = 0;  ///< 0: unknown
};

/// The files of one node in its ring's runtime folder, except its sockets: the lock, which keeps other daemons off,
/// and the boot record.
class NodeFolder {
 public:
  /// @throw host::NodeHeld if another daemon holds the node, std::exception if it cannot be made
  NodeFolder(const config::RingConfig& ring, const config::NodeConfig& node);

  const std::string& path() const { return path_; }
  bool is_in_place() const { return lock_ && lock_->is_in_place(); }
  /// Makes them again after the folder was removed. @throw as the constructor
  void make_again();

  /// The first boot number of this process: see BootRecord::first().
  std::uint64_t first_boot() const;
  void note_boot(std::uint64_t boot) { boots_->note(boot); }

 private:
  const config::RingConfig& ring_;
  const config::NodeConfig& node_;
  std::string path_;
  std::optional<host::NodeLock> lock_;  ///< none if it could not be taken again
  std::optional<BootRecord> boots_;
};

/// Keeps a node reachable whose runtime folder is removed under it (the end of a login, a cleaner of temporary
/// files): checks once a second, and has what is missing made again. Connections that stand do not notice. Nor does
/// the folder, which is mostly in memory, fill up with the log of a CPU that writes all the time: that is looked at
/// twenty times a second. (ours)
class FolderWatch {
 public:
  struct Folder {
    std::string path;
    std::function<bool()> is_in_place;
    /// @throw host::NodeHeld if another daemon has taken the node meanwhile, std::exception if it cannot be
    /// made (yet)
    std::function<void()> make_again;
    /// Another daemon has the node; ours has to end without touching that one's files.
    std::function<void()> give_up;
  };

  FolderWatch(boost::asio::io_context& io, Folder folder);
  ~FolderWatch() { stop(); }
  void start();
  void stop();

 private:
  void check_folder_later();
  void check_folder();
  void check_log();

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  std::optional<event_loop::Ticker> log_ticker_;
  Folder folder_;
  std::shared_ptr<bool> stopped_ = std::make_shared<bool>(false);  ///< outlived by a call that is due
  bool told_ = false;                                              ///< that it cannot be made
};

}  // namespace limb_ring::runtime
