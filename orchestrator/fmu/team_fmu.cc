#include "orchestrator/fmu/team_fmu.h"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "base/fnv.h"
#include "orchestrator/fmu/variable_table.h"
#include "orchestrator/formats/zip.h"

namespace mascot {
namespace {

constexpr const char* kSource = "team_fmu.c";

/// The folder of binaries for the processor of this program.
std::string BinaryFolder(FmiVersion version) {
#if defined(__aarch64__)
  static_cast<void>(version);  // FMI 2 has no name for it, and leaves names to tools
  return "binaries/aarch64-linux/";
#else
  return version == FmiVersion::k2 ? "binaries/linux64/" : "binaries/x86_64-linux/";
#endif
}

/// A token that differs for FMUs that differ.
std::string TokenOf(const std::string& text) {
  const std::string digits = fmt::format("{:016x}{:016x}", Fnv1a(text), Fnv1a("token " + text));
  return fmt::format("{{{}-{}-{}-{}-{}}}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                     digits.substr(16, 4), digits.substr(20));
}

/// A zip archive in memory.
class Archive {
 public:
  void Add(const std::string& name, const std::string& content) {
    Write(records_.Add(name, bytes_.size(), content.size(), Crc32(0, AsBytes(content))));
    bytes_ += content;
  }
  std::string Finish() {
    Write(records_.End(bytes_.size()));
    // FMI has no archives in zip64 form.
    if (bytes_.size() >= std::numeric_limits<std::uint32_t>::max())
      throw std::invalid_argument("the FMU would have 4 GiB or more, which FMI does not have");
    return std::move(bytes_);
  }

 private:
  void Write(const Bytes& bytes) { bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); }

  ZipRecords records_;
  std::string bytes_;
};

/// FMI 2 has integers of 32 bits only.
void RequireIntegers(const FmuTeam& team) {
  for (const FmuVariable& variable : team.variables) {
    const auto* number = std::get_if<std::int64_t>(&variable.start);
    if (number != nullptr && *number > std::numeric_limits<std::int32_t>::max())
      throw std::invalid_argument(fmt::format(
          "{}: expected at most {}, the largest integer of FMI 2, got {}: give another, or make the FMU with --fmi 3",
          variable.name, std::numeric_limits<std::int32_t>::max(), *number));
  }
}

}  // namespace

std::string TeamFmu(FmiVersion version, const FmuTeam& team, const FmuParts& parts) {
  if (version == FmiVersion::k2) RequireIntegers(team);
  const std::string token =
      TokenOf(ModelDescription(version, team, "") + VariableTable(team, "", "") + parts.experiment + parts.source);
  Archive archive;
  archive.Add("modelDescription.xml", ModelDescription(version, team, token));
  archive.Add(BinaryFolder(version) + team.identifier + ".so", parts.binary);
  archive.Add(std::string("sources/") + kSource, parts.source);
  if (version == FmiVersion::k3) archive.Add("sources/buildDescription.xml", BuildDescription(team, kSource));
  archive.Add("resources/experiment.toml", parts.experiment);
  archive.Add("resources/variables.txt", VariableTable(team, token, parts.program));
  return archive.Finish();
}

}  // namespace mascot
