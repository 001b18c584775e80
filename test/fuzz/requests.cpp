// JSON of clients: requests of any content, and what they want to observe.
#include "node/requests.h"
#include "client/arguments.h"
#include "config/load_ring.h"
#include "fuzz/fuzz.h"
#include "node/observers.h"

using namespace limb_ring;

namespace {

const config::RingConfig& ring() {
  static const config::RingConfig three =
      config::parse_ring("ring: r\nnodes:\n- {name: a, id: 1}\n- {name: b, id: 2}\n- {name: c, id: 9}\n", "three.yaml");
  return three;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const auto request = runtime::object_in(text, "a request is an object");
    fuzz::require(request.is_object(), "a request is an object");
    fuzz::require(!client::json_problem(text), "what is taken is not nested too deep");
    runtime::number_in(request, "count", 1, 1, 100);
    runtime::node_in(ring(), request, "node");
    runtime::nodes_in(ring(), request, "to");
  } catch (const runtime::RequestError& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  try {
    runtime::read_observe_filter(ring(), text);
  } catch (const std::runtime_error& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
