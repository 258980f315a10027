#pragma once

#include <string>
#include <string_view>

#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/part_file.h"

namespace mascot {

/// Writes the file at `path` completely or not at all: writes `path`.part, syncs it to disk and renames it. Throws
/// std::runtime_error with the file's name and the system's reason.
void WriteWhole(const std::string& path, std::string_view text);

/// Writes a file completely or not at all, from text that comes in pieces, of which only little is in memory. Without
/// Commit() there is no file.
class WholeFile {
 public:
  explicit WholeFile(const std::string& path) : part_(path), file_(part_.name()) {}
  void Write(std::string_view text);
  void Commit();

 private:
  void Flush();

  PartFile part_;
  OutputFile file_;
  std::string pending_;
};

}  // namespace mascot
