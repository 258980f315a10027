// Copies of recordings in which something is another.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"

namespace mascot {

/// Whether a copy keeps a message, which it may change.
using EditMessage = std::function<bool(const std::string& topic, McapContents::Message& message)>;

/// Copies `contents`, those of `recording`, and the messages that `edit` keeps and may change; closes the file
/// properly.
inline void CopyRecording(const std::string& recording, const McapContents& contents, const std::string& copy,
                          const EditMessage& edit) {
  McapWriter writer(copy);
  for (const auto& [name, data] : contents.attachments) writer.Attach(name, "application/toml", data);
  for (const auto& [name, entries] : contents.metadata) writer.Metadata(name, entries);
  std::map<std::uint16_t, std::uint16_t> channels;
  for (const auto& [id, channel] : contents.channels)
    channels[id] = writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, channel.metadata});
  ReadMcap(recording, [&](McapContents::Message message) {
    if (edit(contents.channels.at(message.channel).topic, message))
      writer.Write(channels[message.channel], message.log_time, message.data);
  });
  writer.Close();
}

inline void CopyRecording(const std::string& recording, const std::string& copy, const EditMessage& edit) {
  CopyRecording(recording, ReadMcap(recording), copy, edit);
}

}  // namespace mascot
