#pragma once

#include <memory>
#include <set>
#include <string>

#include "judge/node_observer.h"
#include "judge/observation_file.h"
#include "node/host_server.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// Clients that judge the ring's promises. While there are any, what enters and leaves the node's network controller
/// is written into a file, ID.watch in the ring's folder. Each client is told the path of the file and the position
/// at which to begin. A file that was removed or cut off is made again, and all are told. While there are
/// none, this costs nothing. (ours)
class PromiseObservers {
 public:
  /// @param folder the ring's
  PromiseObservers(wire::NodeId self, std::string folder, NodeDriver& driver, host::HostServer& host);
  ~PromiseObservers() { stop(); }
  PromiseObservers(const PromiseObservers&) = delete;
  PromiseObservers& operator=(const PromiseObservers&) = delete;

  /// @throw std::system_error where the file cannot be made
  void set(host::ClientId client, bool wanted);
  void remove(host::ClientId client);

  /// Its file is there, or nobody needs it.
  bool is_in_place() const;
  /// Makes the file again where it is not, and tells all. @throw std::system_error
  void put_back();

 private:
  void start();
  void stop();
  void tell(host::ClientId client);

  std::string path_;
  NodeDriver& driver_;
  host::HostServer& host_;
  std::set<host::ClientId> clients_;
  std::unique_ptr<promises::ObservationFile> file_;
  std::unique_ptr<promises::NodeObserver> observer_;
};

}  // namespace limb_ring::runtime
