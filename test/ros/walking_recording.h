#pragma once

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace limb_ring::bridge {

/// Joint data of a recorded walk: CSV with a column `stamp_unix_s` (s, six decimals) and
/// `pos.JOINT` (rad) and `vel.JOINT` (rad/s) for every joint.
class WalkingRecording {
 public:
  explicit WalkingRecording(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read");
    std::string line;
    std::getline(file, line);
    read_header(line);
    while (std::getline(file, line)) rows_.push_back(read_row(line));
  }

  std::size_t size() const { return rows_.size(); }
  std::int64_t stamp_ns(std::size_t row) const { return std::llround(at(row, "stamp_unix_s") * 1e6) * 1000; }
  double position(std::size_t row, const std::string& joint) const { return at(row, "pos." + joint); }
  double velocity(std::size_t row, const std::string& joint) const { return at(row, "vel." + joint); }

 private:
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
    return result;
  }
  void read_header(const std::string& line) {
    for (const auto& name : cells(line)) columns_.emplace(name, columns_.size());
  }
  std::vector<double> read_row(const std::string& line) const {
    std::vector<double> row;
    for (const auto& cell : cells(line)) row.push_back(std::stod(cell));
    if (row.size() != columns_.size()) throw std::runtime_error("a row of another length: " + line);
    return row;
  }
  double at(std::size_t row, const std::string& column) const { return rows_.at(row).at(columns_.at(column)); }

  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace limb_ring::bridge
