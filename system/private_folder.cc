#include "system/private_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

#include "system/descriptor.h"
#include "system/files_in_use.h"
#include "system/left_file.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "mascot-files-";

/// $TMPDIR, if that is a folder, else /tmp.
fs::path TemporaryFiles() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  return error ? fs::path("/tmp") : folder;
}

/// Whether the path is a folder of this user, and no link to one.
bool IsOwnFolder(const fs::path& path) {
  struct stat info {};
  return ::lstat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == ::geteuid();
}

std::runtime_error Failure(const fs::path& path, int error) {
  return std::runtime_error("cannot write " + path.string() + ": " + std::generic_category().message(error));
}

}  // namespace

PrivateFolder::PrivateFolder() : maker_(::getpid()) {
  SweepPrivateFolders();
  const std::string name = (TemporaryFiles() / (std::string(kPrefix) + "XXXXXX")).string();
  for (;;) {
    std::string made = name;
    if (::mkdtemp(made.data()) == nullptr) throw Failure(name, errno);
    path_ = made;
    try {
      lock_.emplace(path_);
    } catch (const fs::filesystem_error&) {  // another process swept it before the lock was there
      if (!fs::exists(path_)) continue;
      throw;
    }
    if (lock_->is_ours() && IsOwnFolder(path_)) return;
    lock_.reset();
  }
}

PrivateFolder::~PrivateFolder() {
  if (::getpid() != maker_) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void PrivateFolder::Write(const fs::path& name, std::string_view bytes, bool is_executable) const {
  const fs::path path = path_ / name;
  fs::create_directories(path.parent_path());
  const mode_t mode = S_IRUSR | (is_executable ? S_IXUSR : 0);
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (!file.is_open() || !WriteAll(file.number(), bytes)) throw Failure(path, errno);
}

void SweepPrivateFolders() {
  for (const fs::path& path : PathsIn(TemporaryFiles())) {
    if (!path.filename().string().starts_with(kPrefix) || !IsOwnFolder(path)) continue;
    try {
      const FolderLock lock(path);
      if (!lock.is_ours()) continue;
      std::error_code ignored;
      fs::remove_all(path, ignored);
    } catch (const fs::filesystem_error&) {  // its process removes it just now
    }
  }
}

}  // namespace mascot
