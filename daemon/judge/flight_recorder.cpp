#include "judge/flight_recorder.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "io/regular_file.h"
#include "io/unique_fd.h"
#include "judge/recording.h"

namespace limb_ring::recorder {

std::uint64_t state_layout() {
  static const std::uint64_t layout = [] {
    core::Settings settings;
    settings.fold_back = true;
    core::NetworkController controller(settings, core::Time{});
    core::StateLayout members;
    controller.archive(members);
    return members.value();
  }();
  return layout;
}

FlightRecorder::FlightRecorder(core::NetworkController& controller, std::uint8_t* memory, std::size_t size, Title title,
                               core::Time now, std::function<void()> on_too_small)
    : controller_(controller),
      halves_(memory + kTitleSize),
      half_((size - kTitleSize) / 2 & ~std::size_t{7}),
      head_(reinterpret_cast<HalfHead*>(halves_)),
      records_(core::StateWriter(halves_, 0), now),
      ahead_(halves_),
      on_too_small_(std::move(on_too_small)) {
  title.layout = state_layout();
  title.program = LIMB_RING_VERSION;
  title.half = half_;
  core::StateWriter writer(memory + kMagic.size(), kTitleSize - kMagic.size());
  title.archive(writer);
  std::memcpy(memory, kMagic.data(), kMagic.size());
  controller.set_journal(this);
  begin_half();
}

bool FlightRecorder::half_is_over() const {
  if (records_.failed() || records_.left() < kMargin) return true;
  return records_.left_out() && records_.left() < kSoon && !controller_.holds_packets();
}

// The half has generation 0 until its state is written, so a process that is killed meanwhile leaves the other half
// valid. If the previous half ended early, the generation skips one number: the halves do not follow each other. So it
// does if the state holds packets, and data was left out: a replay of the previous half does not come to that state.
void FlightRecorder::begin_half() {
  const bool follows = !records_.failed() && !(records_.left_out() && controller_.holds_packets());
  generation_ += follows ? 1 : 2;
  const bool in_first = reinterpret_cast<std::uint8_t*>(head_) == halves_;
  std::uint8_t* const half = halves_ + (in_first ? half_ : 0);
  head_ = new (half) HalfHead{};
  head_->generation.store(0, std::memory_order_release);
  core::StateWriter room(half + sizeof(HalfHead), half_ - sizeof(HalfHead));
  core::Time last = records_.last();
  room("time", last);
  controller_.archive(room);
  if (room.failed() || room.left() < kMargin) return stop();
  records_ = RecordWriter(room, last);
  ahead_ = LinesAhead(room.next());
  head_->used.store(room.size(), std::memory_order_release);
  head_->generation.store(generation_, std::memory_order_release);
}

void FlightRecorder::stop() {
  stopped_ = true;
  controller_.set_journal(next_);
  on_too_small_();
}

void FlightRecorder::show() {
  if (records_.failed()) return;
  head_->used.store(records_.size(), std::memory_order_release);
  ahead_.fetch(records_.next(), records_.left());
}

// Only an input may begin a half: before it, the state is exactly the result of all records so far. Between the
// outputs of one input it is not.
void FlightRecorder::goes_in(const core::Input& input, core::Time now) {
  if (half_is_over()) begin_half();
  if (!stopped_) {
    records_.put(now == core::kNever ? records_.last() : now, input);
    show();
  }
  if (next_ != nullptr) next_->goes_in(input, now);
}

void FlightRecorder::goes_out(core::Line line, wire::ByteView framed_slices) {
  records_.put_written(records_.last(), line, framed_slices);
  show();
  if (next_ != nullptr) next_->goes_out(line, framed_slices);
}

void FlightRecorder::taken(const core::Event& event, core::Time now) {
  records_.put(now, event);
  show();
  if (next_ != nullptr) next_->taken(event, now);
}

void FlightRecorder::taken(const core::ReceivedPacket& packet, core::Time now) {
  records_.put(now, Taken(packet));
  show();
  if (next_ != nullptr) next_->taken(packet, now);
}

namespace {

using process::throw_errno;

constexpr const char* kExtension = ".record";
constexpr const char* kFormer = ".former";
constexpr const char* kNew = ".new";

// Writes to each page now, so that no packet has to wait for a page fault. MAP_POPULATE would only make them readable.
process::MappedFile touched(process::MappedFile file) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  for (std::size_t at = 0; at < file.size(); at += page) static_cast<volatile std::uint8_t*>(file.data())[at] = 0;
  return file;
}

bool write_all(int fd, const std::vector<std::uint8_t>& data) {
  for (std::size_t written = 0; written < data.size();) {
    const ssize_t more = ::write(fd, data.data() + written, data.size() - written);
    if (more < 0 && errno != EINTR) return false;
    if (more > 0) written += static_cast<std::size_t>(more);
  }
  return true;
}

// A part of a recording cannot be replayed; it would only be in the way of the next save.
void write_whole(const std::vector<std::uint8_t>& data, const std::string& path) {
  const process::UniqueFd file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.valid()) throw_errno("cannot write " + path);
  if (write_all(file.get(), data)) return;
  const int error = errno;
  ::unlink(path.c_str());
  errno = error;
  throw_errno("cannot write " + path);
}

}  // namespace

RecorderFile::RecorderFile(const std::string& path, std::size_t size, core::NetworkController& controller,
                           const Title& title, core::Time now, std::function<void()> on_too_small)
    : path_(path),
      memory_(touched(process::MappedFile::make(path + kNew, size))),
      recorder_(controller, static_cast<std::uint8_t*>(memory_.data()), size, title, now, std::move(on_too_small)) {
  // Only now: a start that fails, as where the disk is full, leaves the recordings of both lives as they are.
  ::rename(path.c_str(), (path + kFormer).c_str());  // fails if there is none
  if (::rename((path + kNew).c_str(), path.c_str()) != 0) throw_errno("cannot make " + path);
}

bool RecorderFile::is_in_place() const { return !memory_.is_cut_off() && ::access(path_.c_str(), F_OK) == 0; }

std::string recording_of(const std::string& folder, unsigned id) {
  return folder + '/' + std::to_string(id) + kExtension;
}

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::filesystem::path& path = it->path();
    const std::filesystem::path recording = is_of_former_life(path.string()) ? path.stem() : path;
    if (recording.extension() == kExtension && !it->is_directory(error)) files.push_back(path.string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool is_of_former_life(const std::string& recording) { return std::filesystem::path(recording).extension() == kFormer; }

std::size_t save_file(const std::string& recording, const std::string& to) {
  const process::UniqueFd file = process::open_regular(recording);
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0)
    throw std::runtime_error("cannot read " + recording + ": " + process::why_not_opened(recording));
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) throw std::runtime_error(recording + " is empty");
  const process::MappedFile mapped(file, size, PROT_READ, recording);
  const std::vector<std::uint8_t> saved = save({static_cast<const std::uint8_t*>(mapped.data()), size});
  if (mapped.is_cut_off()) throw std::runtime_error(recording + " was cut off while it was read");
  write_whole(saved, to);
  return saved.size();
}

}  // namespace limb_ring::recorder
