#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// Writes MCAP (https://mcap.dev/spec), profile "ros2": chunks with zstd level 1, all CRCs, message and chunk indexes,
/// statistics, summary offsets. Byte-deterministic: the file depends only on the sequence of calls.
/// Every write is checked; failures throw std::runtime_error naming the file and the cause.
class McapWriter {
 public:
  struct Channel {
    std::string topic;        ///< "/agent_1/state"
    std::string schema_name;  ///< "mascot_msgs/msg/AgentState"
    std::string schema_text;  ///< ros2msg: the .msg text and its dependencies
    std::map<std::string, std::string> metadata;
  };

  /// What the header of every file says of the program that wrote it: "mascot 0.1.0".
  static std::string Library();

  /// Creates or truncates `path` and writes magic and header.
  explicit McapWriter(const std::string& path);
  ~McapWriter();  ///< without Close(), the file keeps its complete chunks but has no summary
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Registers a channel and returns its id (1, 2, ...). Its schema and channel records are written before its first
  /// message. Channels with equal schema_name and schema_text share one schema record.
  std::uint16_t AddChannel(const Channel& channel);
  /// Adds a message to the open chunk. Sequence numbers count 0, 1, 2, ... per channel; log and publish time are
  /// `time_ns`.
  void Write(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// To be called between ticks: closes the chunk if it holds 1 MiB uncompressed or spans 1 s of message time.
  void EndTick();
  /// Writes an attachment, after closing the open chunk. Its log and creation times are 0.
  void Attach(const std::string& name, const std::string& media_type, std::string_view data);
  /// Writes a metadata record, after closing the open chunk.
  void Metadata(const std::string& name, const std::map<std::string, std::string>& entries);
  /// Writes the last chunk, DataEnd, summary and footer, then syncs and closes the file.
  void Close();
  std::uint64_t messages() const;
  std::uint64_t bytes() const;  ///< written so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the file begins as those of McapWriter do, of any version. Throws std::runtime_error if it cannot be read.
bool IsByMcapWriter(const std::string& path);

}  // namespace mascot
