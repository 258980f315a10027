#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// Writes MCAP (https://mcap.dev/spec), profile "ros2": chunks with zstd level 1, all CRCs, message and
/// chunk index, statistics, summary offsets. Byte-deterministic: the file depends only on the calls made.
/// Every write is checked; failures throw std::runtime_error naming the file and the cause.
class McapWriter {
 public:
  struct Channel {
    std::string topic;        ///< "/agent_1/state"
    std::string schema_name;  ///< "mascot_msgs/msg/AgentState"
    std::string schema_text;  ///< ros2msg: the .msg text and its dependencies
    std::map<std::string, std::string> metadata;
  };

  /// Creates `path` (truncating) and writes magic and header.
  explicit McapWriter(const std::string& path);
  ~McapWriter();  ///< leaves the file as it is: without Close() it has no summary
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Returns the channel's id (1, 2, ...). Its schema and channel records go before its first message.
  /// Channels with equal schema_name share one schema record.
  std::uint16_t AddChannel(const Channel& channel);
  /// Adds a message to the open chunk; sequence counts 0, 1, 2 ... per channel; log_time = publish_time.
  void Write(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// To be called between ticks: closes the chunk if it holds 1 MiB uncompressed or spans 1 s of message time.
  void EndTick();
  /// Closes the chunk first; attachment times are 0.
  void Attach(const std::string& name, const std::string& media_type, std::string_view data);
  void Metadata(const std::string& name, const std::map<std::string, std::string>& entries);
  /// Last chunk, DataEnd, summary, footer, flush, fsync, close.
  void Close();
  std::uint64_t messages() const;
  std::uint64_t bytes() const;  ///< written so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What an MCAP file holds. Reads every whole record up to the end or the first damage; never throws on a
/// file cut short, at whatever byte. Of a chunk that was cut, what can still be decompressed counts; of one
/// whose CRC is wrong, nothing.
struct McapContents {
  struct Message {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_time = 0;
    std::vector<std::uint8_t> data;
  };
  struct ChannelInfo {
    std::string topic, schema_name, schema_encoding, schema_text, message_encoding;
    std::map<std::string, std::string> metadata;
    std::uint64_t messages = 0, bytes = 0;
    std::uint64_t first_time = 0, last_time = 0;
    std::uint64_t gaps = 0;  ///< places where the sequence does not rise by one, from 0
  };
  std::string profile, library;
  std::map<std::uint16_t, ChannelInfo> channels;
  std::map<std::string, std::string> attachments;  ///< name -> bytes
  std::map<std::string, std::map<std::string, std::string>> metadata;
  std::uint64_t chunks = 0, messages = 0, compressed_bytes = 0, uncompressed_bytes = 0;
  bool complete = false;  ///< has its DataEnd, summary and footer, and every CRC is right
  std::string damage;     ///< empty, or what is wrong and at which byte
};

/// Reads `path`; hands each message to `on_message` (may be empty). Throws std::runtime_error if the file
/// cannot be opened or is no MCAP file at all.
McapContents ReadMcap(const std::string& path,
                      const std::function<void(const McapContents::Message&)>& on_message = {});

}  // namespace mascot
