#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/link_counters.h"
#include "io/link_header.h"
#include "wire/slice.h"

namespace limb_ring::link {

/// The reason of an input that was lost because nothing came for `silence`.
constexpr std::string_view kSilent = "silent";
/// That of one whose other end had given this one up, since this process stood still.
constexpr std::string_view kGivenUp = "given up: this process, or its host, stood still";

/// What comes out of an Input. Calls come from the event loop, never from inside a call into the
/// Input. A handler may close() the Input; nothing is called after that.
struct InputHandler {
  virtual ~InputHandler() = default;
  /// In the order sent, each once; never an idle slice. The bytes are valid during the call only.
  virtual void on_slice(const wire::Slice& slice) = 0;
  /// After all slices of one read: now write what they led to.
  virtual void on_batch_end() = 0;
  /// Datagrams are missing here, or one was garbled: a packet that is coming in cannot be finished.
  virtual void on_input_gap() = 0;
  /// An upstream neighbour has connected. Another one's on_input_lost has come before.
  virtual void on_input_up(std::uint8_t from) = 0;
  /// It is gone, or another one takes its place. `reason` is for people.
  virtual void on_input_lost(std::string_view reason) = 0;
  /// A peer has asked to be our upstream neighbour that cannot be; once for each reason until an input comes up.
  /// `reason` is for people.
  virtual void on_unknown_peer(std::string_view reason) = 0;
};

/// A long line: hands everything on to another handler `delay` later, in order. (ours)
/// Holds up to kLimit bytes of slices, framed; slices beyond that are dropped and become one gap.
class DelayedInput : public InputHandler {
 public:
  static constexpr std::size_t kLimit = 4 << 20;

  DelayedInput(boost::asio::io_context& io, nanoseconds delay, InputHandler& next, InputCounters& counters);
  ~DelayedInput() override { close(); }
  /// Drops what is on the line; no calls after this.
  void close();

  void on_slice(const wire::Slice& slice) override;
  void on_batch_end() override;
  void on_input_gap() override;
  void on_input_up(std::uint8_t from) override;
  void on_input_lost(std::string_view reason) override;
  void on_unknown_peer(std::string_view reason) override;

 private:
  struct Event {
    enum class Kind : std::uint8_t { gap, batch_end, other } kind;
    std::size_t size;                            ///< bytes of its slice, framed; 0 if it is none
    std::function<void(InputHandler&)> deliver;  ///< not of a gap
    Time due{};
  };
  struct Line;

  void add(Event event);

  nanoseconds delay_;
  InputCounters& counters_;
  std::shared_ptr<Line> line_;
};

/// The nodes that cannot connect to us at one end of a link: for each the last reason. At most 256.
class Refusals {
 public:
  struct Refusal {
    std::string reason;  ///< for people; "it" is the other node
    Time at{};           ///< when it was said last: a node that is refused asks again many times a second
  };

  void note(std::uint8_t node, std::string reason) { all_[node] = {std::move(reason), Clock::now()}; }
  void forget(std::uint8_t node) { all_.erase(node); }
  const std::map<std::uint8_t, Refusal>& all() const { return all_; }

 private:
  std::map<std::uint8_t, Refusal> all_;
};

/// True for a text that was not reported yet: a node that is turned away comes again many times a second.
class ReportOnce {
 public:
  bool operator()(std::string_view text) { return reported_.size() < kMost && reported_.emplace(text).second; }
  void forget() { reported_.clear(); }

 private:
  static constexpr std::size_t kMost = 16;
  std::set<std::string> reported_;
};

/// Where an Input listens, and whom it may let in.
struct InputSettings {
  Identity self;
  Endpoint endpoint;                ///< where we listen, for nodes of this host
  std::vector<std::uint8_t> order;  ///< ids of all nodes in ring order, ours among them
  Timing timing;
  nanoseconds delay{0};                               ///< slices are handed on so much later
  std::optional<Endpoint> from_hosts = std::nullopt;  ///< where we listen for nodes of other hosts, if elsewhere
  std::vector<std::string> names = {};                ///< of the nodes in `order`, for messages; may be empty
  bool several_hosts = false;                         ///< the ring runs on more than one
};

/// What an Input keeps account of, whatever its transport.
struct InputReport {
  InputCounters counters;
  std::string last_unknown_peer;  ///< why the last unknown peer was turned away; for people
  ReportOnce report_once;         ///< of such a reason, since the input came up
  Refusals refusals;
  void unknown_peer(std::string why) {
    ++counters.unknown_peers;
    last_unknown_peer = std::move(why);
  }
  /// The sender of `connect`, shown to people as `who`, was answered `refuse`: counts it, and tells the handler once,
  /// unless asking again mends it.
  void turned_away(const std::string& who, const LinkHeader& connect, const LinkHeader& refuse, InputHandler& handler);
  /// Node `from` is the upstream neighbour now: what was said of it, and of others before it, is over.
  void came_up(std::uint8_t from);
};

/// One transport's receiving end. No calls of the handler after close().
class InputLine {
 public:
  virtual ~InputLine() = default;
  virtual void close() = 0;
  /// Its socket's file is where it was made; also if it has none.
  virtual bool is_in_place() const { return true; }
  /// Makes its socket's file again, if it has one and that was removed. What is connected stays so.
  /// @throw std::runtime_error
  virtual void listen_again() {}
  /// The upstream neighbour that came in by this line; nothing if there is none, or it came in by another line.
  virtual std::optional<std::uint8_t> from() const = 0;
  /// Tells its upstream neighbour that node `by` takes its place, and loses it. @pre from()
  virtual void replace(std::uint8_t by) = 0;
};

/// Who is the upstream neighbour of an input: one at a time, whichever of its lines it came in by. (ours, protocol.md
/// section 6.8)
class Upstream {
 public:
  std::optional<std::uint8_t> from() const { return line_ == nullptr ? std::nullopt : line_->from(); }
  /// Node `by` comes in: who was there is told, and lost. The handler may close all lines in this call.
  void give_way(std::uint8_t by) {
    if (from()) line_->replace(by);
  }
  /// @param line outlives this
  void comes_by(InputLine& line) { line_ = &line; }

 private:
  InputLine* line_ = nullptr;
};

/// The receiving end of the link INTO a node: listens (for nodes of its own host and of others), has one upstream
/// neighbour at a time, and takes a nearer one, or the same restarted, in its place. Tells the neighbour every `idle`
/// that this end lives. One thread, one io_context. Not to be destroyed from within a call of its handler.
class Input {
 public:
  /// @throw std::runtime_error if it cannot listen: names the endpoint, the cause, the cure
  Input(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler);
  ~Input() { close(); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// Hangs up and stops listening. No call of the handler afterwards.
  void close();

  /// As InputLine's.
  bool is_in_place() const;
  /// As InputLine's. @throw std::runtime_error
  void listen_again() {
    for (const auto& line : lines_) line->listen_again();
  }

  bool up() const { return from().has_value(); }
  std::optional<std::uint8_t> from() const { return upstream_.from(); }
  const InputCounters& counters() const { return report_.counters; }
  /// Nodes that were refused for a reason that asking again does not mend.
  const Refusals& refusals() const { return report_.refusals; }
  /// Why the last unknown peer was turned away; empty if there was none.
  const std::string& last_unknown_peer() const { return report_.last_unknown_peer; }

 private:
  void open(boost::asio::io_context& io, InputSettings settings, const Endpoint& endpoint, InputHandler& handler);

  InputReport report_;
  std::unique_ptr<DelayedInput> delay_;
  Upstream upstream_;
  std::vector<std::shared_ptr<InputLine>> lines_;
};

/// Hands on the slices of a byte stream: all of one read, then the end of the batch. Idle slices
/// end here. A slice that is not all there yet waits for the next read.
class SliceFeed {
 public:
  /// What one read takes at most. Taking all that has come in one read is what keeps a loaded
  /// ring fast.
  static constexpr std::size_t kReadSize = 64 * 1024;

  SliceFeed() : buffer_(kReadSize + wire::kMaxSliceSize) {}

  std::uint8_t* space() { return buffer_.data() + kept_; }
  std::size_t space_size() const { return buffer_.size() - kept_; }

  /// `size` bytes were put into space(). @return false: they are not slices.
  bool commit(std::size_t size, InputHandler& handler, InputCounters& counters);
  /// From within a call of the handler: hand on nothing more.
  void stop() { stopped_ = true; }

 private:
  std::vector<std::uint8_t> buffer_;
  std::size_t kept_ = 0;
  bool stopped_ = false;
};

/// Judges at every tick whether the other end has fallen silent. (ours, protocol.md section 6.10)
/// A late tick counts as two at most: an end that was not scheduled itself knows nothing about the other.
class Silence {
 public:
  explicit Silence(const Timing& timing) : timing_(timing) {}

  void restart(Time now);
  /// Something came. Cheap: called for every read.
  void heard() { heard_ = true; }
  /// Call at every tick. @return true: nothing came for `timing.silence`.
  bool tick(Time now);
  /// This end has had no tick for `timing.silence`: the process stood still, and the other end may have given it up.
  bool stood_still(Time now) const { return now - last_tick_ >= timing_.silence; }
  /// To be called after tick() has said true and one more read: true if that read brought nothing either.
  bool still() const { return !heard_; }

 private:
  Timing timing_;
  Time last_tick_{};
  Clock::duration quiet_{0};
  bool heard_ = true;
};

/// Notices that this host was suspended. CLOCK_MONOTONIC stood meanwhile, and so did what waits on the lines between
/// its nodes; nodes of other hosts have gone on, and to them those packets are old. (ours, protocol.md section 6.10)
class Suspension {
 public:
  /// @param several_hosts else nobody has gone on, and it notices nothing
  /// @param least a shorter one was not noticed by others either
  Suspension(bool several_hosts, nanoseconds least) : asks_(several_hosts), least_(least) {}

  /// True once after each. Cheap: called for every read.
  bool noticed();
  /// The same. @param boot CLOCK_BOOTTIME, read before @param monotonic CLOCK_MONOTONIC
  bool noticed(nanoseconds boot, nanoseconds monotonic);

 private:
  bool asks_;
  nanoseconds least_;
  std::optional<nanoseconds> slept_;  ///< in all, at least: time may pass between the two readings
};

/// Whether a socket is read once more in the same turn of the event loop. Behind a packet that comes alone there is
/// nothing, and the read would be a system call in vain for each packet; if packets pile up, reading them all keeps
/// a loaded ring fast. So reading goes on while it mostly finds something; else every kTryEvery-th turn tries. (ours)
class ReadAgain {
 public:
  static constexpr unsigned kTryEvery = 16;
  static constexpr unsigned kMostCredit = 8;

  bool wanted() { return credit_ > 0 || ++turns_ % kTryEvery == 0; }
  /// After each such read.
  void found(bool something) { credit_ = something ? std::min(credit_ + 1, kMostCredit) : credit_ / 2; }

 private:
  unsigned credit_ = 0;  ///< one more by each read that found something, half by one that did not
  unsigned turns_ = 0;   ///< without credit
};

}  // namespace limb_ring::link
