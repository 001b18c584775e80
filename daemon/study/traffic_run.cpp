#include "study/traffic_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

#include "config/core_settings.h"
#include "config/quantity.h"
#include "sim/planned_ring.h"

namespace limb_ring::study {
namespace {

using core::Time;

constexpr unsigned kWindow = 4;  // as ring_bridge's TopicSender
constexpr int kTold = 100;       // times that progress is told
constexpr Duration kInstant{1};

struct Message {
  Time asked{};
  std::size_t left = 0;  ///< packets that have not ended
  bool whole = true;     ///< all that have were delivered
};

/// A stream's CPU.
struct Feed {
  std::vector<unsigned> packets;
  std::map<std::size_t, Message> messages;  ///< by number, not ended
  std::size_t next_message = 0;             ///< ... of which the next packet is
  std::size_t next_packet = 0;
  unsigned in_nc = 0;
  Duration next_nominal{0};  ///< of the next message, from the start
};

struct Job {
  std::size_t stream = 0;
  std::size_t message = 0;
};

struct Source {
  std::map<std::uint32_t, Job> jobs;  ///< by token
  Time data_delivered{};              ///< of the one outstanding
  Time interrupt_delivered{};
};

class TrafficRun {
 public:
  TrafficRun(const config::RingConfig& config, const std::vector<Stream>& streams, const TrafficOptions& options)
      : streams_(streams),
        options_(options),
        random_(options.seed),
        ring_(sim::planned_ring(config)),
        feeds_(streams.size()),
        sources_(config.nodes.size()),
        result_(streams.size()) {
    if (!ring_->join()) throw std::runtime_error("the simulated ring did not close within 10 s");
    ring_->run_for(Duration(config.timeouts.beacon) / 2);  // between the beacons at joining and the next ones
    patience_ = config.timeouts.queue + ring_->node(NodeId{0}).settings().worst_lap();
    start_ = ring_->now();
    end_ = start_ + options.duration;
    listen();
  }

  std::vector<StreamRun> run() {
    for (std::size_t s = 0; s < streams_.size(); ++s)
      if (!streams_[s].beacon) begin(s);
    for (int i = 1; i <= kTold; ++i) {
      ring_->run_until(start_ + options_.duration * i / kTold);
      options_.tell(static_cast<double>(i) / kTold);
    }
    ring_->run_until([this] { return all_home(); }, patience_);
    ring_->check();
    return std::move(result_);
  }

 private:
  void listen() {
    ring_->on_packet = [this](NodeId, const core::ReceivedPacket& packet) {
      sources_[packet.source].data_delivered = packet.at;
    };
    ring_->on_event = [this](NodeId at, const core::Event& event) {
      if (const auto* ended = std::get_if<core::SendEnded>(&event.what)) on_end(at, *ended, event.at);
      if (const auto* pulled = std::get_if<core::PinPulled>(&event.what))
        sources_[pulled->source].interrupt_delivered = event.at;
      if (const auto* home = std::get_if<core::BeaconHome>(&event.what)) on_beacon(at, home->round_trip);
    };
  }

  // ---- requests -----------------------------------------------------------------------------

  Duration any_below(Duration limit) {
    return Duration{static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(limit.count()))};
  }

  void begin(std::size_t s) {
    feeds_[s].packets = streams_[s].interrupt ? std::vector<unsigned>{0} : streams_[s].packets;
    feeds_[s].next_nominal = streams_[s].phase ? *streams_[s].phase : any_below(streams_[s].period);
    schedule(s);
  }

  void schedule(std::size_t s) {
    const Time at = start_ + feeds_[s].next_nominal + any_below(streams_[s].jitter + kInstant);
    feeds_[s].next_nominal += streams_[s].period;
    if (at < end_) ring_->at(at, [this, s] { ask(s); });
  }

  void ask(std::size_t s) {
    feeds_[s].messages[result_[s].asked++] = {ring_->now(), feeds_[s].packets.size(), true};
    schedule(s);
    feed(s);
  }

  void feed(std::size_t s) {
    Feed& feed = feeds_[s];
    while (feed.in_nc < kWindow && feed.next_message < result_[s].asked) {
      const std::uint32_t token = send(streams_[s], feed.packets[feed.next_packet]);
      sources_[streams_[s].source].jobs[token] = {s, feed.next_message};
      ++feed.in_nc;
      if (++feed.next_packet < feed.packets.size()) continue;
      feed.next_packet = 0;
      ++feed.next_message;
    }
  }

  std::uint32_t send(const Stream& stream, unsigned bytes) {
    if (stream.interrupt) return ring_->interrupt(stream.source, stream.destination, *stream.interrupt);
    return ring_->send(stream.source, stream.destination, std::vector<std::uint8_t>(bytes), stream.priority);
  }

  // ---- ends ---------------------------------------------------------------------------------

  void on_beacon(NodeId node, Duration round_trip) {
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      if (!streams_[s].beacon || streams_[s].source != node || ring_->now() >= end_) continue;
      ++result_[s].asked;
      ++result_[s].outcomes[static_cast<std::size_t>(core::Outcome::delivered)];
      result_[s].confirmed.add(round_trip);
    }
  }

  // A destination may take the packet in the very instant in which it is home, so this is evaluated an instant later.
  void on_end(NodeId node, const core::SendEnded& ended, Time home) {
    ring_->at(ring_->now() + kInstant, [this, node, ended, home] { finish(node, ended, home); });
  }

  void finish(NodeId node, const core::SendEnded& ended, Time home) {
    Source& source = sources_[node];
    const Job job = source.jobs.at(ended.token);
    source.jobs.erase(ended.token);
    Message& message = feeds_[job.stream].messages.at(job.message);
    ++result_[job.stream].outcomes[static_cast<std::size_t>(ended.outcome)];
    message.whole = message.whole && ended.outcome == core::Outcome::delivered;
    if (--message.left == 0) {
      if (message.whole)
        count(job.stream, message.asked, ended.interrupt ? source.interrupt_delivered : source.data_delivered, home);
      feeds_[job.stream].messages.erase(job.message);
    }
    --feeds_[job.stream].in_nc;
    feed(job.stream);
  }

  void count(std::size_t s, Time asked, Time there, Time home) {
    result_[s].delivered.add(there - asked);
    result_[s].confirmed.add(home - asked);
  }

  bool all_home() const {
    for (const Feed& feed : feeds_)
      if (!feed.messages.empty()) return false;
    return true;
  }

  const std::vector<Stream>& streams_;
  const TrafficOptions& options_;
  std::mt19937_64 random_;
  std::unique_ptr<sim::WatchedRing> ring_;
  Time start_{}, end_{};
  Duration patience_{0};  ///< for what is under way at the end: what has a bound is home by then
  std::vector<Feed> feeds_;
  std::vector<Source> sources_;
  std::vector<StreamRun> result_;
};

}  // namespace

std::size_t StreamRun::failed() const {
  const std::size_t all = std::accumulate(outcomes.begin(), outcomes.end(), std::size_t{0});
  return all - outcomes[static_cast<std::size_t>(core::Outcome::delivered)];
}

std::vector<StreamRun> run_traffic(const config::RingConfig& ring, const std::vector<Stream>& streams,
                                   const TrafficOptions& options) {
  return TrafficRun(ring, streams, options).run();
}

bool kept(const StreamPlan& plan, const StreamRun& run) {
  if (!plan.confirmed) return true;
  const bool all = run.failed() == 0 && run.confirmed.count() == run.asked;
  return all && run.delivered.max() <= *plan.delivered && run.confirmed.max() <= *plan.confirmed;
}

namespace {

using config::NodeConfig;
using config::RingConfig;

constexpr double kDay = 24 * 3600.0, kHour = 3600.0;

std::string number_text(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

std::string percent_text(double share) { return number_text(100 * share, " %"); }

/// For a share just below 1, how much is missing says more than the share.
std::string all_but(double share) {
  if (share == 1) return "always";
  const double missing = 1 - share;
  return "all but " + (missing < 1e-3 ? number_text(1e6 * missing, " in a million") : percent_text(missing));
}

std::string often(double seconds) {
  if (seconds < 120) return number_text(seconds, " s");
  if (seconds < 2 * kHour) return number_text(seconds / 60, " min");
  return seconds < 2 * kDay ? number_text(seconds / kHour, " h") : number_text(seconds / kDay, " days");
}

std::chrono::nanoseconds whole_way(const NodeConfig& node) { return node.link.whole_delay(); }

void add_silence(const RingConfig& ring, const NodeConfig& node, std::vector<std::string>& sentences) {
  const double seconds = seconds_to_false_silence(ring.timeouts, node.link.expected.loss);
  if (seconds >= kDay) return;
  const auto advised = advised_silence(ring.timeouts, node.link.expected.loss);
  sentences.push_back("the line into " + node.name + " loses " + percent_text(node.link.expected.loss) +
                      " and would be taken for broken every " + often(seconds) + ": timeouts.silence " +
                      config::format_time(ring.timeouts.silence) + " is too short, " + config::format_time(advised) +
                      " holds for a day");
}

/// A bypass has to be made, over a line that takes its time, before a lost input is called a broken line.
void add_break_grace(const RingConfig& ring, std::vector<std::string>& sentences) {
  std::chrono::nanoseconds longest{0};
  for (const NodeConfig& node : ring.nodes) longest = std::max(longest, whole_way(node));
  const auto least = 2 * longest + 3 * ring.timeouts.idle;
  if (longest.count() == 0 || ring.timeouts.break_grace >= least) return;
  sentences.push_back("a bypass takes up to " + config::format_time(least) + " on these lines: timeouts.break_grace " +
                      config::format_time(ring.timeouts.break_grace) + " is too short");
}

}  // namespace

std::optional<ExpectedLosses> expected_losses(const RingConfig& ring) {
  ExpectedLosses losses;
  for (const NodeConfig& node : ring.nodes) losses.home *= 1 - node.link.expected.loss;
  if (losses.home == 1) return std::nullopt;
  losses.delivered = 1 - std::pow(1 - losses.home, wire::kTries);
  losses.tries = losses.delivered / losses.home;
  losses.timeout = setup::core_settings(ring, ring.nodes[0], 1).send_timeout();
  return losses;
}

double seconds_to_false_silence(const config::Timeouts& timeouts, double loss) {
  if (loss <= 0) return std::numeric_limits<double>::infinity();
  const double signs =
      std::floor(static_cast<double>(timeouts.silence.count()) / static_cast<double>(timeouts.idle.count()));
  const double tick = std::chrono::duration<double>(timeouts.idle).count();
  return tick / ((1 - loss) * std::pow(loss, signs));
}

config::milliseconds advised_silence(const config::Timeouts& timeouts, double loss) {
  config::Timeouts longer = timeouts;
  longer.silence = 2 * timeouts.idle;
  while (seconds_to_false_silence(longer, loss) < kDay) longer.silence += timeouts.idle;
  return longer.silence;
}

std::vector<std::string> short_timeouts(const RingConfig& ring) {
  std::vector<std::string> sentences;
  for (const NodeConfig& node : ring.nodes) add_silence(ring, node, sentences);
  add_break_grace(ring, sentences);
  return sentences;
}

std::string expected_words(const RingConfig& ring) {
  std::string lines;
  for (const NodeConfig& node : ring.nodes) {
    const config::ExpectedConfig& expected = node.link.expected;
    if (expected.delay.count() == 0 && expected.loss == 0) continue;
    lines += (lines.empty() ? "" : "; ") + std::string("into ") + node.name + " " +
             config::format_time(expected.delay) + " one way, " + percent_text(expected.loss) + " lost";
  }
  if (lines.empty()) return {};
  std::string text = "Expected of the network: " + lines + ". Bounds hold for packets that are not lost.\n";
  if (const auto losses = expected_losses(ring))
    text += "A packet comes home at its first try with " + percent_text(losses->home) + ", within four tries " +
            all_but(losses->delivered) + "; " + number_text(losses->tries, "") +
            " tries on average, each further one " +
            config::format_time(std::chrono::ceil<std::chrono::microseconds>(losses->timeout)) + " later.\n";
  return text;
}

}  // namespace limb_ring::study
