#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/journal.h"
#include "core/settings.h"
#include "io/regular_file.h"
#include "judge/promise.h"
#include "wire/packet_assembler.h"

namespace limb_ring::promises {

struct ObservationRing;  ///< how it lies in the file

/// Where a node's observations are written: a mapped file of bounded size, for any number of readers. A reader that is
/// too slow loses some, and knows how many. The node never waits, and what it has written survives a kill. (ours)
class ObservationFile final : public ObservationSink {
 public:
  /// One that is there is replaced. @throw std::system_error
  explicit ObservationFile(std::string path);
  ~ObservationFile() override;  ///< the file goes with it

  void put(const Observation& seen) override;
  const std::string& path() const { return path_; }
  /// False if it was removed from its folder, which who has it open does not see, or cut off.
  bool is_there() const;
  /// Makes it anew with all that it holds. Who has the old one open sees nothing more, and has to follow().
  /// @throw std::system_error
  void make_again();
  /// Written so far.
  std::uint64_t count() const { return count_; }

 private:
  std::string path_;
  process::MappedFile file_;
  ObservationRing* ring_;
  std::uint64_t count_ = 0;
};

/// The other side of it.
class ObservationReader {
 public:
  /// @param from count() at which it begins
  /// @throw std::runtime_error if it is no such file
  ObservationReader(const std::string& path, std::uint64_t from);

  /// All that has come since, into `seen`, which is emptied before. @return so many were lost before these
  std::uint64_t read(std::vector<Observation>& seen);

  /// Goes on where it is in a file that was made again; at `from`, and what is before it is lost, if the old one was
  /// cut off. @param from count() when it was made again @throw std::runtime_error if it is no such file
  void follow(const std::string& path, std::uint64_t from);

 private:
  process::MappedFile file_;
  ObservationRing* ring_;
  std::uint64_t next_;
  std::uint64_t lost_ = 0;  ///< since the last read()
};

/// Makes observations of what goes into a node's network controller and comes out of it: a living one's, or what a
/// flight recorder has written down of one. (ours)
class NodeObserver final : public core::Journal {
 public:
  /// @param settings,sink must outlive this
  /// @param zero the machine's time at 0 of the controller's
  /// @param waiting returns the number of packets in the receive buffers
  /// @param goes_on how often it reports that the node goes on, and whether the receive buffers are empty
  NodeObserver(const core::Settings& settings, std::chrono::nanoseconds zero, std::function<std::size_t()> waiting,
               ObservationSink& sink, core::Duration goes_on = std::chrono::milliseconds(50));

  void goes_in(const core::Input& input, core::Time now) override;
  void goes_out(core::Line, wire::ByteView) override {}
  void taken(const core::Event& event, core::Time now) override;
  void taken(const core::ReceivedPacket& packet, core::Time now) override;

 private:
  Observation at(Observation::Kind kind, core::Time now) const;
  void say_it_goes_on(core::Time now);
  void see(const core::input::Receive& call, core::Time now);
  void see(const core::input::Send& call, core::Time now);
  void see(const core::input::Interrupt& call, core::Time now);
  void see(const core::input::Pull& call, core::Time now);
  void see(const core::input::CpuReset& call, core::Time now);
  void see(const core::input::InputGap& call, core::Time now);
  void see(const core::input::InputLost& call, core::Time now);
  template <class Other>
  void see(const Other&, core::Time) {}
  void asks_for_interrupt(const core::InterruptRequest& request, core::Time now);
  void came(wire::ByteView packet, core::Time now);

  const core::Settings& settings_;
  std::chrono::nanoseconds zero_;
  std::function<std::size_t()> waiting_;
  ObservationSink& sink_;
  core::Duration goes_on_;
  core::Time next_{};     ///< when it says again that it goes on
  core::Time came_at_{};  ///< of what is put together
  capture::PacketAssembler cut_through_;
};

/// How long a send may take at most, from its request to its result. (protocol.md sections 4.3 to 4.6)
std::chrono::nanoseconds longest_send(const core::Settings& settings);

}  // namespace limb_ring::promises
