#pragma once

#include <cstddef>

#include "core/time.h"

namespace limb_ring::core {

/// A row of a state machine's table: in which states an input is heeded, what is done before the state changes, the
/// next state, and what is done then. Rows are looked up from the top; an input that no row heeds changes nothing.
template <class Machine, class Input, class Next>
struct Transition {
  using Action = void (Machine::*)(Time now);
  Input input;
  unsigned from;  ///< a set of states, in() each
  Next to;
  Action first;  ///< or null
  Action then;   ///< or null
};

/// A state as a member of a set.
template <class State>
constexpr unsigned in(State state) {
  return 1u << static_cast<unsigned>(state);
}

/// The row for an input in a state; null if it is not heeded.
template <class Row, std::size_t kRows, class Input, class State>
const Row* find_row(const Row (&table)[kRows], Input input, State state) {
  for (const Row& row : table)
    if (row.input == input && (row.from & in(state)) != 0) return &row;
  return nullptr;
}

}  // namespace limb_ring::core
