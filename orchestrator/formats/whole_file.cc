#include "orchestrator/formats/whole_file.h"

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/part_file.h"

namespace mascot {

void WriteWhole(const std::string& path, std::string_view text) {
  PartFile part(path);
  OutputFile file(part.name());
  file.Write(AsBytes(text));
  file.SyncAndClose();
  part.Commit();
}

}  // namespace mascot
