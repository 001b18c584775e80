#include "tools/ringctl/send.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "config/ring_config.h"
#include "io/signal_wait.h"
#include "limb_ring/ring_directory.h"
#include "ring/reset_node.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "wire/packet.h"

namespace limb_ring::ringctl {
namespace {

struct SendOptions {
  std::string from, to, text, hex;
  unsigned priority = 2, channel = 0, size = 0, count = 1;
  double interval_s = 0;
  bool json = false;
};

/// `size` bytes 0, 1, 2 ... 255, 0 ...
std::vector<std::uint8_t> pattern(unsigned size) {
  std::vector<std::uint8_t> bytes(size);
  for (unsigned i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i);
  return bytes;
}

std::vector<std::uint8_t> data_of(const SendOptions& options) {
  if (options.size > 0) return pattern(options.size);
  if (!options.hex.empty()) return parse_hex(options.hex);
  return {options.text.begin(), options.text.end()};
}

std::vector<std::uint8_t> checked_data(const SendOptions& options) {
  const std::vector<std::uint8_t> data = data_of(options);
  if (!data.empty() && data.size() <= kMaxPayload) return data;
  throw UsageError(std::to_string(data.size()) + " bytes of data; a packet holds 1 to " + std::to_string(kMaxPayload));
}

int run(const Context& context, const SendOptions& options) {
  const std::vector<std::uint8_t> data = checked_data(options);
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const std::uint8_t to = ring.destination(options.to);
  HostPort port = ring.connect(ring.node(options.from), Stay::for_long);
  const auto send = [&] {
    return port.send(to, data, static_cast<std::uint8_t>(options.priority), static_cast<std::uint8_t>(options.channel));
  };
  const std::chrono::nanoseconds interval(std::llround(options.interval_s * 1e9));
  return report(send_and_explain(port, ring, to, options.count, send, interval), options.json);
}

const CLI::App& add_data_options(CLI::App& command, SendOptions& options) {
  CLI::App& data = *command.add_option_group("data", "What to send, one of:");
  data.add_option("--size", options.size, "This many bytes (0, 1, 2 ...), 1 to 512")
      ->transform(cli::whole(1, kMaxPayload));
  data.add_option("--data", options.text, "This text, 1 to 512 bytes");
  data.add_option("--hex", options.hex, "These bytes, two hexadecimal digits each");
  return data;
}

void require_one(const CLI::App& data) {
  const auto options = data.get_options();
  const auto given =
      std::count_if(options.begin(), options.end(), [](const CLI::Option* one) { return one->count() > 0; });
  if (given == 1) return;
  throw UsageError(std::string(given == 0 ? "nothing to send was given" : "only one thing can be sent at a time") +
                   "; --size, --data or --hex is needed");
}

}  // namespace

void add_send(CLI::App& app, Context& context) {
  auto options = std::make_shared<SendOptions>();
  CLI::App* command = add_command(app, "send", "Send data packets, and print how each ended",
                                  "ringctl send --from head --to left_knee --data hello");
  command->add_option("--from", options->from, "Node that sends, id or name")->required();
  command->add_option("--to", options->to, "Node to send to, id or name, or all")->required();
  command->add_option("--priority", options->priority, "0 (highest) to 3; default 2")->transform(cli::whole(0, 3));
  command->add_option("--channel", options->channel, "0 (user, default), 2 to 63; joint is 2, topic is 3")
      ->transform(channel_of_clients());
  command->add_option("-c,--count", options->count, "How many, 1 to 1000000; default 1")
      ->transform(cli::whole(1, 1000000));
  command
      ->add_option(
          "-i,--interval", options->interval_s,
          "Time between two packets, 0 to 3600 s, such as 5ms or 0.2; default 0: the next as soon as one has ended")
      ->transform(cli::seconds(0, 3600));
  const CLI::App& data = add_data_options(*command, *options);
  add_json(*command, options->json);
  command->callback([&context, &data, options] {
    context.action = [&context, &data, options] {
      require_one(data);
      return run(context, *options);
    };
  });
}

using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds kRowTime{300};  // a destination that is busy is not waited for
constexpr unsigned kOutstanding = 16;               // well below a node's send queue

double microseconds_of(const Result& result) { return static_cast<double>(result.round_trip.count()) / 1000.0; }

bool delivered(const Result& result) { return result.outcome == Outcome::delivered; }

/// It was delivered, or may have been: nothing has come home that says otherwise.
bool may_be(const Result& result) { return ask::may_have_arrived(result) || result.outcome == Outcome::lost; }

/// @return false if nothing came
bool take_one(HostPort& port, std::vector<Result>& results, std::chrono::nanoseconds until_next) {
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(until_next);
  const auto message = port.receive(std::clamp(wait, std::chrono::milliseconds(0), process::SignalWait::kTick));
  if (!message) return false;
  if (const auto* result = std::get_if<Result>(&*message)) results.push_back(*result);
  if (const auto* end = std::get_if<Disconnected>(&*message)) throw gone(port, end->reason);
  return true;
}

/// Adds to `sends`, so that what has ended is kept where this throws. @throw HostPortError
void send_into(Sends& sends, HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
               std::chrono::nanoseconds interval) {
  const auto begun = steady_clock::now();
  process::Standstill standstill(begun);
  ResultWait wait(port);
  process::SignalWait signals;
  Progress progress(port.ring());
  std::vector<Result>& results = sends.results;
  while (results.size() < count) {
    tell_standstill(standstill.look(steady_clock::now()));
    const auto turn = [&] { return begun + standstill.total() + interval * static_cast<std::int64_t>(sends.sent); };
    const auto& sent = sends.sent;
    for (; sent < count && sent - results.size() < kOutstanding && turn() <= steady_clock::now(); ++sends.sent) send();
    const bool waits_for_turn = sent < count && turn() > steady_clock::now();
    if (take_one(port, results, waits_for_turn ? turn() - steady_clock::now() : process::SignalWait::kTick) ||
        sent == results.size())
      wait.restart();
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0)))) break;
    wait.check();
    progress.tell(std::to_string(results.size()) + " of " + std::to_string(count) + " ended");
  }
}

}  // namespace

Sends send_all(HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
               std::chrono::nanoseconds interval) {
  Sends sends;
  sends.asked = count;
  try {
    send_into(sends, port, count, send, interval);
  } catch (const HostPortError& error) {
    sends.problem = error.what();
  }
  return sends;
}

Sends send_and_explain(HostPort& port, const RingAccess& ring, std::uint8_t to, unsigned count,
                       const std::function<std::uint32_t()>& send, std::chrono::nanoseconds interval) {
  std::vector<ask::Node> nodes;
  for (const ask::Node& node : ring.nodes())
    if (to == kBroadcast || node.id == to) nodes.push_back(node);
  const RefusalCounters counters(ask::status_rows(ring.ring(), nodes, kRowTime));
  Sends sends = send_all(port, count, send, interval);
  std::vector<Result>& results = sends.results;
  const auto refused = [](const Result& result) { return result.outcome == Outcome::refused; };
  if (std::any_of(results.begin(), results.end(), refused))
    counters.explain(results, nodes, ask::status_rows(ring.ring(), nodes, kRowTime));
  return sends;
}

nlohmann::json to_json(const Result& result) {
  return {{"outcome", to_string(result.outcome)},
          {"round_trip_us", microseconds_of(result)},
          {"tries", result.tries},
          {"reason", result.reason},
          {"reason_code", to_string(result.why)}};
}

namespace {

/// The round trip is that of the last try; all of them took longer.
std::string after_text(double round_trip_us, unsigned tries, const char* word_of_one) {
  const std::string took = round_trip_us > 0 ? app::number(round_trip_us) + " us" : "";
  if (tries <= 1) return took.empty() ? "" : word_of_one + took;
  return " after " + std::to_string(tries) + " tries" + (took.empty() ? "" : ", the last took " + took);
}

}  // namespace

std::string ended_text(const std::string& outcome, double round_trip_us, unsigned tries, const std::string& reason) {
  return "ended '" + outcome + '\'' + after_text(round_trip_us, tries, " after ") +
         (reason.empty() ? "" : ": " + reason);
}

std::string ended_text(const Result& result) {
  return ended_text(to_string(result.outcome), microseconds_of(result), result.tries, result.reason);
}

std::string to_text(const Result& result) {
  std::string text = to_string(result.outcome);
  text += after_text(microseconds_of(result), result.tries, " in ");
  if (!result.reason.empty()) text += ": " + result.reason;
  return text;
}

namespace {

void print_json(const Sends& sends, std::size_t good) {
  nlohmann::json list = nlohmann::json::array();
  for (const Result& result : sends.results) list.push_back(to_json(result));
  const nlohmann::json all{{"asked", sends.asked}, {"sent", sends.sent}, {"delivered", good}, {"results", list}};
  std::cout << all.dump(2) << '\n';
}

void print_text(const Sends& sends) {
  const std::vector<Result>& results = sends.results;
  if (sends.asked == 1 && results.size() == 1) {
    std::cout << to_text(results.front()) << '\n';
    return;
  }
  std::map<std::string, unsigned> ends;
  for (const Result& result : results)
    ++ends[to_string(result.outcome) + (result.reason.empty() ? "" : ": " + result.reason)];
  for (const auto& [end, count] : ends) std::cout << count << ' ' << end << '\n';
  if (sends.sent > results.size()) std::cout << sends.sent - results.size() << " not ended\n";
  if (sends.asked == sends.sent) return;
  std::cout << (sends.problem.empty() ? "interrupted, " : "") << sends.asked - sends.sent << " not sent\n";
}

}  // namespace

int exit_code(const std::vector<Result>& results) {
  if (std::all_of(results.begin(), results.end(), delivered)) return kDone;
  return std::all_of(results.begin(), results.end(), may_be) ? kUnknown : kNotDone;
}

int report(const Sends& sends, bool as_json) {
  const std::vector<Result>& results = sends.results;
  const auto good = static_cast<std::size_t>(std::count_if(results.begin(), results.end(), delivered));
  if (as_json)
    print_json(sends, good);
  else
    print_text(sends);
  if (!sends.problem.empty()) throw HostPortError(sends.problem);
  return sends.asked == results.size() ? exit_code(results) : kNotDone;
}

namespace {

constexpr std::chrono::seconds kGuard{120};  // well above the default time-outs of a send

std::string in_words(std::chrono::nanoseconds time) {
  return std::to_string(std::chrono::floor<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

void ResultWait::check() const {
  const auto waited = std::chrono::steady_clock::now() - begun_;
  if (waited >= kAnswerTime && live::is_frozen(ring_directory(port_.ring()), port_.id()))
    throw gone(port_, "no result within " + in_words(kAnswerTime) + ": its daemon is frozen");
  if (waited < kGuard) return;
  const std::string standing = standing_clock(port_.ring());
  throw gone(port_, "no result within " + in_words(kGuard) + (standing.empty() ? "" : ": " + standing));
}

namespace {

/// Makes a plain number of `text`. @return what is wrong with it; empty: nothing
std::string read_channel(std::string& text) {
  std::vector<std::string> names;
  for (const auto& [name, number] : app::named_channels()) {
    names.push_back(name);
    if (text == name) text = std::to_string(number);
  }
  const std::string wrong = cli::whole(0, 63)(text);
  return wrong.empty() ? wrong : wrong + ", or one of: " + config::join(names);
}

std::string read_channel_of_clients(std::string& text) {
  const std::string wrong = read_channel(text);
  if (!wrong.empty() || text != std::to_string(wire::id_of(wire::Channel::control))) return wrong;
  return "channel 1 (control) belongs to the network controllers; 0 and 2 to 63 are allowed";
}

}  // namespace

CLI::Validator any_channel() { return CLI::Validator(read_channel, ""); }

CLI::Validator channel_of_clients() { return CLI::Validator(read_channel_of_clients, ""); }

namespace {

bool passed_over(char c) { return c == ' ' || c == ':'; }

std::string digits_of(const std::string& text) {
  std::string digits;
  const std::size_t begin = text.rfind("0x", 0) == 0 ? 2 : 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (passed_over(text[i])) continue;
    if (std::isxdigit(static_cast<unsigned char>(text[i])) == 0)
      throw UsageError("--hex: '" + std::string(1, text[i]) + "' at position " + std::to_string(i + 1) +
                       " is not a hexadecimal digit (0-9, a-f)");
    digits += text[i];
  }
  return digits;
}

}  // namespace

std::vector<std::uint8_t> parse_hex(const std::string& text) {
  const std::string digits = digits_of(text);
  if (digits.size() % 2 != 0)
    throw UsageError("--hex: " + std::to_string(digits.size()) +
                     " digits; a byte has two, so their number must be even");
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

namespace {

struct InterruptOptions {
  std::string from, to;
  std::optional<unsigned> factor, input;
  bool force = false, json = false;
};

Sends send_packet(const RingAccess& ring, HostPort& port, const InterruptOptions& options) {
  const std::uint8_t to = ring.destination(options.to);
  const auto send = [&] { return port.interrupt(to, static_cast<std::uint8_t>(*options.factor), options.force); };
  return send_and_explain(port, ring, to, 1, send);
}

Sends pull_input(HostPort& port, unsigned input) {
  return send_all(port, 1, [&] { return port.pull(static_cast<std::uint8_t>(input)); });
}

int run(const Context& context, const InterruptOptions& options) {
  if (options.factor.has_value() == options.input.has_value())
    throw UsageError("interrupt: either FACTOR, with --to NODE, or --input N, of the node --from");
  if (options.factor && options.to.empty()) throw UsageError("interrupt: --to is required: NODE, or all");
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.node(options.from));
  return report(options.input ? pull_input(port, *options.input) : send_packet(ring, port, options), options.json);
}

}  // namespace

void add_interrupt(CLI::App& app, Context& context) {
  auto options = std::make_shared<InterruptOptions>();
  CLI::App* command =
      add_command(app, "interrupt", "Send an interrupt packet, or pull an input of a node",
                  "ringctl interrupt --from head --to left_knee 0",
                  "The packet pulls the pin with the number FACTOR at its destination. --input does what a button "
                  "or a watchdog does that is wired to the node --from.");
  command->add_option("--from", options->from, "Node that sends, or whose input it is, id or name")->required();
  CLI::Option* to = command->add_option("--to", options->to, "Node to interrupt, id or name, or all");
  command
      ->add_option("FACTOR", options->factor, "0 to 7; unless configured otherwise 0 resets, 1 stops, 2 latches clocks")
      ->transform(cli::whole(0, 7));
  CLI::Option* force =
      command->add_flag("--force", options->force, "Send a broadcast that would reset the CPUs of all nodes");
  command->add_option("--input", options->input, "Pull this input instead, 0 to 7; the ring's file says where it leads")
      ->transform(cli::whole(0, 7))
      ->excludes(to)
      ->excludes(force);
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

namespace {

struct Counter {
  const char* name;
  Reason reason;
};
constexpr std::array<Counter, 4> kCounters{{{"refused_cpu_absent", Reason::cpu_absent},
                                            {"refused_no_buffer", Reason::no_buffer},
                                            {"refused_joining", Reason::joining},
                                            {"refused_unwired", Reason::pin_unwired}}};

/// The counter of refusals does not say whether a missing CPU is absent, boots or has failed; the CPU's state does.
Reason refined(Reason reason, const status::NodeRow& row) {
  const std::string& state = row.cpu.state;
  if (reason == Reason::cpu_absent && state == "booting") return Reason::cpu_booting;
  if (reason == Reason::cpu_absent && state == "failed") return Reason::cpu_failed;
  if (reason == Reason::no_buffer && state == "silent") return Reason::cpu_silent;
  return reason;
}

}  // namespace

void RefusalCounters::explain(std::vector<Result>& results, const std::vector<ask::Node>& nodes,
                              const ask::Rows& now) const {
  std::set<Reason> reasons;
  std::string where;
  for (const auto& [id, row] : now) {
    const auto then = before_.find(id);
    if (then == before_.end()) continue;
    for (const Counter& counter : kCounters) {
      if (row.counter(counter.name) <= then->second.counter(counter.name)) continue;
      if (reasons.insert(refined(counter.reason, row)).second)
        where += (where.empty() ? "" : ", ") + name_of(nodes, id);
    }
  }
  if (reasons.size() != 1) return;
  const Reason reason = *reasons.begin();
  for (Result& result : results) {
    if (result.outcome != Outcome::refused) continue;
    result.why = reason;
    result.reason = "at " + where + ": " + sentence(reason) + " (counted there)";
  }
}

}  // namespace limb_ring::ringctl
