// The bare loop, a baseline for the in-process engine: one full Bullet step for each physics step, and one call of the
// low-level controller for each control period; no law, graph and recording.
//   bare_loop AGENTS SECONDS     prints one line of JSON: agent-steps per second
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/low_level.h"
#include "physics_server/world.h"

namespace {

using namespace mascot;
using WallClock = std::chrono::steady_clock;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bare_loop AGENTS SECONDS\n");
    return 2;
  }
  const int agents = std::atoi(argv[1]);
  const std::string top = std::to_string(2 + agents);
  const std::string text = "[run]\nduration_s = 1000.0\n[agents]\ncount = " + std::string(argv[1]) +
                           "\nrandom = { min_m = [-99, -99, 1], max_m = [99, 99, " + top + "] }\n";
  const Experiment experiment = LoadExperiment(Section::FromText(text, "bench.toml"), "bench");
  World world(experiment, World::LookForContacts::kAlways);
  LowLevel low_level(experiment, {1, agents});
  std::vector<Motion> motions(static_cast<std::size_t>(agents));
  std::vector<Controller::Input> inputs;
  for (const Motion& motion : motions) inputs.push_back({&motion, Eigen::Vector3d::Zero()});
  std::vector<Command> answers(motions.size());
  std::vector<Actuation> commands(static_cast<std::size_t>(agents));
  const auto start = WallClock::now();
  const std::chrono::duration<double> limit(std::atof(argv[2]));
  while (WallClock::now() - start < limit) {
    for (int id = 1; id <= agents; ++id) motions[static_cast<std::size_t>(id - 1)] = world.State(id);
    low_level.Actuate(inputs, answers);
    for (std::size_t i = 0; i < commands.size(); ++i) commands[i] = answers[i].actuator;
    world.Step(commands);
  }
  const std::chrono::duration<double> wall = WallClock::now() - start;
  const double steps = static_cast<double>(world.tick()) * experiment.steps_per_tick() * agents;
  std::printf("{\"agent_steps_per_s\": %.0f}\n", steps / wall.count());
  return 0;
}
