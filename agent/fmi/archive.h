#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>

struct zip;

namespace mascot {

/// The archive of an FMU: a zip file in memory, whose entries have been checked before any is unpacked. Refused are:
/// too many entries; entries that unpack to too much, alone or together; names that are absolute, climb out, have
/// backslashes, drive letters or control characters, or occur twice; links and other special files; encryption, and
/// compression that the standard of FMUs does not allow.
class FmuArchive {
 public:
  static constexpr std::uint64_t kMaxEntries = 10'000;
  static constexpr std::uint64_t kMaxEntry = std::uint64_t{64} << 20;   ///< bytes of an unpacked file
  static constexpr std::uint64_t kMaxTotal = std::uint64_t{256} << 20;  ///< bytes of all unpacked files
  static constexpr std::uint64_t kMaxRatio = 200;  ///< unpacked bytes for each packed one, of files over 1 MiB

  /// Throws FmuError, naming the entry that is refused.
  explicit FmuArchive(std::string bytes);

  /// The size of each file when it is unpacked (bytes), by its path in the archive. Folders are not in it.
  const std::map<std::string, std::uint64_t>& sizes() const { return sizes_; }
  bool Has(const std::string& name) const { return sizes_.contains(name); }
  /// The files that their owner may execute, as an archive that was made on Unix says.
  const std::set<std::string>& executables() const { return executables_; }
  /// Unpacks a file, which must be there. Throws FmuError if it is damaged.
  std::string Read(const std::string& name) const;

 private:
  struct Closer {
    void operator()(zip* archive) const;
  };
  void Take(std::uint64_t index, std::uint64_t& total);

  std::string bytes_;
  std::unique_ptr<zip, Closer> zip_;
  std::map<std::string, std::uint64_t> sizes_, indices_;
  std::set<std::string> executables_;
};

/// A zip file with these files, by their paths, of which some may be executed: the same files give the same bytes.
std::string PackFiles(const std::map<std::string, std::string>& files, const std::set<std::string>& executables = {});

}  // namespace mascot
