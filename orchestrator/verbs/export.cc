// `orchestrator export RUN --format npz|csv|mat`: writes a recording as arrays for other programs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/recording/exporters.h"
#include "orchestrator/verbs/new_file.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

struct ExportArgs {
  std::string run, format;
  std::optional<std::string> out;
  bool force = false;
};

int Export(const ExportArgs& args) {
  const Recording recording(args.run);
  const std::string target = NewFile(args.out, "states." + args.format, recording.path(), args.force).string();
  std::ranges::find(Exporters(), args.format, &Exporter::format)->write(recording, target);
  if (!recording.loss().empty())
    std::cerr << "warning: " << recording.path() << ": " << recording.loss() << "; exported what comes before\n";
  if (!recording.has_commands())
    std::cerr << "warning: " << recording.path()
              << ": record.topics left out commands; exported without acceleration_command, actuator, flags\n";
  std::cout << target << ": " << recording.ticks().rows() << (recording.is_sparse() ? " rows, " : " ticks, ")
            << recording.agents() << " agents" << std::endl;
  return recording.loss().empty() ? kExitDone : kExitIncomplete;
}

}  // namespace

std::function<int()> SetUpExport(CLI::App& command) {
  auto args = std::make_shared<ExportArgs>();
  std::vector<std::string> formats;
  for (const Exporter& exporter : Exporters()) formats.emplace_back(exporter.format);
  command.add_option("run", args->run, "a run folder, a folder of runs or 'latest' for the newest, or an .mcap file")
      ->required()
      ->type_name("RUN");
  command
      .add_option("--format", args->format,
                  "npz: NumPy arrays, the same as in the run's own states.npz\n"
                  "csv: one table, a line per tick and agent: t, id, position_x, ...\n"
                  "mat: MATLAB variables: position(k, i, axis), ..., and the experiment")
      ->required()
      ->check(OneOf(formats));
  command
      .add_option("--out", args->out, "file, or folder to put it into (default: beside the recording, states.FORMAT)")
      ->type_name("FILE_OR_DIR");
  command.add_flag("--force", args->force, "replace a file that exists");
  command.footer(
      "Only the recording is read; what was cut short is exported up to the cut, with exit code 3.\n"
      "docs/recording.md says what the arrays hold, and their units.");
  return [args] { return Export(*args); };
}

}  // namespace mascot
