#include "tests/support/folders.h"

namespace mascot::test {

const std::string& SourceFolder() {
  static const std::string folder = MASCOT_SOURCE_DIR;
  return folder;
}

const std::string& BuildFolder() {
  static const std::string folder = MASCOT_BINARY_DIR;
  return folder;
}

}  // namespace mascot::test
