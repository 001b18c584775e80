#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "io/unique_fd.h"
#include "io/unix_line.h"
#include "wire/bytes.h"

namespace limb_ring::link {

/// What the two ends of a line through shared memory have in common (ours, protocol.md section 6.12): a queue of bytes
/// with one writer and one reader, the slices of the line one after another, as on a stream.
///
/// Each end keeps its own index to itself and only publishes it. It checks the other end's index before use, so an end
/// that writes nonsense over all of the memory can end the line and do nothing else.
struct QueueControl {
  alignas(64) std::atomic<std::uint64_t> written;  ///< bytes since the beginning; the writer's
  std::atomic<std::uint32_t> writer_waits;         ///< 1: it wants to be told when there is room
  std::atomic<std::uint32_t> writer_beat;          ///< goes on while the writer lives
  alignas(64) std::atomic<std::uint64_t> read;     ///< bytes since the beginning; the reader's
  std::atomic<std::uint32_t> reader_sleeps;        ///< 1: it wants a byte in its pipe when something comes
  std::atomic<std::uint32_t> reader_beat;
};
static_assert(sizeof(QueueControl) == 128 && std::atomic<std::uint64_t>::is_always_lock_free);

/// The memory of a queue, mapped: 128 bytes of QueueControl, then the bytes.
class QueueMemory {
 public:
  static constexpr std::size_t kSmallest = 1 << 12, kLargest = 1 << 20;

  /// A new one, sealed: its size cannot change any more. @param capacity a power of two, kSmallest to kLargest
  /// @return nothing if the kernel gives none; errno says why
  static std::optional<QueueMemory> make(std::size_t capacity);
  /// One that another process made. @return nothing if it is none, or could still change its size
  static std::optional<QueueMemory> open(process::UniqueFd memory);

  QueueMemory(QueueMemory&& other) noexcept;
  QueueMemory& operator=(QueueMemory&& other) noexcept;
  ~QueueMemory();

  int fd() const { return fd_.get(); }
  std::size_t capacity() const { return capacity_; }
  QueueControl& control() const { return *static_cast<QueueControl*>(mapped_); }
  std::uint8_t* bytes() const { return static_cast<std::uint8_t*>(mapped_) + sizeof(QueueControl); }

 private:
  QueueMemory(process::UniqueFd fd, void* mapped, std::size_t capacity);
  static std::optional<QueueMemory> map(process::UniqueFd fd, std::size_t capacity);

  process::UniqueFd fd_;
  void* mapped_;
  std::size_t capacity_;
};

/// Bytes of capacity that a queue needs for a ring: a full packet of every node fits.
std::size_t queue_capacity(std::size_t nodes);

/// Why a line ends if the other end's index is one that it cannot have.
constexpr const char* kInvalidQueue = "its end of the shared memory is invalid";

/// The writer's end.
class QueueWriter {
 public:
  explicit QueueWriter(QueueMemory& memory) : memory_(&memory) {}

  /// @return how many of `bytes` there was room for; -1: the reader's end is invalid
  std::ptrdiff_t put(wire::ByteView bytes);
  /// True if the reader sleeps and has to be woken; true only once. To be called after put().
  bool must_wake();
  /// Asks to be told of room. @return false: there is room by now
  bool wait_for_room();
  void beat() { memory_->control().writer_beat.fetch_add(1, std::memory_order_relaxed); }
  /// True if the reader has said that it lives since the last call.
  bool heard_beat();

 private:
  QueueMemory* memory_;
  std::uint64_t written_ = 0;
  std::uint32_t beat_ = 0;
};

/// The reader's end.
class QueueReader {
 public:
  explicit QueueReader(QueueMemory& memory) : memory_(&memory) {}

  /// @return how many bytes were put into `space`, at most `size`; -1: the writer's end is invalid
  std::ptrdiff_t take(std::uint8_t* space, std::size_t size);
  /// True if the writer waits for room; true only once. To be called after take(), which makes room.
  bool must_tell_of_room();
  /// From now on the writer wakes the reader. @return false: something has come meanwhile
  bool sleep();
  void beat() { memory_->control().reader_beat.fetch_add(1, std::memory_order_relaxed); }
  bool heard_beat();

 private:
  QueueMemory* memory_;
  std::uint64_t read_ = 0;
  std::uint32_t beat_ = 0;
};

/// A candidate on this host reached through shared memory: the UNIX socket carries the handshake and the headers that
/// come back, and shows when the other end has gone; slices go into the queue.
class MemoryDownstream final : public UnixDownstream {
 public:
  /// @param capacity of the queue, bytes; as QueueMemory::make() takes it
  MemoryDownstream(boost::asio::io_context& io, std::string path, const Identity& self, std::size_t candidate,
                   std::size_t capacity, Owner& owner, OutputCounters& counters);
  void say_idle() override { queue_->beat(); }
  void tick() override;

 private:
  bool greet(const LinkHeader& connect) override;
  /// @return the other node's end of the pipe; invalid if the kernel gives none
  process::UniqueFd make_wake();
  std::ptrdiff_t put(wire::ByteView slices, std::string& reason) override;
  std::uint32_t wait_for_room() override;
  /// As much as a UNIX line's socket holds of small packets. The queue alone is too small: to stay in the cache it
  /// holds no more than one lap of a closed ring, but when a ring opens all nodes send at once what has waited. (ours)
  std::size_t may_wait() const override { return 256 * 1024; }

  std::size_t capacity_;
  std::optional<QueueMemory> memory_;
  std::optional<QueueWriter> queue_;
  process::UniqueFd wake_;  ///< our end of a pipe: whether it waits is ours alone, as it would not be of an eventfd
};

/// The end of a pipe that wakes us, opened anew: what we have been given the other node has too, and could make us wait
/// in it. @return invalid if it is not a pipe
process::UniqueFd open_wake(const process::UniqueFd& given);

/// A stream whose slices come through shared memory. Its socket says who is there, and that it has ended.
class MemoryStream final : public UnixStream {
 public:
  /// @param wake open_wake()'s
  /// @throw std::system_error if one of them cannot be waited for
  MemoryStream(boost::asio::io_context& io, process::UniqueFd socket, QueueMemory memory, process::UniqueFd wake,
               const LinkHeader& alive, Owner& owner, InputHandler& handler, InputCounters& counters);

  /// Reads what has come meanwhile, and waits for more.
  void read() override;
  void tick() override;
  void close() override;

 private:
  void on_woken(std::uint32_t events);
  /// @return false: nothing is there, or this stream is over
  bool read_once();

  QueueMemory memory_;
  QueueReader queue_;
  process::UniqueFd wake_;
  unsigned wakes_ = 0;
  event_loop::Watch woken_;
};

}  // namespace limb_ring::link
