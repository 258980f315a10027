// Fuzzer: any bytes as a recording, read by all that read recordings: info, export, verify, recover, view. Damage has a
// place. What was recovered is a whole recording with the same messages.
#include "orchestrator/recording/recording.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/indexed_rows.h"
#include "orchestrator/recording/repair.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/recording/sample_fields.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

constexpr int kMaxAgentsFuzzed = 100;  // of the attached experiment; more take long, and are no other code

/// A file in memory, with a name.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::uint8_t> bytes) : fd_(::memfd_create("fuzz", 0)) {
    Require(fd_ >= 0 && WriteFully(fd_, bytes), "no memory for a file");
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

std::vector<std::vector<std::uint8_t>> MessagesOf(const std::string& path, McapContents& contents) {
  std::vector<std::vector<std::uint8_t>> messages;
  contents = ReadMcap(path, [&](const McapContents::Message& message) { messages.push_back(message.data); });
  return messages;
}

/// Calls `read`; an exception from it must have words for the user.
template <class Read>
void InWords(const Read& read) try {
  read();
} catch (const std::runtime_error& error) {  // ConfigError too
  Require(*error.what() != '\0', "an error without words");
}

void ReadSomeRows(const std::string& path) {
  IndexedRows rows(path);
  DecodedRow decoded(rows.agents());
  rows.Events();
  for (const std::int64_t tick : {rows.ticks().last(), std::int64_t{0}, rows.ticks().last() / 2})
    rows.Read(tick, decoded);
}

void ReadRows(const std::string& path) {
  const Recording recording(path);
  DecodedRow decoded(recording.agents());
  recording.ForEachRow([&](const Row& row) { Decode(row, decoded); });
}

void CompareSamples(const std::vector<std::vector<std::uint8_t>>& messages) {
  for (std::size_t k = 1; k < std::min<std::size_t>(messages.size(), 10); ++k)
    for (const TopicKind kind : {TopicKind::kState, TopicKind::kCommand, TopicKind::kMessage, TopicKind::kClock})
      Require(FirstDifference(kind, messages[k - 1], messages[k]).has_value() == (messages[k - 1] != messages[k]),
              "a difference between equal samples, or none between others");
}

void RecoverTo(const std::string& target, const std::string& path, std::size_t messages) {
  const Repair repair(path);
  repair.Write(target);
  McapContents contents;
  Require(MessagesOf(target, contents).size() == messages, "recovered another number of messages");
  Require(contents.complete, "what was recovered is damaged: " + contents.damage);
}

void FuzzRecording(std::span<const std::uint8_t> bytes) {
  static const std::string target = "/dev/shm/mascot-fuzz-" + std::to_string(::getpid()) + ".mcap";
  const MemoryFile file(bytes);
  McapContents contents;
  std::vector<std::vector<std::uint8_t>> messages;
  try {
    messages = MessagesOf(file.path(), contents);
  } catch (const std::runtime_error&) {  // is no MCAP file
    return;
  }
  Require(contents.complete == contents.damage.empty(), "complete with damage, or damaged without");
  Require(contents.complete || contents.damage.find("(record at byte ") != std::string::npos, "damage without a place");
  CompareSamples(messages);
  RecordingPlan plan;
  InWords([&] { plan = PlanOf(contents, "fuzz.mcap"); });
  Prove(contents, plan).End(plan.ticks);
  if (plan.agents == 0 || plan.agents > kMaxAgentsFuzzed) return;
  InWords([&] { ReadRows(file.path()); });
  InWords([&] { ReadSomeRows(file.path()); });
  InWords([&] { RecoverTo(target, file.path(), messages.size()); });
  ::unlink(target.c_str());
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mascot::FuzzRecording({data, size});
  return 0;
}
