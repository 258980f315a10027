#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/process/node.h"
#include "bus/foreign_settings.h"
#include "bus/process_main.h"
#include "bus/scheduling.h"
#include "experiment/processes.h"
#include "system/failure.h"
#include "system/nursery.h"
#include "system/standard_streams.h"

namespace {

/// Index of this process among those of the run, for ApplyScheduling(); the server's is 0.
int Place(const mascot::Experiment& experiment, mascot::AgentRange agents) {
  const auto processes = mascot::AgentProcesses(experiment);
  return 1 + static_cast<int>(std::ranges::find(processes, agents) - processes.begin());
}

/// Reads the experiment. Throws std::runtime_error if it has fewer agents than this process has, or if one of these
/// flies a law of a user and `no_code` is set.
mascot::Experiment ReadFor(mascot::AgentRange agents, bool no_code, const mascot_msgs::msg::Experiment& message) {
  const auto document = mascot::Section::FromText(message.toml(), message.name());
  mascot::Experiment experiment = mascot::LoadExperiment(
      document, message.name(), /*checked=*/true, no_code ? mascot::UserCode::kNeverRuns : mascot::UserCode::kMayRun);
  if (agents.last > experiment.size())
    throw std::runtime_error("--id " + std::to_string(agents.last) + ": the experiment has only agents 1 to " +
                             std::to_string(experiment.size()));
  for (int id = agents.first; no_code && id <= agents.last; ++id)
    if (const mascot::LawEntry& law = mascot::EntryOf(experiment.agent(id).law); law.is_of_user)
      throw std::runtime_error("--no-code: agent " + std::to_string(id) + " flies law '" + std::string(law.name) +
                               "', which runs code of the experiment's author");
  return experiment;
}

void SayWhoIsHeard(const mascot::Experiment& experiment, mascot::AgentRange agents) {
  for (int id = agents.first; id <= agents.last; ++id) {
    std::string heard;
    for (const auto& neighbour : experiment.graph.HeardBy(id)) heard += " " + std::to_string(neighbour.id);
    std::cerr << (agents.size() > 1 ? mascot::AgentName(id) + " " : "") << "hears"
              << (heard.empty() ? " nobody" : heard) << std::endl;
  }
}

class AgentRole : public mascot::Role {
 public:
  AgentRole(mascot::Domain& domain, mascot::Lifecycle& lifecycle, const mascot_msgs::msg::Experiment& message,
            mascot::AgentRange agents, bool no_code)
      : agents_(agents),
        experiment_(ReadFor(agents, no_code, message)),
        node_(domain, lifecycle, experiment_, agents, message.events()) {}

  void Run() override {
    SayWhoIsHeard(experiment_, agents_);
    mascot::ApplyScheduling(experiment_, Place(experiment_, agents_));  // after all threads have started
    node_.Run();
  }

 private:
  const mascot::AgentRange agents_;
  const mascot::Experiment experiment_;
  mascot::Node node_;
};

}  // namespace

int main(int argc, char** argv) {
  mascot::SayWhatIsUncaught();
  std::vector<std::string> words = mascot::WordsOrCopies(argc, argv);  // before anything else: copies have all of it
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  mascot::OpenStandardStreams();
  mascot::FitStandardStreams();
  mascot::ForgetForeignSettings();
  mascot::StopSignal stop;  // before anything that starts threads: they must inherit the mask
  CLI::App app("MASCOT agent: hears its neighbours, runs its law and its low-level stack, commands its actuators.");
  mascot::ProcessArgs args(mascot::ProcessArgs::Kind::kAgents);
  return mascot::ProcessMain(app, static_cast<int>(words.size()), arguments.data(), args, stop,
                             [&args](auto& domain, auto& lifecycle, const auto& message) {
                               return std::make_unique<AgentRole>(domain, lifecycle, message, args.agents,
                                                                  args.no_code);
                             });
}
