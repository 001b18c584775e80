#include "study/comparison/comparison.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "study/baselines/arcnet.h"
#include "study/baselines/can_bus.h"
#include "study/baselines/ethercat.h"
#include "study/baselines/responsive_link.h"
#include "study/baselines/sercos.h"
#include "study/comparison/ring_network.h"

namespace limb_ring::study {

namespace {

constexpr std::uint64_t kMega = 1'000'000;
constexpr std::uint64_t kMostMessages = 4'000'000;  // some 650 MB

struct Method {
  std::string name;
  std::uint64_t own_rate;  ///< of the paper's Table I, bit/s
  std::unique_ptr<Network> network;
};

std::vector<Method> methods(std::function<void()> goes_on = [] {}) {
  std::vector<Method> all;
  all.push_back({"limb_ring", 1000 * kMega, std::make_unique<RingNetwork>(std::move(goes_on))});
  all.push_back({"ARCNET", 5 * kMega, std::make_unique<Arcnet>()});
  all.push_back({"EtherCAT", 100 * kMega, std::make_unique<EtherCat>()});
  all.push_back({"SERCOS II", 16 * kMega, std::make_unique<Sercos>()});
  all.push_back({"Responsive Link", 500 * kMega, std::make_unique<ResponsiveLink>()});
  all.push_back({"CAN / MLVDS", 100 * kMega, std::make_unique<CanBus>()});
  return all;
}

/// Tells whenever it is given something to carry.
class TellingNetwork final : public Network {
 public:
  TellingNetwork(const Network& network, std::function<void()> tell) : network_(network), tell_(std::move(tell)) {}

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override {
    tell_();
    return network_.carry(medium, messages, until);
  }
  Duration time_to_join(const Medium& medium) const override {
    tell_();
    return network_.time_to_join(medium);
  }

 private:
  const Network& network_;
  std::function<void()> tell_;
};

void add(const ComparisonOptions& options, const Subject& subject, const Network& quiet, Comparison& out) {
  const TellingNetwork network(quiet, [&] { options.tell(subject); });
  Medium medium = options.medium;
  medium.rate = subject.rate;
  out.methods.push_back({subject, measure(network, medium, options.seed)});
  for (const double load : options.loads)
    out.against_load.push_back({subject, load, measure_efficiency(network, medium, load, options.seed)});
  for (const unsigned nodes : options.nodes) {
    medium.nodes = nodes;
    const Spread at_once = measure_at_once(network, medium, Destination::opposite, options.seed);
    out.against_nodes.push_back({subject, nodes, at_once});
  }
}

}  // namespace

bool comparable(const Medium& medium) {
  Medium fastest = medium;
  for (const Method& method : methods()) fastest.rate = std::max(fastest.rate, method.own_rate);
  return full_load(fastest) <= kMostMessages;
}

Comparison compare(const ComparisonOptions& options) {
  Comparison out;
  Subject now;
  const std::vector<Method> all = methods([&] { options.tell(now); });
  const auto go_through = [&](const Method& method, bool own_rate, std::uint64_t rate) {
    now = {method.name, own_rate, rate};
    add(options, now, *method.network, out);
  };
  for (const Method& method : all) go_through(method, false, options.medium.rate);
  for (const Method& method : all) go_through(method, true, method.own_rate);
  return out;
}

}  // namespace limb_ring::study
