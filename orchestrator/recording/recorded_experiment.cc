#include "orchestrator/recording/recorded_experiment.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"
#include "orchestrator/recording/attached_experiment.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/recording.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// The first line in which two resolved experiments differ, with its table: "[law] p_gain = 0.3, the recording's says
/// p_gain = 0.2". Empty: none.
std::string FirstChange(const std::string& ours, const std::string& recorded) {
  std::istringstream a(ours), b(recorded);
  std::string table, line_a, line_b;
  for (;;) {
    const bool more_a = static_cast<bool>(std::getline(a, line_a)), more_b = static_cast<bool>(std::getline(b, line_b));
    if (!more_a && !more_b) return "";
    if (more_a != more_b || line_a != line_b)
      return fmt::format("{}{}, the recording's says {}", table.empty() ? "" : table + " ",
                         more_a ? line_a : "nothing more", more_b ? line_b : "nothing more");
    if (line_a.starts_with("[")) table = line_a;
  }
}

}  // namespace

RecordedExperiment ReadRecordedExperiment(const std::string& run, const std::string& file, const McapContents& contents,
                                          const ReadExperimentText& read) {
  Experiment recorded = read(contents.attachments.at(kConfigFile), file + " (config.toml)");
  const fs::path folder = FindRun(run), path = folder / "config.toml";
  if (!fs::is_directory(folder) || !fs::exists(path)) return {.experiment = std::move(recorded), .change = {}};
  Experiment ours = read(ReadRegularFile(path.string()), path.string());
  if (LossOf(contents).empty()) {
    std::string change = FirstChange(WithoutDelivery(ours), WithoutDelivery(recorded));
    ours.network.ros_view = false;
    return {.experiment = std::move(ours), .change = std::move(change)};
  }
  std::string change = FirstChange(WithoutEvents(ours), WithoutEvents(recorded));
  const std::vector<Override> delivery = DeliveryOverrides(ours);
  return {.experiment = LoadExperiment(Section::FromText(recorded.resolved, file, delivery), recorded.run.name,
                                       /*checked=*/true),
          .change = std::move(change)};
}

}  // namespace mascot
