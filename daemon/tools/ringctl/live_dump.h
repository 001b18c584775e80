#pragma once

#include <chrono>
#include <iosfwd>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/common/packet_text.h"
#include "tools/ringctl/ring_access.h"
#include "wire/packet_assembler.h"
#include "wire/packet_filter.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {

/// Where `dump` puts what it sees.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  virtual void packet(const CapturedPacket& packet) = 0;
  virtual void event(const capture::CapturedEvent& event) = 0;
  /// Writes what is buffered, since somebody may be reading it now.
  /// @return false if nothing can be written any more (a closed pipe, a full disk)
  virtual bool flush() = 0;
  /// Why a flush() was false: names the file. Empty if nobody reads standard output any more (`| head`): that is no
  /// problem.
  const std::string& problem() const { return problem_; }
  bool wanted() const { return wanted_; }

 protected:
  bool flush_to(std::ostream& out, const std::string& path);

 private:
  std::string problem_;
  bool wanted_ = true;
};

/// Lines of text on standard output.
std::unique_ptr<CaptureSink> text_sink(const capture::RingNames& names, const app::PacketTextOptions& options);
/// Lines of JSON on standard output.
std::unique_ptr<CaptureSink> json_sink(const capture::RingNames& names);
/// pcapng in a file, or on standard output if the path is "-". @throw UsageError
std::unique_ptr<CaptureSink> file_sink(const capture::RingNames& names, const std::string& path);

/// Counts of the packets that a dump has shown, and of those that it has not.
struct DumpTotals {
  std::uint64_t shown = 0;
  std::uint64_t beyond = 0;  ///< came after the last one that was asked for
  CaptureCounts nodes;       ///< of all nodes together; lost: read too slowly, there or here
  bool all_gone = false;     ///< it ended because no daemon was left
};
std::string summary(const DumpTotals& totals);

/// What an Observed tells, in words: "up -> open_chain, ring of 15", "CPU running, boot 2".
std::string event_words(const nlohmann::json& seen);

/// Packets and events of several nodes at once, in the order in which they come in here.
class LiveDump {
 public:
  /// Daemons that do not answer are told on standard error, and left out.
  /// @param order for observe(). @throw HostPortError if none answers
  LiveDump(const RingAccess& ring, const std::vector<NodeName>& nodes, const nlohmann::json& order, CaptureSink& sink);

  /// Until `count` packets are shown (0: without end), somebody asks it to end, nobody reads, or no daemon is left.
  /// @throw UsageError for an order that is refused
  DumpTotals run(std::uint64_t count);

 private:
  struct Source {
    explicit Source(HostPort connected) : port(std::move(connected)) {}
    HostPort port;
    std::uint64_t received = 0;
    CaptureCounts counts;
    bool gone = false;
    bool ended = false;  ///< it has sent its final counts
  };

  bool all_gone() const;
  bool full() const { return count_ != 0 && totals_.shown >= count_; }
  void drain(Source& source);
  void wait();
  void end();
  void add_up();
  void take(Source& source, const Message& message);
  void on(Source& source, const CapturedPacket& packet);
  void on(Source& source, const CaptureCounts& counts);
  void on(Source& source, const Observed& seen);
  void on(Source& source, const Disconnected& end);
  template <typename Other>
  void on(Source&, const Other&) {}

  std::string ring_;
  CaptureSink& sink_;
  std::vector<Source> sources_;
  std::uint64_t count_ = 0;
  bool ending_ = false;
  DumpTotals totals_;
};

/// The names of a running ring and its nodes, as captures take them.
inline capture::RingNames names_of(const RingAccess& ring) {
  capture::RingNames names{ring.ring(), {}};
  for (const NodeName& node : ring.nodes()) names.nodes[wire::NodeId{node.id}] = node.name;
  return names;
}

/// The words for the ends of a line, and for capture::Kind.
inline const std::vector<std::string> kLines{"in", "out"};
inline const std::vector<std::string> kKinds{"data", "control", "interrupt"};

/// Which packets a command line asks for, in its own words.
struct FilterWords {
  std::vector<std::string> at, kinds, from, to;
  std::vector<unsigned> priority, channel;
  std::uint32_t sample = 1, limit = 0;
};

/// Id of a node by id or name. @throw UsageError listing those there are
wire::NodeId node_of(const std::string& word, const capture::RingNames& names);

/// @throw UsageError naming the word that is wrong, and what there is
capture::Choice choice_of(const FilterWords& words, const capture::RingNames& names);

/// As `packets` of an observe order (docs/reference/requests.md).
nlohmann::json order_of(const capture::Choice& choice);

/// What `trace` reads.
struct SeenPackets {
  capture::RingNames names;
  std::vector<capture::SeenPacket> packets;
  std::vector<capture::CapturedEvent> events;
  std::uint64_t lost = 0;  ///< missing: read too slowly, or more than the window of a live capture holds
};

/// Says on standard error what is wrong with a capture, as far as it was read.
void tell_problems(const capture::PcapngReader& reader);

/// All packets of a capture file. @throw capture::CaptureFileError
SeenPackets packets_of_file(const std::string& path);
/// What is on all lines of a running ring for so long, or until somebody asks it to end.
/// @throw HostPortError, NoRing
SeenPackets packets_of_ring(const std::string& ring, std::chrono::nanoseconds how_long);

}  // namespace limb_ring::ringctl
