#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/records.h"

namespace mascot::mcap {

/// Collects what records say about the contents of a file: from the data section or from the summary. The functions
/// take the record's body and throw Malformed.
class ContentsBuilder {
 public:
  explicit ContentsBuilder(McapContents& contents) : contents_(contents) {}

  void AddSchema(Fields body);
  void AddChannel(Fields body);
  void AddAttachment(Fields body);
  void AddMetadata(Fields body);

 private:
  struct Schema {
    std::string name, encoding, text;
    bool operator==(const Schema&) const = default;
  };

  McapContents& contents_;
  std::map<std::uint16_t, Schema> schemas_;
};

/// Reads a message record into `message`, which keeps its capacity.
void ReadMessage(Fields body, McapContents::Message& message);

}  // namespace mascot::mcap
