// daemon/io: programs found and started, how they ended, what the kernel says of them.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>

#include "io/child.h"
#include "io/process_state.h"
#include "io/program.h"
#include "io/regular_file.h"
#include "io/signal_wait.h"
#include "io/spawn.h"
#include "io/wall_clock.h"

namespace limb_ring::process {
namespace {

using namespace std::chrono_literals;

const std::string kMapped = (std::filesystem::temp_directory_path() / ("mapped" + std::to_string(::getpid()))).string();

TEST(MappedFile, ThatIsCutOffHasZerosBehindItsEndAndTakesWhatIsWrittenThere) {
  constexpr std::size_t kPages = 3, kPage = 4096;
  const MappedFile file = MappedFile::make(kMapped, kPages * kPage);
  auto* const bytes = static_cast<volatile char*>(file.data());
  for (std::size_t i = 0; i < kPages; ++i) bytes[i * kPage] = 'x';
  std::filesystem::resize_file(kMapped, kPage);
  EXPECT_FALSE(file.is_cut_off()) << "nobody has looked";
  EXPECT_EQ(bytes[kPage], 0);
  EXPECT_TRUE(file.is_cut_off());
  bytes[2 * kPage] = 'y';
  EXPECT_EQ(bytes[2 * kPage], 'y');
  EXPECT_EQ(bytes[0], 'x') << "the file has it";
  std::filesystem::remove(kMapped);
}

TEST(MappedFile, OfAnotherSizeThanItWasSaidToHaveIsReadAsZeros) {
  { const MappedFile made = MappedFile::make(kMapped, 10); }
  const UniqueFd open(::open(kMapped.c_str(), O_RDONLY));
  const MappedFile file(open, 100000, PROT_READ, kMapped);
  EXPECT_EQ(static_cast<volatile char*>(file.data())[90000], 0);
  EXPECT_TRUE(file.is_cut_off());
  std::filesystem::remove(kMapped);
}

TEST(MappedFile, LeavesABusErrorThatIsNotItsOwnAsItIs) {
  const MappedFile file = MappedFile::make(kMapped, 10);
  const UniqueFd open(::open(kMapped.c_str(), O_RDWR));
  auto* const other = static_cast<volatile char*>(::mmap(nullptr, 100000, PROT_READ, MAP_SHARED, open.get(), 0));
  EXPECT_EXIT({ (void)other[90000]; }, testing::KilledBySignal(SIGBUS), "");
  std::filesystem::remove(kMapped);
}

TEST(Standstill, IsWhatNoRoundOfALoopTakesAndAddsUp) {
  const Standstill::Time begun{};
  Standstill standstill(begun);
  EXPECT_EQ(standstill.look(begun + 900ms), 0ms);
  EXPECT_EQ(standstill.look(begun + 60'900ms), 60'000ms);
  EXPECT_EQ(standstill.look(begun + 61'000ms), 0ms);
  standstill.look(begun + 63'000ms);
  EXPECT_EQ(standstill.total(), 62'000ms);
}

Spawned started(std::vector<std::string> arguments) {
  SpawnRequest request;
  request.path = find_program(arguments.front());
  request.arguments = std::move(arguments);
  return spawn(request);
}

ExitStatus ended(const Spawned& child) {
  int status = 0;
  EXPECT_EQ(::waitpid(child.pid, &status, 0), child.pid);
  const int error = exec_error(child);
  return error != 0 ? not_executed("it", error) : exit_status(status);
}

// Two readings of the system's clocks, one after the other, would be apart by what the process waited in between.
TEST(WallClock, KeepsTheDistancesOfItsInstants) {
  WallClock clock;
  const auto now = WallClock::Steady::now();
  const std::int64_t first = clock.at(now);
  EXPECT_NEAR(static_cast<double>(first),
              static_cast<double>(std::chrono::system_clock::now().time_since_epoch() / 1ns), 60e9);
  for (const auto later : {1ns, 1000ns, 999999999ns}) EXPECT_EQ(clock.at(now + later) - first, later.count());
}

TEST(WallClock, KnowsTheAgeOfItsStamps) {
  WallClock clock;
  const auto now = WallClock::Steady::now();
  EXPECT_EQ(clock.age_of(clock.at(now), now + 5ms), 5ms);
  EXPECT_EQ(clock.age_of(clock.at(now), now - 5ms), -5ms);
}

// Each with the drift of a clock that is slewed.
TEST(WallOffset, AsksTheFormerClockForASecondAfterAStep) {
  WallOffset wall;
  wall.set(1000, 0ns);
  wall.set(1999, 1s);
  EXPECT_EQ(wall.age_of(wall.stamp_of(1s), 3s), 2s) << "no step";
  const std::int64_t before = wall.stamp_of(3s);
  for (const std::int64_t step : {3'600'000'000'000, -3'600'000'000'000}) {
    WallOffset stepped = wall;
    stepped.set(1999 + step, 3s);
    EXPECT_EQ(stepped.age_of(before, 3s + 1ms), 1ms);
    EXPECT_EQ(stepped.age_of(stepped.stamp_of(3s), 3s + 2ms), 2ms);
    EXPECT_EQ(stepped.age_of(before, 4s), 1s + std::chrono::nanoseconds(step)) << "long after it";
  }
}

TEST(Spawn, TellsHowAProgramEnded) {
  EXPECT_TRUE(ended(started({"true"})).clean);
  EXPECT_EQ(ended(started({"sh", "-c", "exit 3"})).text, "exit 3");
  EXPECT_EQ(ended(started({"sh", "-c", "kill -9 $$"})).text, "signal 9 (Killed)");
}

TEST(Spawn, TellsThatAProgramCouldNotBeExecuted) {
  SpawnRequest request;
  request.path = "/no/such/program";
  request.arguments = {"program"};
  const ExitStatus status = ended(spawn(request));
  EXPECT_FALSE(status.executed);
  EXPECT_EQ(status.text, "cannot execute it: No such file or directory");
}

TEST(ProcessState, DiffersForAStoppedAnEndedAndAMissingProcess) {
  const Spawned child = started({"sleep", "1000"});
  ::kill(child.pid, SIGSTOP);
  ::waitpid(child.pid, nullptr, WUNTRACED);
  EXPECT_TRUE(is_stopped(child.pid));
  EXPECT_FALSE(is_gone(child.pid));
  ::kill(child.pid, SIGKILL);
  siginfo_t info{};
  ::waitid(P_PID, static_cast<id_t>(child.pid), &info, WEXITED | WNOWAIT);
  EXPECT_TRUE(is_gone(child.pid)) << "ended, not waited for yet";
  ::waitpid(child.pid, nullptr, 0);
  EXPECT_EQ(process_state(child.pid), 0);
}

TEST(SpawnCopy, RunsItsWorkAndEndsWithWhatThatReturns) {
  const int before = 3;
  const Spawned child = spawn_copy([&] { return before + 4; });
  const ExitStatus status = ended(child);
  EXPECT_EQ(status.text, "exit 7");
  EXPECT_EQ(status.code, 7);
}

TEST(Child, TellsOnceThatItHasEnded) {
  Child child(spawn_copy([] { return 3; }), "it");
  siginfo_t info{};
  ::waitid(P_PID, static_cast<id_t>(child.pid()), &info, WEXITED | WNOWAIT);
  EXPECT_TRUE(child.reap());
  ASSERT_TRUE(child.ended());
  EXPECT_EQ(child.ended()->code, 3);
  EXPECT_FALSE(child.reap());
}

TEST(Child, HasEndedWhenKillReturns) {
  Child child(spawn_copy([]() -> int {
                for (;;) ::pause();
              }),
              "it");
  EXPECT_FALSE(child.reap());
  child.kill();
  ASSERT_TRUE(child.ended());
  EXPECT_EQ(child.ended()->text, "signal 9 (Killed)");
  EXPECT_EQ(child.ended()->code, std::nullopt);
  EXPECT_TRUE(is_gone(child.pid()));
}

TEST(Child, ThatTheKernelHasReapedIsNotKnownToHaveEndedCleanly) {
  const auto before = ::signal(SIGCHLD, SIG_IGN);
  Child child(spawn_copy([] { return 3; }), "it");
  const ProcessHandle handle(child.pid());
  while (!handle.ended()) ::sched_yield();
  while (!child.ended()) child.reap();
  EXPECT_FALSE(child.ended()->clean);
  EXPECT_EQ(child.ended()->text, "ended, status unknown (SIGCHLD is ignored)");
  ::signal(SIGCHLD, before);
}

class Handle : public ::testing::TestWithParam<ProcessHandle::By> {};

TEST_P(Handle, SignalsUntilItsProcessIsGone) {
  const Spawned child = started({"sleep", "1000"});
  const ProcessHandle handle(child.pid, GetParam());
  EXPECT_FALSE(handle.ended());
  EXPECT_TRUE(handle.signal(SIGKILL));
  ::waitpid(child.pid, nullptr, 0);
  EXPECT_TRUE(handle.ended());
  EXPECT_FALSE(handle.signal(SIGKILL));
}
INSTANTIATE_TEST_SUITE_P(By, Handle, ::testing::Values(ProcessHandle::By::pidfd, ProcessHandle::By::number));

}  // namespace

TEST(BackOff, DoublesUpToItsLimit) {
  BackOff back_off({100ms, 350ms, 10s});
  EXPECT_EQ(back_off.after(0ms), 100ms);
  EXPECT_EQ(back_off.after(0ms), 200ms);
  EXPECT_EQ(back_off.after(0ms), 350ms);
  EXPECT_EQ(back_off.after(9999ms), 350ms);
}

TEST(BackOff, StartsAgainAfterASteadyRun) {
  BackOff back_off({100ms, 5s, 10s});
  back_off.after(0ms);
  back_off.after(0ms);
  EXPECT_EQ(back_off.after(10s), 100ms);
  EXPECT_EQ(back_off.after(0ms), 200ms);
}

TEST(FindProgram, LooksInItsFolderBeforePath) {
  EXPECT_EQ(find_program("sh", "/bin"), "/bin/sh");
  EXPECT_NE(find_program("sh", "/nowhere"), "");
  EXPECT_EQ(find_program("no_such_program", "/bin"), "");
  EXPECT_EQ(find_program("/bin/sh"), "/bin/sh");
  EXPECT_EQ(find_program("/bin"), "") << "a folder is no program";
}

TEST(FindProgram, SaysWhereItHasLooked) {
  EXPECT_EQ(no_program("own_cpu", "/bin"), "no program 'own_cpu' that can be executed (looked in /bin and on PATH)");
  EXPECT_EQ(no_program("/opt/cpu", "/bin"), "no program '/opt/cpu' that can be executed");
  EXPECT_EQ(no_program("build/own_cpu", "/bin"), "no program 'build/own_cpu' that can be executed (seen from " +
                                                     std::filesystem::current_path().string() + ")");
}

}  // namespace limb_ring::process
