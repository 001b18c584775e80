#pragma once

#include <string>
#include <vector>

#include "io/input.h"
#include "io/output.h"

namespace limb_ring::link {

/// Writes down what an Input and an Output say, in order.
struct RecordingInput : InputHandler {
  void on_slice(const wire::Slice& slice) override {
    slices.emplace_back(slice.bytes.begin(), slice.bytes.end());
    kinds.push_back(slice.kind);
    log.push_back("slice");
  }
  void on_batch_end() override {
    ++batches;
    log.push_back("batch end");
  }
  void on_input_gap() override { log.push_back("gap"); }
  void on_input_up(std::uint8_t from) override { log.push_back("up " + std::to_string(from)); }
  void on_input_lost(std::string_view reason) override { log.push_back("lost: " + std::string(reason)); }
  void on_unknown_peer(std::string_view reason) override { unknown_peers.emplace_back(reason); }

  std::vector<std::vector<std::uint8_t>> slices;
  std::vector<wire::SliceKind> kinds;
  std::vector<std::string> log;
  std::vector<std::string> unknown_peers;
  int batches = 0;
};

struct RecordingOutput : OutputHandler {
  void on_output_up(std::uint8_t to) override { log.push_back("up " + std::to_string(to)); }
  void on_output_lost(std::string_view reason) override { log.push_back("lost: " + std::string(reason)); }
  void on_output_refused(std::uint8_t by, std::string_view reason) override {
    refusals.push_back(std::to_string(by) + ": " + std::string(reason));
  }
  void on_output_ready() override { ++ready; }

  std::vector<std::string> log;
  std::vector<std::string> refusals;
  int ready = 0;
};

}  // namespace limb_ring::link
