#pragma once

#include <filesystem>

#include "system/descriptor.h"

namespace mascot {

/// Leave to do what one process does at a time. It is given back with this object, or when the process ends.
class Turn {
 public:
  /// Waits until no other process has the turn of this name, an empty file that this makes. A signal that ends the
  /// process ends the wait; one that it handles, or blocks, does not. Throws std::filesystem::filesystem_error if the
  /// file cannot be made.
  explicit Turn(const std::filesystem::path& name);

 private:
  Descriptor file_;
};

}  // namespace mascot
