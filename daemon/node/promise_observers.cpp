#include "node/promise_observers.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "node/request_fields.h"

namespace limb_ring::runtime {

PromiseObservers::PromiseObservers(wire::NodeId self, std::string folder, NodeDriver& driver, host::HostServer& host)
    : path_(std::move(folder) + '/' + std::to_string(self) + ".watch"), driver_(driver), host_(host) {}

void PromiseObservers::set(host::ClientId client, bool wanted) {
  if (!wanted) return remove(client);
  if (!file_) start();
  put_back();
  clients_.insert(client);
  tell(client);
}

void PromiseObservers::remove(host::ClientId client) {
  clients_.erase(client);
  if (clients_.empty()) stop();
}

void PromiseObservers::start() {
  using std::chrono::nanoseconds;
  const core::NetworkController& controller = driver_.controller();
  const auto zero = std::chrono::duration_cast<nanoseconds>(driver_.steady(core::Time{}).time_since_epoch());
  file_ = std::make_unique<promises::ObservationFile>(path_);
  observer_ = std::make_unique<promises::NodeObserver>(
      controller.settings(), zero, [this] { return driver_.controller().received_waiting(); }, *file_);
  driver_.set_journal(observer_.get());
}

bool PromiseObservers::is_in_place() const { return !file_ || file_->is_there(); }

void PromiseObservers::put_back() {
  if (is_in_place()) return;
  file_->make_again();
  for (const host::ClientId client : clients_) tell(client);
}

void PromiseObservers::stop() {
  if (!file_) return;
  driver_.set_journal(nullptr);
  observer_.reset();
  file_.reset();
}

void PromiseObservers::tell(host::ClientId client) {
  const core::NetworkController& controller = driver_.controller();
  const nlohmann::json where{{"kind", "promises"},
                             {"path", file_->path()},
                             {"from", file_->count()},
                             {"state", static_cast<unsigned>(controller.membership().state())},
                             {"at_ns", driver_.steady(driver_.now()).time_since_epoch().count()},
                             {"longest_send_ns", promises::longest_send(controller.settings()).count()}};
  host_.observed(client, text_of(where));
}

}  // namespace limb_ring::runtime
