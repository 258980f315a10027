#include "orchestrator/recording/recording.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "bus/wire.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"
#include "idl/topics.h"
#include "orchestrator/recording/row_assembler.h"

namespace mascot {

namespace fs = std::filesystem;

namespace {

constexpr const char* kConfig = "config.toml";

}  // namespace

bool IsARun(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / kConfig, error)) return true;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".mcap") return true;
  return false;
}

fs::file_time_type WrittenAt(const fs::path& folder) {
  std::error_code error;
  const fs::file_time_type config = fs::last_write_time(folder / kConfig, error);
  return error ? fs::last_write_time(folder, error) : config;
}

std::vector<fs::path> RunsIn(const fs::path& folder) {
  if (IsARun(folder)) return {folder};
  std::vector<fs::path> runs;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
       !error && entry != end; entry.increment(error)) {
    if (std::error_code unknown; !entry->is_directory(unknown)) continue;
    const bool is_run = IsARun(entry->path());
    if (is_run || entry.depth() == 1) entry.disable_recursion_pending();
    if (is_run) runs.push_back(entry->path());
  }
  return runs;
}

std::string FindRun(const std::string& run) {
  const fs::path named = run == "latest" && !fs::exists(run) ? "runs" : run;
  if (named != run && !fs::is_directory(named))
    throw ConfigError({run + ": expected the newest run in the folder runs, which is not here"});
  if (!fs::is_directory(named)) return named.string();
  const std::vector<fs::path> runs = RunsIn(named);
  const auto newest = std::ranges::max_element(runs, {}, WrittenAt);
  return (newest == runs.end() ? named : *newest).string();
}

std::string FindRecording(const std::string& named) {
  const std::string run = FindRun(named);
  if (!fs::is_directory(run)) return run;
  const fs::path usual = fs::path(run) / "run.mcap";
  if (fs::exists(usual)) return usual.string();
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(run))
    if (entry.path().extension() == ".mcap") found.push_back(entry.path().string());
  if (found.size() != 1)
    throw ConfigError({run + ": expected a run folder with one .mcap file, got " + std::to_string(found.size())});
  return found.front();
}

namespace {

/// What config.toml would say, had the recording not been cut: the experiment with the events that it still holds.
std::string ConfigUpToTheCut(const std::string& path, const McapContents& contents) {
  Section section = Section::FromText(contents.attachments.at(kExperimentFile), path + " (" + kExperimentFile + ")");
  section.Use(ExperimentKeys());
  const int rate_hz = static_cast<int>(section.Child("control").Integer("rate_hz"));
  section.ThrowIfWrong();
  std::string config = contents.attachments.at(kExperimentFile);
  ReadMcap(path, [&](const McapContents::Message& message) {
    if (contents.channels.at(message.channel).topic != Topic::Event().Name()) return;
    mascot_msgs::msg::Event event;
    Deserialize(message.data, event);
    if (StandsElsewhere(event.toml())) return;
    config = WithEvent(std::move(config), static_cast<std::int64_t>(event.tick()), rate_hz, event.toml());
  });
  return config;
}

}  // namespace

McapContents WithConfig(McapContents contents, const std::string& path) {
  if (contents.attachments.contains(kExperimentFile) && !contents.attachments.contains(kConfigFile)) {
    contents.attachments[kConfigFile] = ConfigUpToTheCut(path, contents);
    contents.media_types[kConfigFile] = kToml;
  }
  return contents;
}

McapContents ReadRecording(const std::string& path) try {
  return WithConfig(ReadMcap(path), path);
} catch (const std::exception& error) {
  throw ConfigError({error.what()});
}

RowsOf RowsIn(const McapContents& contents, const std::string& path) {
  RowsOf rows{.plan = PlanOf(contents, path), .ticks = {0, 1}};
  std::erase_if(rows.plan.topics, [](const Topic& topic) {
    return topic.kind != TopicKind::kState && topic.kind != TopicKind::kCommand;
  });
  const auto is_recorded = [&](const Topic& topic) {
    return std::ranges::find(rows.plan.topics, topic) != rows.plan.topics.end();
  };
  rows.has_commands = true;
  for (int id = 1; id <= rows.plan.agents; ++id) {
    if (!is_recorded(Topic::State(id)))
      throw std::runtime_error(path + ": holds no " + Topic::State(id).Name() + ": record.topics left it out");
    rows.has_commands = rows.has_commands && is_recorded(Topic::Command(id));
  }
  const Proof proof = Prove(contents, rows.plan);
  if (!proof.gap.empty()) throw std::runtime_error(path + ": " + proof.gap);
  // A damaged index may claim any number of messages.
  const std::uint64_t ticks = std::min(proof.ticks.value_or(0), rows.plan.ticks);
  rows.ticks = RecordedTicks(static_cast<std::int64_t>(ticks), rows.plan.ticks_per_row);
  const std::string loss = LossOf(contents);
  if (ticks == 0) throw std::runtime_error(path + ": holds no whole tick" + (loss.empty() ? "" : ": " + loss));
  return rows;
}

Recording::Recording(const std::string& run)
    : path_(FindRecording(run)), contents_(ReadRecording(path_)), rows_(RowsIn(contents_, path_)) {}

void Recording::ForEachRow(const std::function<void(const Row&)>& on_row) const {
  const RecordingPlan& plan = rows_.plan;
  std::vector<int> commanding;
  for (int id = 1; id <= plan.agents; ++id)
    if (has_commands() && plan.IsInEveryRow(Topic::Command(id))) commanding.push_back(id);
  RowAssembler assembler({path_, plan.agents, plan.rate_hz, ticks(), std::move(commanding)}, on_row);
  for (const auto& [id, channel] : contents_.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (!topic || topic->agent < 1 || topic->agent > plan.agents) continue;
    if (topic->kind == TopicKind::kState || (topic->kind == TopicKind::kCommand && has_commands()))
      assembler.AddChannel(id, *topic);
  }
  ReadMcap(path_, [&assembler](const McapContents::Message& message) { assembler.Take(message); });
  assembler.Finish();
}

}  // namespace mascot
