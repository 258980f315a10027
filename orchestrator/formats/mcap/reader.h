#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mascot {

/// Contents of an MCAP file, up to its end or the first damage. A chunk that is cut off counts as far as it can be
/// decompressed; a chunk with a wrong CRC does not count.
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
    std::uint64_t gaps = 0;  ///< messages whose sequence number is not the previous one + 1, or 0 at the start
  };
  std::string profile, library;
  std::map<std::uint16_t, ChannelInfo> channels;
  std::map<std::string, std::string> attachments;  ///< name -> bytes
  std::map<std::string, std::string> media_types;  ///< of the attachments, by name
  std::map<std::string, std::map<std::string, std::string>> metadata;
  std::uint64_t chunks = 0, messages = 0, compressed_bytes = 0, uncompressed_bytes = 0;
  bool complete = false;  ///< the file has DataEnd and footer, every CRC is right, and so is what its summary counts
  bool data_complete = false;  ///< at least all in front of the summary is there, and every CRC of it is right
  std::string damage;          ///< what is wrong, and at which byte; empty: nothing
  bool cut = false;            ///< the damage is that the file ends where more must follow
};

/// Reads an MCAP file message by message, so that the memory it takes does not grow with the file.
class McapReader {
 public:
  /// Throws std::runtime_error if the file cannot be read or does not begin with the MCAP magic.
  explicit McapReader(const std::string& path);
  ~McapReader();
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  /// The next message, in the order of the file; valid until the next call. Null at the end of the file, or at the
  /// first damage. Throws std::runtime_error if the file cannot be read.
  const McapContents::Message* Next();
  /// What was read so far; all that the file holds once Next() has returned null.
  const McapContents& contents() const;
  /// Where in the file the record begins that holds the last message: a chunk, or the message itself.
  std::uint64_t record_offset() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads `path` and passes each message to `on_message` (may be empty). Throws what McapReader throws. Damage is
/// reported in the contents, also for a file cut off at any byte.
McapContents ReadMcap(const std::string& path,
                      const std::function<void(const McapContents::Message&)>& on_message = {});

}  // namespace mascot
