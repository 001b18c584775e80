// For LD_PRELOAD: shifts CLOCK_REALTIME of a process by the nanoseconds in the file $WALL_CLOCK_SHIFT, which it maps,
// and CLOCK_BOOTTIME by those in $BOOT_CLOCK_SHIFT.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

using ReadClock = int (*)(clockid_t, timespec*);

const volatile std::int64_t* map_shift(const char* variable) {
  static const std::int64_t none = 0;
  const char* path = std::getenv(variable);
  const int file = path != nullptr ? ::open(path, O_RDONLY | O_CLOEXEC) : -1;
  if (file < 0) return &none;
  void* mapped = ::mmap(nullptr, sizeof none, PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  return mapped == MAP_FAILED ? &none : static_cast<const std::int64_t*>(mapped);
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static const auto real = reinterpret_cast<ReadClock>(::dlsym(RTLD_NEXT, "clock_gettime"));
  static const volatile std::int64_t* const of_wall = map_shift("WALL_CLOCK_SHIFT");
  static const volatile std::int64_t* const of_boot = map_shift("BOOT_CLOCK_SHIFT");
  const int result = real(clock, time);
  if (result != 0 || (clock != CLOCK_REALTIME && clock != CLOCK_BOOTTIME)) return result;
  const std::int64_t shift = clock == CLOCK_REALTIME ? *of_wall : *of_boot;
  const std::int64_t shifted = time->tv_sec * std::int64_t{1'000'000'000} + time->tv_nsec + shift;
  time->tv_sec = shifted / 1'000'000'000;
  time->tv_nsec = shifted % 1'000'000'000;
  return result;
}
