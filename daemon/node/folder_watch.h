#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "io/ticker.h"

namespace limb_ring::runtime {

/// Keeps a node reachable whose runtime folder is removed under it (the end of a login, a cleaner of temporary
/// files): checks once a second, and has what is missing made again. Connections that stand do not notice. Nor does
/// the folder, which is mostly in memory, fill up with the log of a CPU that writes all the time: that is looked at
/// twenty times a second. (ours)
class FolderWatch {
 public:
  struct Folder {
    std::string path;
    std::function<bool()> is_in_place;
    /// @throw host::NodeHeld where another daemon has taken the node meanwhile, std::exception where it cannot be
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
