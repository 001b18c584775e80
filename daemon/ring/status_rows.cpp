#include "ring/status_rows.h"

#include <algorithm>
#include <optional>

#include "io/in_parallel.h"
#include "limb_ring/host_port.h"
#include "limb_ring/ring_directory.h"
#include "ring/connect_node.h"
#include "ring/lock_files.h"

namespace limb_ring::ask {
namespace {

using nlohmann::json;

constexpr std::size_t kAskers = 16;
constexpr int kLately = 1000;  ///< ms; an older beacon tells nothing

int age_of(const json& heard) { return heard.value("age_ms", kLately); }

std::optional<json> row_of(const std::string& ring, std::uint8_t id, std::chrono::milliseconds timeout) {
  const live::Holder holder = live::holder_of(ring_directory(ring), id);
  if (!holder.held || holder.frozen) return std::nullopt;
  try {
    HostPort port = live::connect_node(ring, std::to_string(id));
    json row = json::parse(port.ask(R"({"do": "status"})", timeout), nullptr, /*allow_exceptions=*/false);
    if (row.is_object()) return row;
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

}  // namespace

Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout) {
  std::vector<std::optional<json>> answers(nodes.size());
  process::in_parallel(nodes.size(), kAskers, [&](std::size_t i) { answers[i] = row_of(ring, nodes[i].id, timeout); });
  Rows rows;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (answers[i]) rows.emplace(nodes[i].id, std::move(*answers[i]));
  return rows;
}

Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout) {
  std::vector<Node> nodes;
  for (const live::HeldNode& held : live::held_nodes(ring_directory(ring))) nodes.push_back({held.node, ""});
  return status_rows(ring, nodes, timeout);
}

json lately_heard_in(const json& row, std::uint8_t node) {
  for (const json& heard : row.value("heard", json::array()))
    if (heard.value("id", -1) == node && age_of(heard) < kLately) return heard;
  return nullptr;
}

json lately_heard(const Rows& rows, std::uint8_t node) {
  json newest;
  for (const auto& [id, row] : rows) {
    json heard = lately_heard_in(row, node);
    if (heard.is_null()) continue;
    if (newest.is_null() || age_of(heard) < age_of(newest)) newest = std::move(heard);
  }
  return newest;
}

std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target) {
  const auto row = rows.find(target);
  if (row == rows.end()) return std::nullopt;
  // The newest beacon: others may be from before the ring broke.
  std::optional<std::uint8_t> newest;
  int age = kLately;
  for (const auto& [id, unused] : rows) {
    const json heard = id == target ? json() : lately_heard_in(row->second, id);
    if (heard.is_null() || age_of(heard) >= age) continue;
    newest = id;
    age = age_of(heard);
  }
  return newest;
}

std::string name_of(const std::vector<Node>& nodes, std::uint8_t id) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [id](const Node& node) { return node.id == id; });
  return found == nodes.end() ? "node " + std::to_string(id) : found->name;
}

}  // namespace limb_ring::ask
