#include "orchestrator/recording/repair.h"

#include <map>
#include <optional>
#include <stdexcept>

#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/formats/part_file.h"
#include "orchestrator/recording/recording.h"

namespace mascot {
namespace {

/// The writer's channel for each channel of the recording. Throws std::runtime_error for one that no run writes.
std::map<std::uint16_t, std::uint16_t> AddChannels(McapWriter& writer, const McapContents& contents,
                                                   const std::string& recording) {
  std::map<std::uint16_t, std::uint16_t> channels;
  for (const auto& [id, channel] : contents.channels) {
    if (channel.message_encoding != "cdr" || channel.schema_encoding != "ros2msg")
      throw std::runtime_error(recording + ": " + channel.topic + ": expected cdr with a schema in ros2msg, got '" +
                               channel.message_encoding + "' with '" + channel.schema_encoding + "'");
    channels[id] = writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, channel.metadata});
  }
  return channels;
}

void CopyMessages(const std::string& recording, const std::map<std::uint16_t, std::uint16_t>& channels,
                  McapWriter& writer) {
  McapReader reader(recording);
  std::optional<std::uint64_t> time_ns;
  while (const McapContents::Message* message = reader.Next()) {
    if (time_ns && *time_ns != message->log_time) writer.EndTick();
    time_ns = message->log_time;
    writer.Write(channels.at(message->channel), message->log_time, message->data);
  }
}

}  // namespace

Repair::Repair(const std::string& recording)
    : recording_(recording),
      contents_(ReadRecording(recording)),
      plan_(PlanOf(contents_, recording)),
      proof_(Prove(contents_, plan_)) {
  if (!proof_.gap.empty()) throw std::runtime_error(recording_ + ": " + proof_.gap);
  if (contents_.messages == 0 && !damage().empty())
    throw std::runtime_error(recording_ + ": holds no whole message: " + damage());
}

void Repair::Write(const std::string& path) const {
  PartFile part(path);
  McapWriter writer(part.name());
  auto attachments = contents_.attachments;
  const auto config = attachments.extract(kConfigFile);  // behind the messages, where the run wrote it
  for (const auto& [name, data] : attachments) writer.Attach(name, contents_.media_types.at(name), data);
  auto metadata = contents_.metadata;
  if (!keeps_all()) metadata[kMetadata].try_emplace(kRecoveredKey, damage());
  const auto early_end = metadata.extract(kEarlyEnd);  // behind the messages, where the run wrote it
  for (const auto& [name, entries] : metadata) writer.Metadata(name, entries);
  CopyMessages(recording_, AddChannels(writer, contents_, recording_), writer);
  if (!early_end.empty()) writer.Metadata(early_end.key(), early_end.mapped());
  writer.Attach(kConfigFile, kToml, config.mapped());
  writer.Close();
  part.Commit();
}

}  // namespace mascot
