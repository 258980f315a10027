#include "orchestrator/recording/recording.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "experiment/toml/section.h"
#include "idl/topics.h"
#include "orchestrator/recording/row_assembler.h"

namespace mascot {

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

McapContents ReadRecording(const std::string& path) try { return ReadMcap(path); } catch (const std::exception& error) {
  throw ConfigError({error.what()});
}

Recording::Recording(const std::string& run)
    : path_(FindRecording(run)), contents_(ReadRecording(path_)), plan_(PlanOf(contents_, path_)) {
  std::erase_if(plan_.topics, [](const Topic& topic) {
    return topic.kind != TopicKind::kState && topic.kind != TopicKind::kCommand;
  });
  const auto is_recorded = [&](const Topic& topic) {
    return std::ranges::find(plan_.topics, topic) != plan_.topics.end();
  };
  has_commands_ = true;
  for (int id = 1; id <= plan_.agents; ++id) {
    if (!is_recorded(Topic::State(id)))
      throw std::runtime_error(path_ + ": holds no " + Topic::State(id).Name() + ": record.topics left it out");
    has_commands_ = has_commands_ && is_recorded(Topic::Command(id));
  }
  const Proof proof = Prove(contents_, plan_);
  if (!proof.gap.empty()) throw std::runtime_error(path_ + ": " + proof.gap);
  ticks_ = static_cast<std::int64_t>(proof.ticks.value_or(0));
  if (ticks_ == 0) throw std::runtime_error(path_ + ": holds no whole tick" + (loss().empty() ? "" : ": " + loss()));
}

void Recording::ForEachRow(const std::function<void(const Row&)>& on_row) const {
  RowAssembler assembler({path_, plan_.agents, plan_.rate_hz, ticks_, has_commands_ && !plan_.realtime}, on_row);
  for (const auto& [id, channel] : contents_.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (!topic || topic->agent < 1 || topic->agent > plan_.agents) continue;
    if (topic->kind == TopicKind::kState || (topic->kind == TopicKind::kCommand && has_commands_))
      assembler.AddChannel(id, *topic);
  }
  ReadMcap(path_, [&assembler](const McapContents::Message& message) { assembler.Take(message); });
  assembler.Finish();
}

}  // namespace mascot
