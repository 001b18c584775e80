#pragma once

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/mark.h>

#include <map>
#include <string>
#include <vector>

namespace limb_ring::config {

/// Watches one YAML document while it is parsed, before anything is built of it, and ends the parsing where the
/// document would be too much: an alias counts as all that it stands for. (ours)
class YamlLimits final : public YAML::EventHandler {
 public:
  static constexpr std::size_t kMostDepth = 64;       ///< lists and maps within each other
  static constexpr std::size_t kMostValues = 300000;  ///< values, lists, maps and keys together

  /// @param name of the file, for errors. Every call below throws ConfigError where a limit is passed.
  explicit YamlLimits(std::string name) : name_(std::move(name)) {}

  /// Where the document begins.
  const YAML::Mark& start() const { return start_; }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, anchor, {}); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string&) override {
    add(mark, anchor, {});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnMapEnd() override { end(); }

 private:
  struct Extent {
    std::size_t values = 1;
    std::size_t depth = 0;  ///< lists and maps within each other, this one too
  };
  /// A list or map whose end is still to come.
  struct Open {
    YAML::Mark mark;
    YAML::anchor_t anchor;
    Extent extent;
  };

  void add(const YAML::Mark& mark, YAML::anchor_t anchor, const Extent& extent);
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor);
  void end();
  void check_depth(const YAML::Mark& mark, std::size_t depth) const;
  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& problem) const;

  std::string name_;
  YAML::Mark start_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Extent> anchored_;
};

}  // namespace limb_ring::config
