// A CPU that shares files with others: `racing_cpu FOLDER STEP...`, one step after the other:
//   at SECONDS          waits until that time of the ring
//   put FILE TEXT       writes the file anew
//   add FILE TEXT       writes behind what is in it
//   create FILE TEXT    writes it if it is not there
//   move FILE TO        renames it, if it is there
//   copy FILE TO        copies it, if it is there
//   remove FILE
//   expect FILE TEXT    ends with exit code 1 unless just that is in it
//   same FILE OTHER     ends with exit code 1 unless the same is in both
#include <limb_ring/host_port.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// @return whether it is as it is expected to be
bool do_step(limb_ring::HostPort& port, const std::string& word, const fs::path& file, const std::string& text,
             const fs::path& other) {
  const bool there = fs::exists(file);
  if (word == "at") port.sleep_until(std::chrono::seconds(std::stoi(file.filename())));
  if (word == "put" || (word == "create" && !there)) std::ofstream(file) << text;
  if (word == "add") std::ofstream(file, std::ios::app) << text;
  if (word == "move" && there) fs::rename(file, other);
  if (word == "copy" && there) fs::copy_file(file, other, fs::copy_options::overwrite_existing);
  if (word == "remove") fs::remove(file);
  if (word == "expect") return text_of(file) == text;
  if (word == "same") return text_of(file) == text_of(other);
  return true;
}

}  // namespace

int main(int count, char** arguments) try {
  const std::vector<std::string> words(arguments + 2, arguments + count);
  const fs::path folder = arguments[1];
  limb_ring::ConnectOptions options;
  options.role = limb_ring::Role::cpu;
  limb_ring::HostPort port = limb_ring::HostPort::connect(options);
  for (std::size_t i = 0; i + 1 < words.size();) {
    const bool pair = words[i] != "at" && words[i] != "remove";
    const std::string text = pair ? words.at(i + 2) : std::string();
    if (!do_step(port, words[i], folder / words[i + 1], text, folder / text)) return 1;
    i += pair ? 3 : 2;
  }
  while (port.connected()) port.receive(std::chrono::seconds(1));
} catch (const limb_ring::HostPortError&) {
  return 0;  // the ring has ended
}
