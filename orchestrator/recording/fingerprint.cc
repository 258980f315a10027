#include "orchestrator/recording/fingerprint.h"

#include <fmt/format.h>

#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/completeness.h"

namespace mascot {
namespace {

std::string FingerprintOf(const std::string& path) {
  constexpr std::uint64_t kPiece = 1 << 20;
  const InputFile file(path);
  Bytes piece;
  std::uint32_t crc = 0;
  for (std::uint64_t at = 0; at < file.size(); at += kPiece) {
    file.Read(at, kPiece, piece);
    crc = Crc32(crc, piece);
  }
  return fmt::format("crc32 {:08x} of {} bytes", crc, file.size());
}

}  // namespace

std::map<std::string, std::string> Fingerprints(const Experiment& experiment) {
  std::map<std::string, std::string> fingerprints;
  const auto add = [&](const std::vector<std::string>& paths) {
    for (const std::string& path : paths)
      if (!fingerprints.contains(path)) fingerprints[path] = FingerprintOf(path);
  };
  for (const AgentConfig& agent : experiment.agents) add(agent.law.params->files);
  for (const Event& event : experiment.events) add(event.files);
  return fingerprints;
}

std::vector<std::string> ChangesSince(const McapContents& recording, const Experiment& experiment,
                                      const std::string& again) {
  std::vector<std::string> notes;
  if (recording.library != McapWriter::Library())
    notes.push_back("recorded by " + recording.library + ", " + again + " by " + McapWriter::Library());
  const auto about = recording.metadata.find(kMetadata);
  for (const auto& [path, fingerprint] : Fingerprints(experiment)) {
    if (about == recording.metadata.end() || !about->second.contains(path))
      notes.push_back("the recording does not tell which " + path + " it was flown with");
    else if (about->second.at(path) != fingerprint)
      notes.push_back(path + " has changed: recorded with " + about->second.at(path) + ", now " + fingerprint);
  }
  return notes;
}

}  // namespace mascot
