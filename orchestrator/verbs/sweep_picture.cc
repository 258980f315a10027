#include "orchestrator/verbs/sweep_picture.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <sstream>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/plan/labels.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/sweeping/table/outcomes.h"
#include "orchestrator/sweeping/table/table.h"
#include "orchestrator/verbs/one_of.h"
#include "system/script.h"

namespace mascot {
namespace {

/// Splits a list with commas between.
std::vector<std::string> NamesIn(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream text(list + ",");
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names;
}

/// Returns what is wrong with a list of formats; "": nothing.
std::string MistakeInFormats(const std::string& list) {
  static const std::vector<std::string> kFormats{"png", "pdf", "svg"};
  for (const std::string& name : NamesIn(list))
    if (std::ranges::find(kFormats, name) == kFormats.end())
      return "expected one or more of png, pdf, svg, with commas between, got '" + name + "'";
  return "";
}

}  // namespace

void PictureFiles::SetUp(CLI::App& command) {
  command.add_option("--format", format, "formats of the picture: png, pdf, svg; several with commas between (png)")
      ->check(CLI::Validator(MistakeInFormats, ""))
      ->type_name("LIST");
  command.add_option("--size", size, "size of the picture: screen, column or page, as of orchestrator plot (screen)")
      ->check(OneOf({"screen", "column", "page"}))
      ->type_name("SIZE");
  command.add_flag("--no-plot", none, "draw no picture");
}

void PictureFiles::PrintNames(const std::string& out) const {
  for (const std::string& one : NamesIn(format))
    std::cout << "picture: " << FileBeside(out, "." + one).string() << "\n";
}

void SweepPicture::SetUp(CLI::App& command) {
  command.add_option("--plot", metric, "the column that the picture shows")->type_name("COLUMN");
  files.SetUp(command);
}

bool SweepPicture::IsDrawable(const SweepPlan& plan) const {
  constexpr std::size_t kMaxKeys = 2;
  if (metric && plan.size() < 2) throw ConfigError({"--plot: expected at least 2 runs to draw, got 1"});
  if (files.none || plan.size() < 2) return false;
  if (plan.varied().size() > kMaxKeys && metric)
    throw ConfigError({"--plot: expected at most 2 keys of several values to draw over, got " +
                       std::to_string(plan.varied().size())});
  return plan.varied().size() <= kMaxKeys;
}

int SweepPicture::Draw(const std::string& out, const SweepPlan& plan, const SweepIdentity& identity,
                       StopSignal& stop) const {
  const std::string column = metric.value_or(identity.own.empty() ? kUsualMetric : identity.own.front().name);
  const auto own = std::ranges::find(identity.own, column, &PythonMetric::name);
  std::vector<std::string> words{AsWord(out), AsWord(StatisticsBeside(out)), AsWord(FileBeside(out, ".png")), column};
  words.insert(words.end(), plan.varied().begin(), plan.varied().end());
  words.insert(words.end(),
               {"--label", column + "=" + (own != identity.own.end() ? LabelOfMetric(*own) : LabelOfColumn(column))});
  for (const std::string& key : plan.varied())
    words.insert(words.end(), {"--label", key + "=" + LabelOfKey(key, identity.law_names)});
  if (IsTimeOfEvent(column)) words.emplace_back("--time");
  words.insert(words.end(), {"--format", files.format, "--size", files.size});
  return RunScript("plot_sweep.py", words, stop);
}

}  // namespace mascot
