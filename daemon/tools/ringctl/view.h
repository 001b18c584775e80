#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/unique_fd.h"

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

  /// @throw std::runtime_error where too many files are open
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
  /// The newest status row of a node; empty where there is none.
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

}  // namespace limb_ring::ringctl
