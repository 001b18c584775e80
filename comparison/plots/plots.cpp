#include "comparison/plots/plots.h"

#include <fstream>
#include <iostream>

#include "comparison/plots/gnuplot.h"
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

}  // namespace limb_ring::comparison
