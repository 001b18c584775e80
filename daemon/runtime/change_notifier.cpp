#include "runtime/change_notifier.h"

#include <utility>

namespace limb_ring::runtime {

void ChangeNotifier::look(const Engine& engine, Observers& observers) {
  const unsigned ring_size = engine.controller().membership().ring_size();
  if (std::exchange(ring_size_, ring_size) != ring_size) observers.tell("ring", {{"ring_size", ring_size}});
  const auto crc_errors = engine.controller().counters().crc_errors;
  const auto line_corrupted = engine.line(core::Line::first).faulty_line().counters().line_corrupted;
  const bool came = std::exchange(crc_errors_, crc_errors) != crc_errors;
  const bool went = std::exchange(line_corrupted_, line_corrupted) != line_corrupted;
  if (came || went) observers.tell("noise", {{"crc_errors", crc_errors}, {"line_corrupted", line_corrupted}});
}

}  // namespace limb_ring::runtime
