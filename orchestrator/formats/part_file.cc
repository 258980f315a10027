#include "orchestrator/formats/part_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "orchestrator/formats/create_file.h"

namespace mascot {

PartFile::PartFile(std::string path) : path_(std::move(path)), part_(path_ + ".part") { RequireReplaceable(path_); }

PartFile::~PartFile() {
  struct stat there {};  // what is no file was there before
  if (!part_.empty() && ::lstat(part_.c_str(), &there) == 0 && S_ISREG(there.st_mode)) ::unlink(part_.c_str());
}

void PartFile::Commit() {
  if (std::rename(part_.c_str(), path_.c_str()) != 0)
    throw std::runtime_error("cannot create " + path_ + ": " + std::generic_category().message(errno));
  part_.clear();  // nothing is left to remove
}

}  // namespace mascot
