#pragma once

#include <string>

namespace mascot {

/// The name under which a file is written until it is whole, so that what stands at `path` always is: another
/// program never sees half of it, and a failure leaves the file that was there before.
class PartFile {
 public:
  explicit PartFile(std::string path);
  ~PartFile();  ///< removes the unfinished file
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// `path`.part: for the owner to write to.
  const std::string& name() const { return part_; }
  /// Gives the finished file its own name, in place of any other. Throws std::runtime_error.
  void Commit();

 private:
  std::string path_, part_;
};

}  // namespace mascot
