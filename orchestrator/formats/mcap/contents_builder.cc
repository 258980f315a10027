#include "orchestrator/formats/mcap/contents_builder.h"

#include <tuple>
#include <utility>

namespace mascot::mcap {

void ContentsBuilder::AddSchema(Fields body) {
  const std::uint16_t id = body.U16();
  Schema schema;
  schema.name = body.String();
  schema.encoding = body.String();
  const ByteSpan text = body.Raw(body.U32());
  schema.text.assign(text.begin(), text.end());
  const auto [known, added] = schemas_.try_emplace(id, schema);
  if (!added && !(known->second == schema)) throw Malformed("schema " + std::to_string(id) + " is defined twice");
}

void ContentsBuilder::AddChannel(Fields body) {
  const std::uint16_t id = body.U16();
  const std::uint16_t schema_id = body.U16();
  McapContents::ChannelInfo channel;
  channel.topic = body.String();
  channel.message_encoding = body.String();
  channel.metadata = body.Map();
  if (schema_id != 0) {  // 0: the channel has no schema
    const auto schema = schemas_.find(schema_id);
    if (schema == schemas_.end()) throw Malformed("channel " + channel.topic + " has an unknown schema");
    channel.schema_name = schema->second.name;
    channel.schema_encoding = schema->second.encoding;
    channel.schema_text = schema->second.text;
  }
  const auto [known, added] = contents_.channels.try_emplace(id, channel);
  const McapContents::ChannelInfo& old = known->second;
  if (!added && std::tie(old.topic, old.schema_name, old.message_encoding, old.metadata) !=
                    std::tie(channel.topic, channel.schema_name, channel.message_encoding, channel.metadata))
    throw Malformed("channel " + std::to_string(id) + " is defined twice");
}

void ContentsBuilder::AddAttachment(Fields body) {
  const ByteSpan all = body.rest();
  body.U64();  // log time
  body.U64();  // creation time
  const std::string name = body.String();
  const std::string media_type = body.String();
  const ByteSpan data = body.Raw(body.U64());
  const ByteSpan covered = all.first(all.size() - body.rest().size());
  const std::uint32_t crc = body.U32();
  if (crc != 0 && crc != Crc32(0, covered)) throw Malformed("the CRC of attachment '" + name + "' is wrong");
  contents_.attachments[name] = {data.begin(), data.end()};
  contents_.media_types[name] = media_type;
}

void ContentsBuilder::AddMetadata(Fields body) {
  const std::string name = body.String();
  contents_.metadata[name] = body.Map();
}

void ReadMessage(Fields body, McapContents::Message& message) {
  message.channel = body.U16();
  message.sequence = body.U32();
  message.log_time = body.U64();
  body.U64();  // publish time
  message.data.assign(body.rest().begin(), body.rest().end());
}

}  // namespace mascot::mcap
