#include "orchestrator/recording/recording.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"
#include "idl/topics.h"
#include "orchestrator/recording/row_assembler.h"
#include "orchestrator/recording/topic_filter.h"

namespace mascot {
namespace {

McapContents Read(const std::string& path) try { return ReadMcap(path); } catch (const std::exception& error) {
  throw ConfigError({error.what()});
}

}  // namespace

std::string FindRecording(const std::string& run) {
  namespace fs = std::filesystem;
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

Recording::Recording(const std::string& run) : path_(FindRecording(run)), contents_(Read(path_)) {
  ReadConfig();
  FindSamples();
}

void Recording::ReadConfig() {
  const auto attached = contents_.attachments.find("config.toml");
  if (attached == contents_.attachments.end())
    throw ConfigError({path_ + ": expected a run's recording, with its config.toml attached, got none" +
                       (damage().empty() ? "" : ": " + damage())});
  Section config = Section::FromText(attached->second, path_ + " (config.toml)");
  config.Use(ExperimentKeys());
  Section run = config.Child("run");
  name_ = run.Text("name");
  realtime_ = run.OneOf("mode") == "realtime";
  agents_ = static_cast<int>(config.Child("agents").Integer("count"));
  rate_hz_ = static_cast<int>(config.Child("control").Integer("rate_hz"));
  patterns_ = config.Child("record").Texts("topics");
  config.ThrowIfWrong();
}

/// Makes sure that the topics needed were recorded and have no gaps, and counts ticks.
void Recording::FindSamples() {
  has_commands_ = true;
  std::map<std::string, std::uint64_t> messages;  // of the topics with a sample of every tick
  for (int id = 1; id <= agents_; ++id) {
    const std::string state = Topic::State(id).Name();
    if (!IsRecorded(patterns_, Topic::State(id)))
      throw std::runtime_error(path_ + ": holds no " + state + ": record.topics left it out");
    messages[state] = 0;
    has_commands_ = has_commands_ && IsRecorded(patterns_, Topic::Command(id));
  }
  for (int id = 1; has_commands_ && !realtime_ && id <= agents_; ++id) messages[Topic::Command(id).Name()] = 0;
  for (const auto& [channel_id, channel] : contents_.channels) {
    if (channel.gaps > 0)
      throw std::runtime_error(path_ + ": " + channel.topic +
                               ": gaps in its sequence numbers: " + std::to_string(channel.gaps));
    if (const auto known = messages.find(channel.topic); known != messages.end()) known->second = channel.messages;
  }
  CountTicks(messages);
}

void Recording::CountTicks(const std::map<std::string, std::uint64_t>& messages) {
  const auto by_count = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto fewest = std::min_element(messages.begin(), messages.end(), by_count);
  const auto most = std::max_element(messages.begin(), messages.end(), by_count);
  if (contents_.complete && fewest->second != most->second)
    throw std::runtime_error(path_ + ": " + most->first + " has " + std::to_string(most->second) + " messages, " +
                             fewest->first + " has " + std::to_string(fewest->second));
  if (fewest->second == 0)
    throw std::runtime_error(path_ + ": holds no whole tick" + (damage().empty() ? "" : ": " + damage()));
  ticks_ = static_cast<std::int64_t>(fewest->second);
}

void Recording::ForEachRow(const std::function<void(const Row&)>& on_row) const {
  RowAssembler assembler({path_, agents_, rate_hz_, ticks_, has_commands_ && !realtime_}, on_row);
  for (const auto& [id, channel] : contents_.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (!topic || topic->agent < 1 || topic->agent > agents_) continue;
    if (topic->kind == TopicKind::kState || (topic->kind == TopicKind::kCommand && has_commands_))
      assembler.AddChannel(id, *topic);
  }
  ReadMcap(path_, [&assembler](const McapContents::Message& message) { assembler.Take(message); });
  assembler.Finish();
}

}  // namespace mascot
