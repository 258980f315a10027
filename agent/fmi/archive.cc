#include "agent/fmi/archive.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <utility>

#include "agent/fmi/error.h"
#include "base/utf8.h"

namespace mascot {
namespace {

/// An error of libzip, which lives until the end of a call.
class ZipFailure {
 public:
  ZipFailure() { zip_error_init(&error_); }
  ~ZipFailure() { zip_error_fini(&error_); }
  ZipFailure(const ZipFailure&) = delete;
  ZipFailure& operator=(const ZipFailure&) = delete;
  zip_error_t* get() { return &error_; }
  std::string words() { return PlainLine(zip_error_strerror(&error_)); }

 private:
  zip_error_t error_;
};

[[noreturn]] void RefuseEntry(const std::string& name, const std::string& why) {
  throw FmuError("entry '" + Shortened(PlainLine(name), 200) + "' of the archive " + why);
}

/// Whether each part of the path is the name of a file or folder: none is empty, "." or "..".
bool HasSoundParts(std::string_view path) {
  if (path.ends_with('/')) path.remove_suffix(1);
  while (true) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view part = path.substr(0, end);
    if (part.empty() || part == "." || part == "..") return false;
    if (end == path.size()) return true;
    path.remove_prefix(end + 1);
  }
}

void RequireSoundName(const std::string& name) {
  if (name.find('\\') != std::string::npos) RefuseEntry(name, "has a backslash in its name");
  if (name.starts_with('/')) RefuseEntry(name, "has an absolute path");
  if (name.size() >= 2 && name[1] == ':') RefuseEntry(name, "has a drive letter in its name");
  if (PlainLine(name) != name || name.size() > 1000) RefuseEntry(name, "has no name that a file may have");
  if (!HasSoundParts(name)) RefuseEntry(name, "does not stay inside of the archive's folder");
}

/// The mode of a file as stat(2) has it, which archives made on Unix hold; 0 in others.
mode_t ModeOf(zip* archive, std::uint64_t index) {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive, index, 0, &system, &attributes) != 0) return 0;
  return static_cast<mode_t>(attributes >> 16);
}

/// Refuses links, devices and pipes.
void RequireFileOrFolder(mode_t mode, const std::string& name) {
  const mode_t kind = mode & S_IFMT;
  if (kind == S_IFLNK) RefuseEntry(name, "is a link");
  if (kind != 0 && kind != S_IFREG && kind != S_IFDIR) RefuseEntry(name, "is neither a file nor a folder");
}

}  // namespace

void FmuArchive::Closer::operator()(zip* archive) const { zip_discard(archive); }

FmuArchive::FmuArchive(std::string bytes) : bytes_(std::move(bytes)) {
  ZipFailure failure;
  zip_source_t* const source = zip_source_buffer_create(bytes_.data(), bytes_.size(), 0, failure.get());
  if (source == nullptr) throw FmuError("no zip archive: " + failure.words());
  zip_.reset(zip_open_from_source(source, ZIP_RDONLY, failure.get()));
  if (!zip_) {
    zip_source_free(source);
    throw FmuError("no zip archive: " + failure.words());
  }
  const auto entries = static_cast<std::uint64_t>(std::max<zip_int64_t>(zip_get_num_entries(zip_.get(), 0), 0));
  if (entries > kMaxEntries)
    throw FmuError(fmt::format("an archive of {} entries, expected at most {}", entries, kMaxEntries));
  std::uint64_t total = 0;
  for (std::uint64_t index = 0; index < entries; ++index) Take(index, total);
  for (const auto& [name, size] : sizes_)
    for (std::size_t slash = name.find('/'); slash != name.npos; slash = name.find('/', slash + 1))
      if (sizes_.contains(name.substr(0, slash))) RefuseEntry(name.substr(0, slash), "is a file and a folder");
}

void FmuArchive::Take(std::uint64_t index, std::uint64_t& total) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  constexpr auto kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE;
  if (zip_stat_index(zip_.get(), index, 0, &stat) != 0 || (stat.valid & kNeeded) != kNeeded)
    throw FmuError(fmt::format("entry {} of the archive cannot be read", index + 1));
  const std::string name = stat.name;
  RequireSoundName(name);
  const mode_t mode = ModeOf(zip_.get(), index);
  RequireFileOrFolder(mode, name);
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
    RefuseEntry(name, "is encrypted");
  if ((stat.valid & ZIP_STAT_COMP_METHOD) != 0 && stat.comp_method != ZIP_CM_STORE &&
      stat.comp_method != ZIP_CM_DEFLATE)
    RefuseEntry(name, "is compressed by another method than deflate");
  constexpr std::uint64_t kSmall = std::uint64_t{1} << 20;
  if (stat.size > kMaxEntry)
    RefuseEntry(name, fmt::format("unpacks to {} bytes, expected at most {}", stat.size, kMaxEntry));
  if (stat.size > kSmall && stat.size / kMaxRatio > stat.comp_size)
    RefuseEntry(name, fmt::format("unpacks {} bytes to {}, expected at most {} times as many", stat.comp_size,
                                  stat.size, kMaxRatio));
  total += stat.size;
  if (total > kMaxTotal) throw FmuError(fmt::format("an archive that unpacks to more than {} bytes", kMaxTotal));
  if (name.ends_with('/')) return;
  if (!sizes_.emplace(name, stat.size).second) RefuseEntry(name, "occurs twice");
  indices_.emplace(name, index);
  if ((mode & S_IXUSR) != 0) executables_.insert(name);
}

std::string FmuArchive::Read(const std::string& name) const {
  const std::uint64_t size = sizes_.at(name);
  zip_file_t* const file = zip_fopen_index(zip_.get(), indices_.at(name), 0);
  if (file == nullptr) RefuseEntry(name, "cannot be unpacked: " + PlainLine(zip_strerror(zip_.get())));
  std::string bytes(size + 1, '\0');  // one more: the end is read, too, where the checksum is compared
  std::uint64_t filled = 0;
  zip_int64_t got = 0;
  while (filled <= size && (got = zip_fread(file, bytes.data() + filled, bytes.size() - filled)) > 0)
    filled += static_cast<std::uint64_t>(got);
  const std::string reason = got < 0 ? PlainLine(zip_file_strerror(file)) : "";
  zip_fclose(file);
  if (got < 0) RefuseEntry(name, "is damaged: " + reason);
  if (filled != size) RefuseEntry(name, "is damaged: its size is not as the archive says");
  bytes.resize(size);
  return bytes;
}

std::string PackFiles(const std::map<std::string, std::string>& files, const std::set<std::string>& executables) {
  constexpr zip_uint16_t kMidnight = 0, kFirstOf1980 = (1 << 5) | 1;  // as MS-DOS has times and dates
  ZipFailure failure;
  const auto fail = [](const std::string& words) { throw FmuError("it cannot be packed: " + words); };
  zip_source_t* const target = zip_source_buffer_create(nullptr, 0, 0, failure.get());
  if (target == nullptr) fail(failure.words());
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> keeper(target, zip_source_free);
  zip_source_keep(target);  // the archive takes one of the two, and reading what it wrote the other
  zip_t* const archive = zip_open_from_source(target, ZIP_CREATE | ZIP_TRUNCATE, failure.get());
  if (archive == nullptr) {
    zip_source_free(target);
    fail(failure.words());
  }
  for (const auto& [name, bytes] : files) {
    zip_source_t* const source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const zip_int64_t index = source == nullptr ? -1 : zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      const std::string words = PlainLine(zip_strerror(archive));
      zip_source_free(source);
      zip_discard(archive);
      fail(words);
    }
    zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), kMidnight, kFirstOf1980, 0);
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE, 6);
    constexpr zip_uint32_t kExecutable = zip_uint32_t{S_IFREG | 0755} << 16;
    if (executables.contains(name))
      zip_file_set_external_attributes(archive, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX, kExecutable);
  }
  if (zip_close(archive) != 0) {
    const std::string words = PlainLine(zip_strerror(archive));
    zip_discard(archive);
    fail(words);
  }
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_source_stat(target, &stat) != 0 || zip_source_open(target) != 0) fail("it cannot be read back");
  std::string bytes(stat.size, '\0');
  const zip_int64_t got = zip_source_read(target, bytes.data(), bytes.size());
  zip_source_close(target);
  if (got != static_cast<zip_int64_t>(bytes.size())) fail("it cannot be read back");
  return bytes;
}

}  // namespace mascot
