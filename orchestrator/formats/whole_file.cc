#include "orchestrator/formats/whole_file.h"

#include "orchestrator/formats/bytes.h"

namespace mascot {

void WholeFile::Write(std::string_view text) {
  constexpr std::size_t kMaxPending = 1 << 16;
  pending_ += text;
  if (pending_.size() >= kMaxPending) Flush();
}

void WholeFile::Flush() {
  file_.Write(AsBytes(pending_));
  pending_.clear();
}

void WholeFile::Commit() {
  Flush();
  file_.SyncAndClose();
  part_.Commit();
}

void WriteWhole(const std::string& path, std::string_view text) {
  WholeFile file(path);
  file.Write(text);
  file.Commit();
}

}  // namespace mascot
