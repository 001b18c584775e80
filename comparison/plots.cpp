#include "comparison/plots.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "io/child.h"
#include "io/program.h"
#include "io/spawn.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/ring_sim/command_line.h"

namespace limb_ring::comparison {
namespace {

constexpr std::chrono::seconds kLimit{60};  // a picture takes a second on an idle machine

// Okabe and Ito's palette for the colour-blind (Color Universal Design); no two lines that share a
// picture have the same dashes and points. 7 and 8 are bounds, 9 is background.
constexpr const char* kStyle = R"(set encoding utf8
set datafile separator ','
set linetype 1 linecolor rgb '#0072B2' linewidth 3 dashtype 1 pointtype 7 pointsize 1.1
set linetype 2 linecolor rgb '#E69F00' linewidth 2 dashtype (10,4) pointtype 5 pointsize 1.1
set linetype 3 linecolor rgb '#009E73' linewidth 2 dashtype (10,4,3,4) pointtype 9 pointsize 1.3
set linetype 4 linecolor rgb '#D55E00' linewidth 2 dashtype (3,4) pointtype 4 pointsize 1.3
set linetype 5 linecolor rgb '#CC79A7' linewidth 2 dashtype (18,5) pointtype 13 pointsize 1.4
set linetype 6 linecolor rgb '#56B4E9' linewidth 2 dashtype (10,4,3,4,3,4) pointtype 2 pointsize 1.3
set linetype 7 linecolor rgb '#000000' linewidth 2 dashtype (6,5)
set linetype 8 linecolor rgb '#000000' linewidth 2 dashtype (14,5,3,5)
set linetype 9 linecolor rgb '#BBBBBB' linewidth 1 dashtype 1
)";

std::string script_of(const Picture& picture) {
  const auto terminal = [&picture](const char* name, const char* extension) {
    return std::string("set terminal ") + name +
           " size 900,600 noenhanced font 'sans-serif,13' background rgb 'white'\n" + "set output '" + picture.name +
           "." + extension + "'\n";
  };
  return "# Draws " + picture.name + ".png and .svg: gnuplot " + picture.name + ".gp, in this folder.\n" + kStyle +
         terminal("pngcairo", "png") + picture.script + terminal("svg", "svg") + "replot\n";
}

}  // namespace

PlotFolder::PlotFolder(const std::string& path) : path_(path) {
  if (const std::string problem = app::make_output_folder(path); !problem.empty()) throw ring_sim::UsageError(problem);
  gnuplot_ = find_gnuplot();
}

void PlotFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = path_ + "/" + name;
  std::ofstream file;
  const std::string wrong_place = app::open_for_writing(file, path);
  if (!wrong_place.empty()) throw ring_sim::UsageError(wrong_place);
  file << text;
  const std::string not_written = cli::finish_writing(file, path);
  if (!not_written.empty()) throw std::runtime_error(not_written);
}

void PlotFolder::draw(const Picture& picture) const {
  write(picture.name + ".csv", picture.csv);
  write(picture.name + ".gp", script_of(picture));
  run_gnuplot(gnuplot_, path_, picture.name + ".gp", kLimit);
  std::cerr << "compare_networks: " << path_ << '/' << picture.name << ".png and .svg" << std::endl;
}

void draw_all(const PlotFolder& folder, const PlotInput& input) {
  std::cerr << "compare_networks: plots ..." << std::endl;
  folder.draw(plot_latency_nodes(input));
  folder.draw(plot_latency_nodes_own_rates(input));
  folder.draw(plot_efficiency(input));
  folder.draw(plot_round_trips(input));
  folder.draw(plot_embedding(input));
  folder.draw(plot_timeline_alone(input));
  folder.draw(plot_timeline_worst(input));
}

namespace {

using std::chrono::steady_clock;
constexpr std::chrono::milliseconds kTick{5};

/// @return false: it took too long, and was killed
bool wait_for(process::Child& child, std::chrono::milliseconds limit) {
  const auto deadline = steady_clock::now() + limit;
  while (!child.reap()) {
    if (steady_clock::now() >= deadline) {
      child.kill();
      return false;
    }
    std::this_thread::sleep_for(kTick);
  }
  return true;
}

/// The last of what was written into `file`.
std::string last_words(int file) {
  std::array<char, 600> text{};
  const off_t size = ::lseek(file, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t read = ::pread(file, text.data(), text.size(), from);
  return read > 0 ? std::string(text.data(), static_cast<std::size_t>(read)) : std::string{};
}

}  // namespace

std::string find_gnuplot() {
  const std::string path = process::find_program("gnuplot");
  if (path.empty())
    throw std::runtime_error("plots need gnuplot, which is not on PATH: install the package gnuplot-nox");
  return path;
}

void run_gnuplot(const std::string& gnuplot, const std::string& folder, const std::string& script,
                 std::chrono::milliseconds limit) {
  const process::UniqueFd output(::memfd_create("gnuplot", MFD_CLOEXEC));
  process::SpawnRequest request;
  request.path = gnuplot;
  request.arguments = {"gnuplot", "-d", script};  // -d: whatever the user's own start-up file says
  request.folder = folder;
  request.output = output.get();
  process::Child child(process::spawn(request), gnuplot);
  if (child.ended()) throw std::runtime_error("cannot start gnuplot: " + child.ended()->text);
  const std::string where = "gnuplot failed on " + folder + "/" + script + ": ";
  if (!wait_for(child, limit))
    throw std::runtime_error(where + "no end after " + std::to_string(limit.count()) + " ms");
  if (!child.ended()->executed) throw std::runtime_error(where + child.ended()->text);
  if (!child.ended()->clean) throw std::runtime_error(where + last_words(output.get()));
}

}  // namespace limb_ring::comparison
