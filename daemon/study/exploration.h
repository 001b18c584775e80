#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/archive.h"
#include "sim/invariants.h"
#include "sim/virtual_line_faults.h"
#include "wire/packet.h"

namespace limb_ring::study {

/// The states in which runs were. Several threads may ask. (ours)
class KnownStates {
 public:
  /// Notes that a run is in that state. @param left how many faults may still strike from there on
  /// @return true if another run was in it with at least as many left, so that its continuations cover this run's
  bool meet(std::uint64_t state, std::uint64_t run, unsigned left) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto [place, is_new] = states_.try_emplace(state, Visit{run, left});
    Visit& visit = place->second;
    if (is_new || visit.run == run) return false;
    if (visit.left >= left) return true;
    visit = {run, left};
    return false;
  }
  /// Different ones.
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return states_.size();
  }

 private:
  struct Visit {
    std::uint64_t run;
    unsigned left;
  };
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, Visit> states_;
};

/// What goes wrong in an explored run, just as a slice leaves a node.
struct Strike {
  enum class Kind : std::uint8_t {
    lost,            ///< that slice
    header_damaged,  ///< a bit of its first byte
    data_damaged,    ///< of the one in its middle
    end_damaged,     ///< of its last one: the CRC's, if it ends a packet
    doubled,         ///< its packet
    late,            ///< its line holds it back, and what follows it
    restart,         ///< of a node
    freeze,          ///< of a node, for 3 ms
    cut,             ///< of the line out of a node (of the cable, if the ring folds back), for 3 ms
    interrupt        ///< no fault: a node sends an INTP to the next one
  } kind = Kind::lost;
  wire::NodeId node{0};  ///< of the last four

  bool is_of_node() const { return kind >= Kind::restart; }
};
const char* to_string(Strike::Kind kind);

/// One of them, and at which place of the run: that of the first slice that leaves any node after all have joined is 0.
struct Choice {
  unsigned place = 0;
  Strike strike;
};

/// As `12:lost,20:restart:1`; empty for none.
std::string to_text(const std::vector<Choice>& choices);
/// The same back. @throw std::invalid_argument naming the part that is wrong, and what would be right
std::vector<Choice> choices_from(const std::string& text);

/// What is explored: a small ring with a few sends.
struct World {
  unsigned nodes = 3;  ///< 2 to 6; 3 at least if it folds back
  unsigned sends = 2;  ///< asked for at once, by one node after another: DATPs to the node before, and broadcasts
  bool paced = true;   ///< lines of 1 Gbit/s, so that packets leave in slices; else whole, at once
  bool fold_back = false;
  /// The line out of the last node is cut before the sends and mended at the end, so the ring is an open chain. With
  /// fold_back the whole cable there is cut, so the ring is folded.
  bool broken = false;

  static constexpr unsigned kMostNodes = 6;
  wire::NodeId last_node() const { return static_cast<wire::NodeId>(nodes - 1); }
};

/// One run of a world with given strikes; it is the same each time. The window for strikes opens when all nodes have
/// joined, and closes when every send has ended and the ring is as it was at the beginning. Then all is mended, and
/// the ring has to be whole and fall silent.
class ExploredRun {
 public:
  ExploredRun(const World& world, std::vector<Choice> choices);

  /// Lets the run end when it reaches a state of another run. This is checked once all has struck: when the window has
  /// closed, and if `left` is not 0 also before. @param states must outlive it
  /// @param left how many more may strike in runs that begin like this one
  void recognise(KnownStates& states, std::uint64_t run, unsigned left) {
    states_ = &states;
    run_ = run;
    left_ = left;
  }
  /// It ended in a state of another run.
  bool recognised() const { return recognised_; }

  /// Runs it all, or until a promise is broken.
  void run();
  /// The ring, for further observers before it runs.
  sim::VirtualRing& ring() { return *ring_; }
  const std::optional<sim::Violation>& violation() const { return violation_; }
  /// The number of places at which something could have struck.
  unsigned places() const { return places_; }

 private:
  /// What a freeze or a cut ends with.
  struct Mending {
    core::Time at;
    Strike::Kind of;
    wire::NodeId node;

    template <class Archive>
    void archive(Archive& a) {
      a("at", at)("of", of)("node", node);
    }
  };

  void make_ring();
  void break_ring();
  bool meets_known_state();
  std::uint64_t state_hash();
  bool is_over();
  bool is_settled() const;
  void settle_later();
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void strike(const Strike& what, wire::NodeId id, core::Line line, const wire::Slice& slice,
              wire::SliceWriter& arriving);
  void damage(std::size_t at, wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void begin_line_fault(fault::Name name, wire::NodeId id, core::Line line);
  void strike_node(const Strike& what);
  void restart(wire::NodeId node);
  void freeze(wire::NodeId node);
  void cut(wire::NodeId node);
  void heal(wire::NodeId node);
  void mend_later(Strike::Kind of, wire::NodeId node);
  void mend();
  void ask(unsigned nth);
  void note_violation() { violation_ = invariants_->violation(); }

  World world_;
  std::vector<Choice> choices_;
  std::size_t struck_ = 0;    ///< of choices_
  bool strikes_now_ = false;  ///< the last strike is of a node, and comes once the slice is on its way
  unsigned places_ = 0;
  std::array<unsigned, World::kMostNodes> waiting_{};  ///< sends of each node that have not ended
  std::deque<Mending> mendings_;                       ///< that are still to come
  core::Time settled_by_ = core::kNever;               ///< all know how the ring is, or wait for its mending
  bool open_ = false;                                  ///< something may strike
  bool quiet_ = false;
  std::uint64_t slices_when_quiet_ = 0;
  std::unique_ptr<sim::VirtualRing> ring_;
  std::unique_ptr<sim::VirtualLineFaults> lines_;
  std::unique_ptr<sim::Invariants> invariants_;
  std::optional<sim::Violation> violation_;
  KnownStates* states_ = nullptr;
  std::uint64_t run_ = 0;
  unsigned left_ = 0;
  unsigned compared_at_ = 0;  ///< so many places had passed then
  bool recognised_ = false;
};

/// A 64-bit hash of anything that has an archive() (core/archive.h), such as a whole virtual ring with all that judges
/// it. Mere counters are left out: two states go on in the same way, however many packets were lost on the way to
/// them.
class StateHash : public core::Archive<StateHash> {
 public:
  /// @param nodes of the ring: of tables with an entry for every id only those of its nodes are looked at
  StateHash(unsigned nodes, core::Time now) : nodes_(nodes), now_(now) {}
  std::uint64_t value() const { return value_; }

 private:
  friend class core::Archive<StateHash>;
  static constexpr std::size_t kIds = 256;

  void enter(const char* name) { skipped_ += skipped_ != 0 || std::strcmp(name, "counters") == 0 ? 1u : 0u; }
  void element(std::size_t) { skipped_ += skipped_ != 0 ? 1u : 0u; }
  void leave() { skipped_ -= skipped_ != 0 ? 1u : 0u; }
  template <class T>
  std::size_t elements(std::size_t count) const {
    return count == kIds && sizeof(T) > 1 ? nodes_ : count;
  }
  template <class T>
  void plain(const T& what) {
    static_assert(sizeof what <= sizeof(std::uint64_t) || sizeof what == 2 * sizeof(std::uint64_t));
    if constexpr (sizeof what > sizeof(std::uint64_t)) mix(static_cast<std::uint64_t>(what >> 64));
    mix(static_cast<std::uint64_t>(what));
  }
  void bytes(const std::uint8_t* from, std::size_t size) {
    for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), from += sizeof(std::uint64_t)) {
      std::uint64_t word;
      std::memcpy(&word, from, sizeof word);
      mix(word);
    }
    for (; size > 0; --size) mix(*from++);
  }
  void bytes(const char* from, std::size_t size) { bytes(reinterpret_cast<const std::uint8_t*>(from), size); }
  void view(const wire::ByteView& what) {
    mix(what.size);
    bytes(what.data, what.size);
  }
  std::size_t count(std::size_t size) {
    mix(size);
    return size;
  }
  void instant(const core::Time& time) { plain((time - now_).count()); }
  void mix(std::uint64_t word) {
    if (skipped_ != 0) return;
    value_ = (value_ ^ word) * 0x9E3779B97F4A7C15u;
    value_ ^= value_ >> 32;
  }

  std::size_t nodes_;
  core::Time now_;
  unsigned skipped_ = 0;  ///< so deep in what is left out
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

/// Every run of a small world with at most Bounds::faults strikes, each of them at every place where it can fall. A run
/// with k strikes is run again with a further strike at every place after its last one. A run that reaches a state of
/// an earlier run ends there: the earlier run, and those that begin like it, cover all that could follow. (ours)
class Exploration {
 public:
  struct Bounds {
    unsigned faults = 1;
    unsigned places = kAllPlaces;  ///< nothing strikes later than that in a run
    bool recognise = true;         ///< states that were met before
    unsigned threads = 1;          ///< with more of them another broken promise may be found first
  };
  static constexpr unsigned kAllPlaces = 1'000'000;

  Exploration(const World& world, const Bounds& bounds) : world_(world), bounds_(bounds) {}

  /// Runs them all, or until a promise is broken or stop() is called.
  /// @param progress called after every run, by one thread at a time
  void run(const std::function<void()>& progress);
  /// Begins no further run. May be called by `progress`.
  void stop() { stop_ = true; }
  std::uint64_t runs() const { return runs_; }
  /// Runs that ended in a state that had been met before.
  std::uint64_t recognised() const { return recognised_; }
  /// The number of different states that were seen.
  std::size_t states() const { return states_.count(); }
  /// The largest number of places in one run.
  unsigned places() const { return places_; }
  /// The first run that broke a promise.
  struct Found {
    std::vector<Choice> choices;
    sim::Violation violation;
  };
  const std::optional<Found>& found() const { return found_; }

 private:
  using Progress = std::function<void()>;

  unsigned run_once(const std::vector<Choice>& choices, const Progress& progress);
  void extend(std::vector<Choice>& choices, const Progress& progress);
  std::vector<Choice> next(const std::vector<Choice>& choices, unsigned places) const;
  std::vector<Strike> strikes() const;

  World world_;
  Bounds bounds_;
  KnownStates states_;
  std::atomic<std::uint64_t> begun_{0};  ///< runs
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  ///< over what follows
  std::uint64_t runs_ = 0, recognised_ = 0;
  unsigned places_ = 0;
  std::optional<Found> found_;
};

}  // namespace limb_ring::study
