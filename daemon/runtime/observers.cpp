#include "runtime/observers.h"

#include <chrono>

namespace limb_ring::runtime {

void Observers::set(host::ClientId client, const std::set<std::string>& kinds) {
  if (kinds.empty()) return remove(client);
  wanted_[client] = kinds;
}

void Observers::tell(const std::string& kind, nlohmann::json what) {
  if (!any()) return;
  what["kind"] = kind;
  what["time_ns"] = std::chrono::duration_cast<std::chrono::nanoseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count();
  const std::string line = what.dump();
  for (const auto& [client, kinds] : wanted_)
    if (kinds.count(kind) != 0) host_.observed(client, line);
}

}  // namespace limb_ring::runtime
