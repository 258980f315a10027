// `orchestrator export RUN --format npz|csv|mat`: writes a recording as arrays for other programs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/recording/exporters.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct ExportArgs {
  std::string run, format;
  std::optional<std::string> out;
  bool force = false;
};

/// Path of the exported file: beside the recording, or given by --out. Throws ConfigError if it cannot be written
/// there, or if it exists and --force is not given.
fs::path Target(const ExportArgs& args, const std::string& recording) {
  const std::string name = "states." + args.format;
  fs::path path = args.out ? fs::path(*args.out) : fs::path(recording).replace_filename(name);
  const std::string label = args.out ? "--out " : "";
  if (args.out && fs::is_directory(path)) path /= name;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!path.has_filename() || !fs::is_directory(folder))
    throw ConfigError({label + path.string() + ": expected a file in a folder that exists"});
  if (fs::is_directory(path)) throw ConfigError({label + path.string() + ": expected a file, got a folder"});
  if (fs::exists(path) && fs::equivalent(path, recording))
    throw ConfigError({label + path.string() + ": expected another file than the recording"});
  if (fs::exists(path) && !args.force)
    throw ConfigError({label + path.string() + ": expected a new file, got one that exists (--force replaces it)"});
  return path;
}

int Export(const ExportArgs& args) {
  const Recording recording(args.run);
  const fs::path target = Target(args, recording.path());
  std::ranges::find(Exporters(), args.format, &Exporter::format)->write(recording, target.string());
  if (!recording.damage().empty())
    std::cerr << "warning: " << recording.path() << ": " << recording.damage() << "; exported what comes before\n";
  if (!recording.has_commands())
    std::cerr << "warning: " << recording.path()
              << ": record.topics left out commands; exported without acceleration_command, actuator\n";
  std::cout << target.string() << ": " << recording.ticks() << " ticks, " << recording.agents() << " agents"
            << std::endl;
  return 0;
}

}  // namespace

std::function<int()> SetUpExport(CLI::App& command) {
  auto args = std::make_shared<ExportArgs>();
  std::vector<std::string> formats;
  for (const Exporter& exporter : Exporters()) formats.emplace_back(exporter.format);
  command.add_option("run", args->run, "a run folder or an .mcap file")->required()->type_name("RUN");
  command
      .add_option("--format", args->format,
                  "npz: NumPy arrays, the same as in the run's own states.npz\n"
                  "csv: one table, a line per tick and agent: t, id, position_x, ...\n"
                  "mat: MATLAB variables: position(k, i, axis), ..., and the experiment")
      ->required()
      ->check(CLI::IsMember(formats));
  command
      .add_option("--out", args->out, "file, or folder to put it into (default: beside the recording, states.FORMAT)")
      ->type_name("FILE_OR_DIR");
  command.add_flag("--force", args->force, "replace a file that exists");
  command.footer(
      "Only the recording is read; what was cut short is exported up to the cut.\n"
      "docs/recording.md says what the arrays hold, and their units.");
  return [args] { return Export(*args); };
}

}  // namespace mascot
