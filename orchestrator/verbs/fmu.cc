// `orchestrator fmu CONFIG --out FILE.fmu`: a team as an FMU, which tools that know FMI step (docs/fmu.md).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/fmu/team_fmu.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/verb.h"
#include "system/children.h"
#include "system/script.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct FmuArgs {
  ConfigArgs config;
  std::string out;
  int fmi = 2;
  std::vector<int> ports;
  bool json = false;
};

/// The compiled team_fmu.c: installed, or in the build folder.
fs::path FindLibrary() {
  for (const char* place : {"../lib/mascot/team_fmu.so", "team_fmu.so"})
    if (fs::exists(ProgramFolder() / place)) return ProgramFolder() / place;
  throw std::runtime_error("team_fmu.so is missing: neither beside this program nor in ../lib/mascot");
}

void RequireOut(const fs::path& out) {
  const fs::path folder = out.has_parent_path() ? out.parent_path() : ".";
  if (out.extension() != ".fmu" || !out.has_stem())
    throw ConfigError({fmt::format("--out {}: expected the name of a file that ends in .fmu", out.string())});
  if (!fs::is_directory(folder) || fs::is_directory(out))
    throw ConfigError({fmt::format("--out {}: expected a file in a folder that exists", out.string())});
}

int MakeFmu(FmuArgs& args) {
  RequireOut(args.out);
  const Experiment experiment = args.config.Load();
  TeamService service({.text = experiment.resolved, .path = args.config.Name(), .overrides = {}, .ports = args.ports});
  const FmuTeam team = FmuTeamOf(service, args.ports);
  const FmiVersion version = args.fmi == 2 ? FmiVersion::k2 : FmiVersion::k3;
  const FmuParts parts{.experiment = experiment.resolved,
                       .binary = ReadRegularFile(FindLibrary().string()),
                       .source = ReadRegularFile(FindShared("team_fmu.c", "orchestrator/fmu").string()),
                       .program = (ProgramFolder() / "orchestrator").string()};
  std::string bytes;
  try {
    bytes = TeamFmu(version, team, parts);
  } catch (const std::invalid_argument& error) {
    throw ConfigError({error.what()});
  }
  WriteWhole(args.out, bytes);
  const auto inputs = std::ranges::count(team.variables, FmuVariable::Causality::kInput, &FmuVariable::causality);
  const auto outputs = std::ranges::count(team.variables, FmuVariable::Causality::kOutput, &FmuVariable::causality);
  const auto tunable = std::ranges::count(team.variables, true, &FmuVariable::tunable);
  if (args.json)
    std::cout << CompactJson({{"fmu", args.out},
                              {"fmi", args.fmi},
                              {"inputs", inputs},
                              {"outputs", outputs},
                              {"tunable_parameters", tunable}})
              << "\n";
  else
    std::cout << fmt::format(
        "{}: {}, {} agents, as an FMU of FMI {}.0 with {} inputs, {} outputs and {} tunable parameters\n", args.out,
        team.name, team.agents, args.fmi, inputs, outputs, tunable);
  return kExitDone;
}

}  // namespace

std::function<int()> SetUpFmu(CLI::App& command) {
  auto args = std::make_shared<FmuArgs>();
  args->config.AddTo(command);
  command.add_option("--out", args->out, "the FMU to write; a file of this name is replaced")
      ->type_name("FILE.fmu")
      ->required();
  command.add_option("--fmi", args->fmi, "version of FMI: 2 (default) or 3")
      ->check(CLI::IsMember({2, 3}))
      ->type_name("2|3");
  command.add_option("--ports", args->ports, "agents that take actions in the place of their laws: 1,2")
      ->delimiter(',')
      ->type_name("AGENTS");
  command.add_flag("--json", args->json, "print what was made as JSON on stdout");
  command.footer("docs/fmu.md says what its variables are, and how tools use it.");
  return [args] { return MakeFmu(*args); };
}

}  // namespace mascot
