// `orchestrator plot RUN...`: the pictures of runs, drawn again by scripts/plot.py, which also knows what each option
// may be. What is not given here is left to the script.

#include "orchestrator/verbs/plot.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/verbs/verb.h"
#include "system/script.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// An option with a value, handed on as it is.
struct PlotOption {
  const char* name;
  const char* value;  ///< its kind; the words that it may be in braces, which shells complete
  const char* meaning;
};

constexpr PlotOption kOptions[] = {
    {"--only", "LIST:{paths,curve,position,velocity,disagreement,acceleration,tracking,error,graph,safety,incidents}",
     "several with commas between (all that apply)"},
    {"--format", "LIST:{png,pdf,svg,pgf,csv}",
     "several with commas between (png); pgf: for LaTeX, in its letters; csv: the numbers that are drawn"},
    {"--size", "SIZE:{screen,column,page}",
     "column, page: 3.5 and 7.16 inches wide, letters of 8 pt, without a title (screen)"},
    {"--style", "FILE", "a style sheet of matplotlib (NAME.mplstyle), or the name of one that matplotlib has"},
    {"--agents", "LIST", "draw these agents only: 1,4 or 1-3 (all)"},
    {"--from-s", "X", "draw what was from this time on, in seconds (the start)"},
    {"--to-s", "Y", "draw what was up to this time, in seconds (the end)"},
    {"--out", "FOLDER", "write the pictures there, not into the run folder"},
    {"--animate", "FILE", "draw the run as a film instead: FILE.mp4 or FILE.gif (needs ffmpeg)"},
    {"--pace", "X", "with --animate: simulated seconds per second (1, or more if the film would last over 20 s)"},
};

struct PlotArgs {
  std::vector<std::string> runs;
  std::vector<std::string> values = std::vector<std::string>(std::size(kOptions));
  std::vector<std::string> labels;
  bool show = false, overlay = false;
};

std::vector<std::string> Words(const CLI::App& command, const PlotArgs& args) {
  std::vector<std::string> words;
  for (const std::string& run : args.runs) words.push_back(AsWord(run));
  for (std::size_t k = 0; k < std::size(kOptions); ++k)
    if (command.count(kOptions[k].name) > 0) words.push_back(std::string(kOptions[k].name) + "=" + args.values[k]);
  for (const std::string& label : args.labels) words.push_back("--label=" + label);
  if (args.overlay) words.emplace_back("--overlay");
  if (args.show) words.emplace_back("--show");
  return words;
}

}  // namespace

int PlotRun(const fs::path& folder, bool show, StopSignal& stop) {
  std::vector<std::string> arguments{AsWord(folder)};
  if (show) arguments.push_back("--show");
  return RunScript("plot.py", arguments, stop);
}

std::function<int()> SetUpPlot(CLI::App& command) {
  auto args = std::make_shared<PlotArgs>();
  command.add_option("run", args->runs, "run folders")->required()->type_name("RUN");
  command.add_flag("--overlay", args->overlay, "draw several runs into the same pictures, in the folder --out");
  for (std::size_t k = 0; k < std::size(kOptions); ++k)
    command.add_option(kOptions[k].name, args->values[k], kOptions[k].meaning)->type_name(kOptions[k].value);
  command
      .add_option(
          "--label", args->labels,
          "write TEXT where the pictures have the text KEY, or PICTURE.KEY, in one of them; may be given several times")
      ->type_name("KEY=TEXT")
      ->allow_extra_args(false);
  command.add_flag("--show", args->show, "open windows too");
  return [args, &command] {
    for (std::string& run : args->runs) {
      run = FindRun(run);
      if (!fs::is_directory(run)) throw ConfigError({run + ": expected a run folder"});
    }
    StopSignal stop;
    return RunScript("plot.py", Words(command, *args), stop);
  };
}

}  // namespace mascot
