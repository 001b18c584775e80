#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/ring_clock.h"
#include "cli/values.h"

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

void print(const std::string& ring, const json& state) {
  char now[32];
  std::snprintf(now, sizeof now, "%.9f", static_cast<double>(state.at("now_ns").get<std::int64_t>()) / 1e9);
  std::cout << "ring " << ring << (state.at("paused").get<bool>() ? " stands at " : " goes on from ") << now
            << " s, pace " << pace_text(state.at("pace")) << '\n';
}

/// Asks any node of the ring, which has one clock.
int ask_clock(const Context& context, const ClockOptions& options, json request, std::chrono::milliseconds timeout) {
  const RingAccess ring = RingAccess::open(choose_ring(options.ring.empty() ? context.ring : options.ring));
  HostPort port = ring.connect(ring.source(""));
  const json state = ask(port, request, timeout);
  if (options.json)
    std::cout << state.dump(2) << '\n';
  else
    print(ring.ring(), state);
  return kDone;
}

using MakeRequest = std::function<json(const ClockOptions&)>;

CLI::App* add(CLI::App& app, Context& context, const char* name, const char* description,
              const std::shared_ptr<ClockOptions>& options, const MakeRequest& request,
              std::chrono::milliseconds timeout = kAnswerTime) {
  CLI::App* command = add_command(app, name, description);
  add_json(*command, options->json);
  command->callback([&context, options, request, timeout] {
    context.action = [&context, options, request, timeout] {
      return ask_clock(context, *options, request(*options), timeout);
    };
  });
  return command;
}

void add_ring(CLI::App& command, ClockOptions& options) {
  command.add_option("RING", options.ring, "Name of the ring; default: as --ring");
}

json pace_request(const ClockOptions& options) {
  return {{"do", "pace"}, {"pace", std::isinf(options.pace) ? json("max") : json(options.pace)}};
}

json step_request(const ClockOptions& options) {
  return {{"do", "step"}, {"time_ns", std::llround(options.step_s * 1e9)}};
}

}  // namespace

void add_clock(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ClockOptions>();
  CLI::App* pace =
      add(app, context, "pace", "Change how fast the time of a virtual ring goes on", options, pace_request);
  pace->add_option("PACE", options->pace, "Its time per real time, 0.001 to 1000, or max: as fast as the programs are")
      ->transform(cli::pace())
      ->required();
  add_ring(*pace, *options);
  CLI::App* pause = add(app, context, "pause",
                        "Let the time of a virtual ring stand; ringctl and other tools go on, and what they send waits",
                        options, [](const ClockOptions&) {
                          return json{{"do", "pause"}};
                        });
  add_ring(*pause, *options);
  CLI::App* step = add(app, context, "step", "Let the time of a virtual ring go on by so much, and stand then", options,
                       step_request, kStepWithin);
  step->add_option("TIME", options->step_s, "By its own clock, such as 1ms; a plain number is seconds; 1ns to 1e6 s")
      ->transform(cli::seconds(1e-9, 1e6))
      ->required();
  add_ring(*step, *options);
  CLI::App* run = add(app, context, "run", "Let the time of a virtual ring go on after 'pause' or 'step'", options,
                      [](const ClockOptions&) {
                        return json{{"do", "run"}};
                      });
  add_ring(*run, *options);
}

}  // namespace limb_ring::ringctl
