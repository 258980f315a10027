#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "orchestrator/formats/mcap/reader.h"

namespace mascot {

/// Reads an MCAP file in any order, by the index at its end: opening it reads its summary, and a chunk is read when it
/// is asked for. A file without a whole index, because it was cut or damaged, has messages outside of chunks or
/// chunks without message indexes, is read through once instead.
class McapIndex {
 public:
  struct Chunk {
    std::uint64_t offset = 0;  ///< offset of the chunk's record in the file
    std::uint64_t first_ns = 0, last_ns = 0;
    std::vector<std::uint16_t> channels;  ///< channels that have messages in the chunk, in increasing order
    std::uint64_t bytes = 0;              ///< size of the unpacked chunk, as the index says; 0: there is no index
  };

  /// Throws what McapReader throws.
  explicit McapIndex(const std::string& path);
  ~McapIndex();
  McapIndex(const McapIndex&) = delete;
  McapIndex& operator=(const McapIndex&) = delete;

  /// What the file holds. If `is_indexed()`, as its summary says: messages are counted, but their bytes, their times
  /// and gaps in their sequence are not known.
  const McapContents& contents() const;
  bool is_indexed() const;
  /// In the order of the file.
  const std::vector<Chunk>& chunks() const;
  /// Passes the messages of a chunk, in the order of the file; of a chunk that was cut, the whole ones. A message is
  /// valid during the call. Throws std::runtime_error, with path and byte, if the chunk is damaged.
  void ReadChunk(const Chunk& chunk, const std::function<void(const McapContents::Message&)>& on_message);
  /// How much of the file was read so far; if it had to be read through, nothing of that is counted.
  std::uint64_t bytes_read() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot
