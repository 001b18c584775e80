#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bench/report.h"

namespace limb_ring::bench {

/// {"nodes","payload","failed","one_sender","all_sending","reference","udp",...}: `one_sender` and
/// `all_sending` are the ring over UNIX stream sockets on one core. Times in microseconds.
nlohmann::json to_json(const Report& report);

/// The same side by side, for people.
std::string to_text(const Report& report);

}  // namespace limb_ring::bench
