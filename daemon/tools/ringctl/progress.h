#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace limb_ring::ringctl {

/// Says on standard error what is being waited for, once it takes longer than two seconds, and
/// then every two seconds.
class Progress {
 public:
  /// @param ring where its virtual clock stands, that is said instead: nothing else comes. Empty: no such ring
  explicit Progress(std::string ring = {});
  /// @param what empty: nothing but that the clock stands
  void tell(const std::string& what = {});

 private:
  std::string ring_;
  std::chrono::steady_clock::time_point next_;
};

/// Does `work`, which tells nothing, and tells meanwhile `what` it is, or where the ring's virtual clock stands.
/// @param ring, what as in Progress
/// @throw what `work` throws; NotKnown instead of HostPortTimeout where the clock stands
void while_telling(const std::string& ring, const std::function<void()>& work, const std::string& what = {});

}  // namespace limb_ring::ringctl
