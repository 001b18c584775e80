#include "judge/observation_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "io/unique_fd.h"
#include "wire/packet.h"

namespace limb_ring::promises {
namespace {

constexpr std::array<char, 8> kRingMagic{'l', 'i', 'm', 'b', 's', 'e', 'e', '1'};
/// Half a MiB: more than half a second of the fastest ring.
constexpr std::size_t kCapacity = 16384;
/// This many of the oldest records in the file are not read: the writer may be overwriting them.
constexpr std::uint64_t kBeingWritten = 64;

}  // namespace

struct ObservationRing {
  std::array<char, 8> magic;
  alignas(64) std::atomic<std::uint64_t> count;  ///< complete; the newest one is at (count - 1) % kCapacity
  alignas(64) std::array<Observation, kCapacity> all;
};

namespace {

[[noreturn]] void fail_with(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

ObservationRing* in(const process::MappedFile& file) { return static_cast<ObservationRing*>(file.data()); }

process::MappedFile open_ring(const std::string& path) {
  const process::UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.valid()) fail_with(errno, "cannot read " + path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || status.st_size != static_cast<off_t>(sizeof(ObservationRing)))
    throw std::runtime_error(path + " holds no observations of this version");
  process::MappedFile ring(file, sizeof(ObservationRing), PROT_READ, path);
  if (in(ring)->magic != kRingMagic) throw std::runtime_error(path + " holds no observations");
  return ring;
}

}  // namespace

ObservationFile::ObservationFile(std::string path)
    : path_(std::move(path)), file_(process::MappedFile::make(path_, sizeof(ObservationRing))), ring_(in(file_)) {
  ring_->magic = kRingMagic;
}

ObservationFile::~ObservationFile() { ::unlink(path_.c_str()); }

bool ObservationFile::is_there() const {
  struct stat found {};
  return ::stat(path_.c_str(), &found) == 0 && found.st_size == static_cast<off_t>(file_.size()) && !file_.is_cut_off();
}

// Of what was cut off nothing is kept: a reader of it goes on at count().
void ObservationFile::make_again() {
  process::MappedFile again = process::MappedFile::make(path_, sizeof(ObservationRing));
  in(again)->all = ring_->all;
  in(again)->count.store(count_, std::memory_order_release);
  in(again)->magic = kRingMagic;
  file_ = std::move(again);
  ring_ = in(file_);
}

void ObservationFile::put(const Observation& seen) {
  ring_->all[count_ % kCapacity] = seen;
  ring_->count.store(++count_, std::memory_order_release);
}

ObservationReader::ObservationReader(const std::string& path, std::uint64_t from)
    : file_(open_ring(path)), ring_(in(file_)), next_(from) {}

void ObservationReader::follow(const std::string& path, std::uint64_t from) {
  (void)ring_->count.load();  // finds out whether it was cut off
  if (file_.is_cut_off()) lost_ += from - std::exchange(next_, from);
  file_ = open_ring(path);
  ring_ = in(file_);
}

std::uint64_t ObservationReader::read(std::vector<Observation>& seen) {
  seen.clear();
  const std::uint64_t count = ring_->count.load(std::memory_order_acquire);
  const std::uint64_t first = next_;
  std::uint64_t from = count > kCapacity ? std::max(first, count - kCapacity + kBeingWritten) : first;
  for (std::uint64_t i = from; i < count; ++i) seen.push_back(ring_->all[i % kCapacity]);
  std::atomic_thread_fence(std::memory_order_acquire);
  // Drops what the writer has overwritten during the copy.
  const std::uint64_t now = ring_->count.load(std::memory_order_relaxed);
  const std::uint64_t good = now + kBeingWritten > kCapacity ? now + kBeingWritten - kCapacity : 0;
  if (good > from) {
    const std::uint64_t bad = std::min<std::uint64_t>(good - from, seen.size());
    seen.erase(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(bad));
    from += bad;
  }
  if (file_.is_cut_off()) {  // what was copied may be what is there in its place
    seen.clear();
    return 0;
  }
  next_ = count;
  return from - first + std::exchange(lost_, 0);
}

using Kind = Observation::Kind;
using std::chrono::nanoseconds;

NodeObserver::NodeObserver(const core::Settings& settings, nanoseconds zero, std::function<std::size_t()> waiting,
                           ObservationSink& sink, core::Duration goes_on)
    : settings_(settings),
      zero_(zero),
      waiting_(std::move(waiting)),
      sink_(sink),
      goes_on_(goes_on),
      cut_through_([this](const capture::PacketView& packet) {
        if (packet.whole()) came(packet.bytes, came_at_);
      }) {}

Observation NodeObserver::at(Kind kind, core::Time now) const {
  Observation seen;
  seen.kind = kind;
  seen.at_ns = (zero_ + core::whole_nanoseconds(now.time_since_epoch())).count();
  return seen;
}

// ---- in -------------------------------------------------------------------------------------

void NodeObserver::goes_in(const core::Input& input, core::Time now) {
  if (now == core::kNever) return;  // the two calls that are not told the time say nothing here
  if (now >= next_) say_it_goes_on(now);
  // Nearly always it is a packet that passes, so that is asked first: what passes must cost nothing.
  if (const auto* call = std::get_if<core::input::Receive>(&input)) return see(*call, now);
  std::visit([&](const auto& call) { see(call, now); }, input);
}

void NodeObserver::say_it_goes_on(core::Time now) {
  next_ = now + goes_on_;
  Observation seen = at(Kind::goes_on, now);
  seen.detail = waiting_() == 0 ? 1 : 0;
  sink_.put(seen);
}

// Packets on the second line are only passed back on it, so it is not observed. At a fold node that is not so: what it
// receives there is not reported.
void NodeObserver::see(const core::input::Receive& call, core::Time now) {
  if (call.line != core::Line::first) return;
  if (call.slice.kind == wire::SliceKind::whole || call.slice.kind == wire::SliceKind::interrupt)
    return came(call.slice.bytes, now);
  came_at_ = now;
  cut_through_.put(call.slice, nanoseconds(0));
}

void NodeObserver::see(const core::input::InputGap&, core::Time) { cut_through_.gap(nanoseconds(0)); }

void NodeObserver::see(const core::input::InputLost&, core::Time) { cut_through_.gap(nanoseconds(0)); }

void NodeObserver::came(wire::ByteView bytes, core::Time now) {
  const wire::PacketFields packet{bytes};
  const bool round = packet.hop() >= settings_.order.size();
  const bool broadcast =
      packet.destination() == wire::kBroadcast && packet.source() != settings_.id && packet.code().attempt == 0;
  if ((!round && !broadcast) || !packet.crc_good()) return;
  const bool interrupt = packet.code().interrupt;
  Observation seen = at(round ? Kind::circles : Kind::passed, now);
  seen.source = packet.source();
  seen.destination = packet.destination();
  seen.queue = interrupt ? Observation::kInterrupt : std::uint8_t{wire::priority_of(packet.last())};
  seen.channel =
      interrupt ? std::uint8_t{wire::factor_of(packet.last())} : std::uint8_t{wire::channel_of(packet.last())};
  seen.size = round ? packet.hop() : static_cast<std::uint16_t>(packet.data().size);
  if (!interrupt) seen.checksum = wire::crc32(packet.data());
  if (round || interrupt || !wire::is_control(packet)) sink_.put(seen);
}

void NodeObserver::see(const core::input::Send& call, core::Time now) {
  Observation seen = at(Kind::asked, now);
  seen.owner = call.request.owner;
  seen.token = call.request.token;
  seen.destination = call.request.destination;
  seen.queue = call.request.priority & 3;
  seen.channel = call.request.channel;
  seen.size = static_cast<std::uint16_t>(call.request.data.size);
  seen.checksum = wire::crc32(call.request.data);
  sink_.put(seen);
}

void NodeObserver::see(const core::input::Interrupt& call, core::Time now) { asks_for_interrupt(call.request, now); }

void NodeObserver::see(const core::input::Pull& call, core::Time now) {
  core::InterruptRequest request;
  request.owner = call.owner;
  request.token = call.token;
  if (call.input < settings_.inputs.size() && settings_.inputs[call.input]) {
    request.destination = settings_.inputs[call.input]->destination;
    request.factor = settings_.inputs[call.input]->factor;
  }
  asks_for_interrupt(request, now);
}

void NodeObserver::asks_for_interrupt(const core::InterruptRequest& request, core::Time now) {
  Observation seen = at(Kind::asked, now);
  seen.owner = request.owner;
  seen.token = request.token;
  seen.destination = request.destination;
  seen.queue = Observation::kInterrupt;
  seen.channel = request.factor;
  sink_.put(seen);
}

void NodeObserver::see(const core::input::CpuReset&, core::Time now) { sink_.put(at(Kind::flushed, now)); }

// ---- out ------------------------------------------------------------------------------------

void NodeObserver::taken(const core::Event& event, core::Time now) {
  if (const auto* end = std::get_if<core::SendEnded>(&event.what)) {
    if (end->owner == core::kController) return;
    Observation seen = at(Kind::ended, now);
    seen.owner = end->owner;
    seen.token = end->token;
    seen.destination = end->destination;
    seen.queue = end->interrupt ? Observation::kInterrupt : std::uint8_t{0};
    seen.detail = static_cast<std::uint8_t>(end->outcome);
    seen.tries = static_cast<std::uint8_t>(end->tries);
    sink_.put(seen);
  } else if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) {
    Observation seen = at(Kind::pin, now);
    seen.source = pin->source;
    seen.destination = settings_.id;
    seen.queue = Observation::kInterrupt;
    seen.channel = pin->factor;
    sink_.put(seen);
  } else if (const auto* state = std::get_if<core::StateChanged>(&event.what)) {
    Observation seen = at(Kind::state, now);
    seen.detail = static_cast<std::uint8_t>(state->after);
    sink_.put(seen);
  }
}

void NodeObserver::taken(const core::ReceivedPacket& packet, core::Time now) {
  Observation seen = at(Kind::taken, now);
  seen.source = packet.source;
  seen.destination = packet.destination;
  seen.queue = packet.priority;
  seen.channel = packet.channel;
  seen.size = packet.size;
  seen.checksum = wire::crc32(packet.bytes());
  sink_.put(seen);
}

// Four tries, each of which may wait for the line, after four tries of the previous send.
nanoseconds longest_send(const core::Settings& settings) {
  const core::Duration tries = wire::kTries * (settings.send_timeout() + settings.queue_timeout);
  return core::whole_nanoseconds(settings.queue_timeout + 2 * tries);
}

}  // namespace limb_ring::promises
