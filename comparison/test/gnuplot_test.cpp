// gnuplot as a child: what it draws, and every way in which it does not.
#include <gmock/gmock.h>

#include "comparison/plots/plots.h"
#include "comparison/test/plot_folder.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {
namespace {

using testing::HasSubstr;
using Gnuplot = PlotTest;

const Picture kLine{"line", "x,y\n1,1\n2,3\n", "set title 'a line'\nplot 'line.csv' using 1:2 with lines\n"};

TEST_F(Gnuplot, DrawsIntoAFolderOfAnyName) {
  LIMB_RING_NEEDS_GNUPLOT();
  const std::string odd = folder + "/new/it's \"odd\"; $HOME `x`";
  PlotFolder(odd).draw(kLine);
  for (const char* file : {"line.csv", "line.gp", "line.png", "line.svg"})
    EXPECT_TRUE(std::filesystem::exists(odd + "/" + file)) << file;
}

TEST_F(Gnuplot, ScriptThatItRefusesIsAnErrorWithItsOwnWords) {
  LIMB_RING_NEEDS_GNUPLOT();
  const auto draw = [this] { PlotFolder(folder).draw({"line", "", "nonsense\n"}); };
  EXPECT_THAT(test::thrown<std::runtime_error>(draw), HasSubstr("invalid command"));
}

TEST_F(Gnuplot, ScriptWithoutEndIsEnded) {
  LIMB_RING_NEEDS_GNUPLOT();
  std::ofstream(folder + "/long.gp") << "while (1) {}\n";
  const auto run = [this] { run_gnuplot(find_gnuplot(), folder, "long.gp", std::chrono::milliseconds(50)); };
  EXPECT_THAT(test::thrown<std::runtime_error>(run), HasSubstr("no end after 50 ms"));
}

TEST_F(Gnuplot, FileThatCannotBeWrittenIsAUsageError) {
  LIMB_RING_NEEDS_GNUPLOT();
  std::filesystem::create_directory(folder + "/line.gp");
  const auto draw = [this] { PlotFolder(folder).draw(kLine); };
  EXPECT_THAT(test::thrown<ring_sim::UsageError>(draw),
              HasSubstr(folder + "/line.gp: cannot be written: Is a directory"));
}

TEST_F(Gnuplot, MissingNamesThePackage) {
  ::setenv("PATH", "", 1);
  EXPECT_THAT(test::thrown<std::runtime_error>([] { find_gnuplot(); }), HasSubstr("install the package gnuplot-nox"));
}

TEST_F(Gnuplot, ProgramThatCannotBeStartedIsAnError) {
  std::ofstream(folder + "/gnuplot") << "no program";
  const auto run = [this] { run_gnuplot(folder + "/gnuplot", folder, "x.gp", std::chrono::seconds(10)); };
  EXPECT_THAT(test::thrown<std::runtime_error>(run), HasSubstr("gnuplot failed on " + folder + "/x.gp"));
}

}  // namespace
}  // namespace limb_ring::comparison
