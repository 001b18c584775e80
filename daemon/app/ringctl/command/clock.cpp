#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/ring_clock.h"
#include "cli/values.h"
#include "process/signal_wait.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

/// Of real time: a step takes as long as the machine and the programs do.
constexpr std::chrono::milliseconds kStepWithin{600'000};

struct ClockOptions {
  std::string ring;
  double pace = 1;
  double step_s = 0;
  bool json = false;
};

std::string seconds_of(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9f s", static_cast<double>(ns) / 1e9);
  return text;
}

std::int64_t now_of(const json& state) { return state.at("now_ns").get<std::int64_t>(); }

void print(const std::string& ring, const json& state, bool as_json) {
  if (as_json)
    std::cout << state.dump(2) << '\n';
  else
    std::cout << "ring " << ring << (state.at("paused").get<bool>() ? " stands at " : " goes on from ")
              << seconds_of(now_of(state)) << ", pace " << pace_text(state.at("pace")) << '\n';
}

/// Any node of the ring, which has one clock.
HostPort clock_of(const Context& context, const ClockOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(options.ring.empty() ? context.ring : options.ring));
  return ring.connect(ring.source(""));
}

int ask_clock(const Context& context, const ClockOptions& options, const json& request) {
  HostPort port = clock_of(context, options);
  print(port.ring(), ask(port, request, kAnswerTime), options.json);
  return kDone;
}

struct StepInterrupted {};

// It is paused first, so that the instant is known until which it goes; and where somebody asks it to end (Ctrl-C).
int step_clock(const Context& context, const ClockOptions& options) {
  HostPort port = clock_of(context, options);
  const process::SignalWait signals;
  const std::int64_t step = std::llround(options.step_s * 1e9);
  const std::string until = seconds_of(now_of(ask(port, {{"do", "pause"}}, kAnswerTime)) + step);
  Progress progress;
  const auto tick = [&] {
    if (signals.asked_to_end(std::chrono::milliseconds(0))) throw StepInterrupted();
    progress.tell("waiting until " + until + " of the ring's time");
  };
  try {
    print(port.ring(), ask(port, {{"do", "step"}, {"time_ns", step}}, kStepWithin, tick), options.json);
    return kDone;
  } catch (const StepInterrupted&) {
    print(port.ring(), ask(port, {{"do", "pause"}}, kAnswerTime), options.json);
    throw NotDone("interrupted before " + until);
  }
}

using Act = std::function<int(const Context&, const ClockOptions&)>;

CLI::App* add(CLI::App& app, Context& context, const char* name, const char* description,
              const std::shared_ptr<ClockOptions>& options, const Act& act) {
  CLI::App* command = add_command(app, name, description);
  add_json(*command, options->json);
  command->callback(
      [&context, options, act] { context.action = [&context, options, act] { return act(context, *options); }; });
  return command;
}

/// Asks for that one word.
Act asking(const char* what) {
  return [what](const Context& context, const ClockOptions& options) {
    return ask_clock(context, options, {{"do", what}});
  };
}

void add_ring(CLI::App& command, ClockOptions& options) {
  command.add_option("RING", options.ring, "Name of the ring; default: as --ring");
}

int set_pace(const Context& context, const ClockOptions& options) {
  return ask_clock(context, options,
                   {{"do", "pace"}, {"pace", std::isinf(options.pace) ? json("max") : json(options.pace)}});
}

}  // namespace

void add_clock(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ClockOptions>();
  CLI::App* pace = add(app, context, "pace", "Change how fast the time of a virtual ring goes on", options, set_pace);
  pace->add_option("PACE", options->pace, "Its time per real time, 0.001 to 1000, or max: as fast as the programs are")
      ->transform(cli::pace())
      ->required();
  add_ring(*pace, *options);
  CLI::App* pause = add(app, context, "pause",
                        "Let the time of a virtual ring stand; ringctl and other tools go on, and what they send waits",
                        options, asking("pause"));
  add_ring(*pause, *options);
  CLI::App* step =
      add(app, context, "step", "Let the time of a virtual ring go on by so much, and stand then", options, step_clock);
  step->add_option("TIME", options->step_s, "By its own clock, such as 1ms; a plain number is seconds; 1ns to 1e6 s")
      ->transform(cli::seconds(1e-9, 1e6))
      ->required();
  add_ring(*step, *options);
  CLI::App* run =
      add(app, context, "run", "Let the time of a virtual ring go on after 'pause' or 'step'", options, asking("run"));
  add_ring(*run, *options);
}

}  // namespace limb_ring::ringctl
