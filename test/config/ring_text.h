#pragma once

#include <gmock/gmock.h>

#include <string>

#include "config/load_ring.h"

namespace limb_ring::config {

inline RingConfig read(const std::string& text) { return parse_ring(text, "ring.yaml"); }

/// The YAML of a ring of two nodes, to which a test adds what it is about. Its own five lines
/// come first, so the first added line is line 6.
inline std::string two_nodes(const std::string& more = "") {
  return "ring: pair\n"
         "nodes:\n"
         "  - {id: 0, name: body}\n"
         "  - {id: 1, name: knee}\n"
         "\n" +
         more;
}

/// The same with `more` inside node 0, whose entries begin in line 5.
inline std::string node_with(const std::string& more) {
  return "ring: pair\n"
         "nodes:\n"
         "  - {id: 1, name: knee}\n"
         "  - id: 0\n" +
         more;
}

/// What parse_ring says of a file that it refuses; empty if it takes it.
inline std::string refusal_of(const std::string& text) {
  try {
    parse_ring(text, "ring.yaml");
    return {};
  } catch (const ConfigError& error) {
    return error.what();
  }
}

}  // namespace limb_ring::config
