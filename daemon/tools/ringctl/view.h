#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/unique_fd.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

/// What `ringctl view` shows of a running ring, asked in a thread of its own, and only while somebody looks: status
/// rows with rates, events, packets and joint positions, as the JSON that web/view.mjs reads. (ours)
///
/// What it tells (docs/how-to/view.md says what the page makes of it):
///   ring      {"ring", "folds_back", "nodes": [{"id", "name", "joints": [{"name", "lower", "upper", "slides"}],
///              "pins": ["INT0: reset"], "inputs": ["0: INT1 to all"]}]}
///   status    {"headline", "report", "clock", "interval_s", "broken_line", "rows": as `status --watch --json`, with
///              "faults" and "fold"}
///   happened  {"time_ns", "node", "kind", "text"}
///   packets   {"at": node, "rate": a second on that line, "sample": every so many-th is shown,
///              "list": [[time in us, source, destination, kind 0 data, 1 control, 2 INTP, bytes, damaged 0 or 1]],
///              "joints": {node: [[time in us, positions ...]]}}
///   problem   {"text"}: the ring cannot be asked; it is tried again
class ViewedRing {
 public:
  using Tell = std::function<void(const std::string& event, const std::string& json)>;

  /// @throw std::runtime_error if too many files are open
  explicit ViewedRing(std::string ring);
  ~ViewedRing();
  ViewedRing(const ViewedRing&) = delete;
  ViewedRing& operator=(const ViewedRing&) = delete;

  /// Whether somebody looks: else nothing is asked.
  void look(bool somebody);
  /// Readable while something that was told waits for take(). It belongs to this.
  int told_fd() const { return told_fd_.get(); }
  /// Calls `tell` for each that waits, in their order, and says how many were left out because too many waited.
  void take(const Tell& tell);
  /// The newest status row of a node; empty if there is none.
  std::string row(const std::string& id) const;

 private:
  /// From the thread that asks.
  void put(const std::string& event, std::string text);
  void run();
  void look_on();
  bool wait_for_somebody();

  const std::string ring_;
  const process::UniqueFd told_fd_;
  mutable std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> told_;  ///< and not taken
  std::size_t left_out_ = 0;                               ///< since the last take()
  std::condition_variable changed_;
  std::atomic<bool> looked_at_{false}, ends_{false};
  std::map<std::string, std::string> rows_;  ///< by id
  std::thread thread_;
};

/// What `ringctl view` serves, and to whom.
struct ViewOptions {
  std::string ring;
  std::string address = "127.0.0.1";  ///< to listen at, IPv4 or IPv6 in numbers
  std::uint16_t port = 0;             ///< 0: any that is free
  bool control = false;               ///< the page may break and mend
  std::string folder;                 ///< of the page's files
};

/// Serves the page for a running ring by HTTP, until SIGINT or SIGTERM. (ours)
///
/// The address that is printed holds a token of 128 random bits; without it nothing is given. Requests are bounded in
/// size and time, clients in number; one that reads too slowly is dropped. Requests of other origins, and those for a
/// host that is a name but localhost (DNS rebinding), are refused. Without `control` nothing can be changed. What the
/// page orders is done by a ringctl of its own, so it is what the same words do on a command line.
/// @return an ExitCode. @throw UsageError if the address cannot be had, or the page's files are not there
int serve_view(const ViewOptions& options);

/// The command line for an order of the page, such as ["fault", "hang", "left_knee"], without "ringctl --ring RING".
/// @throw UsageError if that is none of those that a page may give, or a word is not a plain one
std::vector<std::string> ordered_words(const std::string& json);

/// Whether requests for this Host are answered: numbers or localhost, at this port.
bool is_own_host(const std::string& host, std::uint16_t port);

/// Same length and bytes, in a time that does not tell where they differ.
bool is_same_secret(const std::string& one, const std::string& other);

}  // namespace limb_ring::ringctl
