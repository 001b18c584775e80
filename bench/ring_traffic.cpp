#include "bench/ring_traffic.h"

#include <chrono>
#include <stdexcept>

#include "bench/waits.h"

namespace limb_ring::bench {
namespace {

using std::chrono::steady_clock;

nlohmann::json request_of(const Setup& setup, const config::RingConfig& ring, std::size_t sender) {
  const std::size_t across = (sender + ring.nodes.size() / 2) % ring.nodes.size();
  return {{"do", "ping"},
          {"to", ring.nodes[across].id},
          {"size", setup.payload},
          {"duration_ms", static_cast<std::int64_t>(setup.round_seconds() * 1000) + 1}};
}

nlohmann::json reply_to(std::uint32_t token, HostPort& port, const Setup& setup, steady_clock::time_point deadline) {
  while (steady_clock::now() < deadline) {
    setup.poll();
    const auto message = port.receive(kSlice);
    if (!message) continue;
    if (const auto* reply = std::get_if<Reply>(&*message))
      if (reply->token == token) return nlohmann::json::parse(reply->json);
    if (const auto* gone = std::get_if<Disconnected>(&*message))
      throw std::runtime_error("a ringd has left during the benchmark: " + gone->reason);
  }
  throw std::runtime_error("a ringd did not say in time how its packets fared");
}

Measurement measurement_of(const nlohmann::json& report) {
  if (report.contains("error")) throw std::runtime_error(report.at("error").get<std::string>());
  Measurement measured;
  measured.packets = report.at("delivered").get<std::uint64_t>();
  measured.failed = report.at("sent").get<std::uint64_t>() - measured.packets;
  if (measured.packets == 0) throw std::runtime_error("no packet came back: " + report.dump());
  const auto& times = report.at("round_trip_us");
  measured.round_trip_us = {times.at("p50"), times.at("p99"), times.at("max")};
  measured.packets_per_second = report.at("packets_per_second");
  return measured;
}

}  // namespace

Measurement measure_traffic(const Setup& setup, const PrivateRing& ring, Sending sending) {
  const std::size_t senders = sending == Sending::one ? 1 : ring.config().nodes.size();
  std::vector<HostPort> ports;
  for (std::size_t i = 0; i < senders; ++i) ports.push_back(ring.connect(i));
  std::vector<std::uint32_t> tokens;
  for (std::size_t i = 0; i < senders; ++i)
    tokens.push_back(ports[i].request(request_of(setup, ring.config(), i).dump()));
  const auto deadline = steady_clock::now() + kPatience + setup.case_time();
  std::vector<Measurement> measured;
  for (std::size_t i = 0; i < senders; ++i)
    measured.push_back(measurement_of(reply_to(tokens[i], ports[i], setup, deadline)));
  return together(measured);
}

}  // namespace limb_ring::bench
