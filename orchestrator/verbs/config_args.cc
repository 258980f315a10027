#include "orchestrator/verbs/config_args.h"

#include <CLI/CLI.hpp>

#include "agent/laws/laws.h"
#include "experiment/toml/input.h"

namespace mascot {

Override ParseOverride(const std::string& set) {
  const auto equals = set.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == set.size()) {
    throw ConfigError({"--set: expected key=value (such as law.p_gain=0.5), got '" + set + "'"});
  }
  return {set.substr(0, equals), set.substr(equals + 1)};
}

void ConfigArgs::AddTo(CLI::App& command) {
  command.add_option("config", path, "experiment file (TOML); -: standard input")->required()->type_name("CONFIG");
  command.add_option("--set", sets, "replaces or adds a key: --set law.p_gain=0.5")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);  // otherwise it would take CONFIG as a second value
  command.add_option("--duration-s", duration_s, "in place of run.duration_s, in simulated seconds")->type_name("S");
  command.add_option("--seed", seed, "in place of run.seed")->type_name("N");
}

const std::string& ConfigArgs::Text() {
  if (!text_) text_ = ReadInput(path);
  return *text_;
}

std::string ConfigArgs::Name() const { return NameOfInput(path); }

std::vector<Override> ConfigArgs::Overrides() const {
  std::vector<Override> all;
  for (const std::string& set : sets) all.push_back(ParseOverride(set));
  if (duration_s) all.push_back({"run.duration_s", *duration_s, "--duration-s " + *duration_s});
  if (seed) all.push_back({"run.seed", *seed, "--seed " + *seed});
  return all;
}

Experiment ConfigArgs::Load(UserCode user_code) { return LoadExperiment(Text(), Name(), Overrides(), user_code); }

}  // namespace mascot
